// The corners of a band's cells and prisms, which the fit keeps right way out. Those of core cells with eight vertices, nearly all
// there are, follow from these: one cell is a seventh of its corners, and around a node there are eight of them, not 32 corners.
#pragma once
#include "i2b/core/raw_vector.h"
#include "i2b/fit/csr.h"
#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <vector>

namespace i2b {

// A corner tetrahedron: node[0] and its three neighbours along the edges of a cell, positively oriented. With
// J = [(x1-x0)/length1, (x2-x0)/length2, (x3-x0)/length3] an ideal corner has J^T J = 1 and det J = 1.
struct Corner {
    std::array<std::int32_t, 4> node{};
    std::array<float, 3> inverseLength{}; // 1/m
    float weight = 1;                     // in the energy: prism corners count more
    bool has(std::int32_t n) const { return std::ranges::find(node, n) != node.end(); }
};

// A cell of the core: its eight vertices, x first; or, where nodes hang on it, corners of its own.
struct CornerCell {
    static constexpr std::int32_t hasCorners = -1;
    std::array<std::int32_t, 8> node{};
    std::int32_t level = 0;               // or hasCorners: corners [node[0], node[1]) of the list
};

// Vertices of a box, in the order in which its corners come.
constexpr std::array<std::uint8_t, 8> boxOrder{0, 4, 6, 2, 1, 3, 7, 5};

// Per vertex of a box: itself and the three beside it, whose corners have it, in that order.
constexpr std::array<std::array<std::uint8_t, 4>, 8> boxNear = [] {
    std::array<std::array<std::uint8_t, 4>, 8> near{};
    for (std::size_t k = 0; k < 8; ++k) {
        std::size_t count = 0;
        for (const std::uint8_t q : boxOrder)
            if (std::popcount(q ^ k) <= 1) near[k][count++] = q;
    }
    return near;
}();

struct BandCorners {
    RawVector<CornerCell> cells;          // of the core
    RawVector<Corner> list;               // those of cells that nodes hang on, then the prisms'
    std::size_t prisms = 0;               // where these begin
    std::vector<std::array<float, 3>> inverseSize; // 1/m, per level: of the lattice's cells along x, y, z
    Csr<std::int32_t> cellsOf;            // per movable node
    Csr<std::int32_t> prismsOf;           // per wall and front node: the prisms' corners in the list

    // f(corner) for each corner around a movable node: the core's, cell by cell, then the prisms'.
    template <class F>
    void around(std::size_t node, const F& f) const;

    // All corners are those of so many items, each once: f(corner) for each of an item.
    std::size_t items() const { return cells.size() + list.size() - prisms; }
    template <class F>
    void ofItem(std::size_t item, const F& f) const;
    template <class F>
    void forAll(const F& f) const {
        for (std::size_t i = 0; i < items(); ++i) ofItem(i, f);
    }
    void prefetchAround(std::size_t node) const {
        for (const std::int32_t c : cellsOf[node]) __builtin_prefetch(&cells[static_cast<std::size_t>(c)]);
        if (node >= prismsOf.rows()) return;
        for (const std::int32_t c : prismsOf[node]) __builtin_prefetch(&list[static_cast<std::size_t>(c)]);
    }

  private:
    // That at a vertex of a box.
    Corner cornerAt(const CornerCell& cell, std::size_t vertex) const {
        const std::array<float, 3>& length = inverseSize[static_cast<std::size_t>(cell.level)];
        const std::size_t first = std::popcount(vertex) % 2 == 0 ? 1 : 2, second = 3 - first; // axes, as bits: right-handed
        return {{cell.node[vertex], cell.node[vertex ^ first], cell.node[vertex ^ second], cell.node[vertex ^ 4]},
                {length[first - 1], length[second - 1], length[2]}, 1};
    }
};

template <class F>
void BandCorners::around(std::size_t node, const F& f) const {
    const auto n = static_cast<std::int32_t>(node);
    for (const std::int32_t c : cellsOf[node]) {
        const CornerCell& cell = cells[static_cast<std::size_t>(c)];
        if (cell.level != CornerCell::hasCorners) {
            const auto vertex = static_cast<std::size_t>(std::ranges::find(cell.node, n) - cell.node.begin());
            for (const std::uint8_t q : boxNear[vertex]) f(cornerAt(cell, q));
        } else {
            for (std::int32_t i = cell.node[0]; i < cell.node[1]; ++i)
                if (list[static_cast<std::size_t>(i)].has(n)) f(list[static_cast<std::size_t>(i)]);
        }
    }
    if (node >= prismsOf.rows()) return;
    for (const std::int32_t c : prismsOf[node]) f(list[static_cast<std::size_t>(c)]);
}

template <class F>
void BandCorners::ofItem(std::size_t item, const F& f) const {
    if (item >= cells.size()) return f(list[prisms + item - cells.size()]);
    const CornerCell& cell = cells[item];
    if (cell.level != CornerCell::hasCorners) {
        for (const std::uint8_t q : boxOrder) f(cornerAt(cell, q));
    } else {
        for (std::int32_t i = cell.node[0]; i < cell.node[1]; ++i) f(list[static_cast<std::size_t>(i)]);
    }
}

} // namespace i2b
