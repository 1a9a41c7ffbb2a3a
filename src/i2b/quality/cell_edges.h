// The vertices and edges of one cell, numbered locally without allocation: the vertices in a small hash
// table, the edges as rows of bits. Cells of more than 64 vertices are told so, for a slower way.
#pragma once
#include <array>
#include <cstdint>
#include <span>

namespace i2b {

class CellEdges {
  public:
    static constexpr int vertexLimit = 64;

    void clear() {
        for (int i = 0; i < vertices_; ++i) {
            table_[slots_[static_cast<std::size_t>(i)]].local = -1;
            once_[static_cast<std::size_t>(i)] = twice_[static_cast<std::size_t>(i)] = 0;
            over_[static_cast<std::size_t>(i)] = 0;
        }
        vertices_ = 0;
    }

    // false: more vertices than fit
    bool addFace(std::span<const std::int32_t> face) {
        int first = -1, before = -1;
        for (const std::int32_t v : face) {
            const int here = local(v);
            if (here < 0) return false;
            if (before >= 0)
                addEdge(before, here);
            else
                first = here;
            before = here;
        }
        addEdge(before, first);
        return true;
    }

    int vertices() const { return vertices_; }
    bool anyEdgeOnce() const {
        std::uint64_t bits = 0;
        for (std::size_t i = 0; i < static_cast<std::size_t>(vertices_); ++i) bits |= once_[i] & ~twice_[i];
        return bits != 0;
    }
    bool anyEdgeOver() const { // used more than twice
        std::uint64_t bits = 0;
        for (std::size_t i = 0; i < static_cast<std::size_t>(vertices_); ++i) bits |= over_[i];
        return bits != 0;
    }

  private:
    static constexpr std::uint32_t tableSize = 256;
    struct Entry {
        std::int32_t vertex = -1, local = -1;
    };

    int local(std::int32_t vertex) {
        std::uint32_t slot = (static_cast<std::uint32_t>(vertex) * 2654435769U) >> 24;
        while (table_[slot].local >= 0) {
            if (table_[slot].vertex == vertex) return table_[slot].local;
            slot = (slot + 1) % tableSize;
        }
        if (vertices_ == vertexLimit) return -1;
        slots_[static_cast<std::size_t>(vertices_)] = static_cast<std::uint8_t>(slot);
        table_[slot] = {vertex, vertices_};
        return vertices_++;
    }
    void addEdge(int a, int b) {
        const auto row = static_cast<std::size_t>(a < b ? a : b);
        const std::uint64_t bit = std::uint64_t(1) << (a < b ? b : a);
        over_[row] |= twice_[row] & bit;
        twice_[row] |= once_[row] & bit;
        once_[row] |= bit;
    }

    int vertices_ = 0;
    std::array<Entry, tableSize> table_{};
    std::array<std::uint8_t, vertexLimit> slots_{};
    std::array<std::uint64_t, vertexLimit> once_{}, twice_{}, over_{};
};

} // namespace i2b
