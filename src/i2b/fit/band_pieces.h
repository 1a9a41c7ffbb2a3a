// What single cells and prisms contribute to the band: corners, edges, hanging nodes.
#pragma once
#include "i2b/fit/band.h"
#include <array>
#include <cstdint>
#include <utility>
#include <vector>

namespace i2b {

using Hanging = std::pair<std::int32_t, std::array<std::int32_t, 4>>; // a node and its parents, -1 filled
inline bool sameNode(const Hanging& a, const Hanging& b) { return a.first == b.first; }

// An edge between two nodes, either end first.
constexpr std::uint64_t edgeKey(std::int32_t a, std::int32_t b) { return std::uint64_t(std::uint32_t(a)) << 32 | std::uint32_t(b); }

// What some cells contribute.
struct BandPieces {
    std::vector<CornerCell> cells;    // node[0], node[1] of those with corners: in this list
    std::vector<Corner> corners;
    std::vector<std::uint64_t> edges; // the lower node first; some more than once
    std::vector<Hanging> hanging;
};

// A core cell's vertices with their neighbours along its edges: six slots, 2 * axis (+ 1 for the positive direction).
struct CellVertex {
    std::int32_t node = -1;
    std::array<std::int32_t, 6> next{-1, -1, -1, -1, -1, -1};
};

// Room to work in for the cells of a node of the mask (8^3 of them), one after the other. Four cells share an edge: it is passed on
// once where they are boxes.
struct CoreCellRoom {
    std::vector<CellVertex> vertices;
    std::array<std::uint64_t, 3 * 9 * 9 * 9> edges{}; // keys, by the lower end in the node and the axis

    void enterNode() { edges.fill(0); }
    bool isNew(const Index3& end, std::size_t axis, std::uint64_t key) {
        std::uint64_t& seen = edges[static_cast<std::size_t>((end[0] * 9 + end[1]) * 9 + end[2]) * 3 + axis];
        if (seen == key) return false;
        seen = key;
        return true;
    }
};

// band: nodes numbered and placed. nodeOf: per point of the lattice mesh its node.
void addCoreCell(const Band& band, LatticeMesh::Reader& reader, int level, const Index3& c, const RawVector<std::int32_t>& nodeOf, CoreCellRoom& room,
                 BandPieces& out);

// Where the prisms' go; null: not asked for.
struct PrismPieces {
    std::vector<std::uint64_t>* edges = nullptr; // of the wall
    Corner* corners = nullptr;                   // the prism's are written from here on
};

// The prism on face f of the front. Gives how many corners it has.
std::size_t addPrism(const Band& band, const Front& front, std::size_t f, const PrismPieces& out);

} // namespace i2b
