// Which levels meet, and where cells of one lie on the lattice of another.
#pragma once
#include "i2b/grid/cell_grid.h"

namespace i2b {

// May cells of the two levels share a face, an edge or a corner? (2:1 on each axis)
inline bool mayTouch(const LevelTriple& a, const LevelTriple& b) {
    return std::abs(a.x - b.x) <= 1 && std::abs(a.y - b.y) <= 1 && std::abs(a.z - b.z) <= 1;
}

// By level: the other levels whose cells may touch its own (at most one step away on each axis), in order.
inline std::vector<std::vector<std::size_t>> touchingLevels(const CellGrid& grid) {
    std::vector<std::vector<std::size_t>> touching(grid.levels.size());
    for (std::size_t k = 0; k < grid.levels.size(); ++k) {
        for (std::size_t m = 0; m < grid.levels.size(); ++m) {
            if (m != k && mayTouch(grid.levels[k].level, grid.levels[m].level)) touching[k].push_back(m);
        }
    }
    return touching;
}

// The cell of level `to` that holds the low corner of cell c of level `from`, which is nowhere coarser.
inline Index3 ancestor(const Index3& c, const LevelTriple& from, const LevelTriple& to) {
    return {c[0] >> (from.x - to.x), c[1] >> (from.y - to.y), c[2] >> (from.z - to.z)};
}

// One level finer on every axis: where faces and vertices of touching cells have whole coordinates.
constexpr LevelTriple halvedLevel(const LevelTriple& l) {
    return {static_cast<std::uint8_t>(l.x + 1), static_cast<std::uint8_t>(l.y + 1), static_cast<std::uint8_t>(l.z + 1)};
}

// Calls f(cell of level `to`) for every such cell that could lie across a face of cell c of level `from`: as many as
// `to` is finer along the face. side: 0 low, 1 high.
template <class F>
void forEachAcross(const Index3& c, const LevelTriple& from, const LevelTriple& to, std::size_t axis, int side, const F& f) {
    const std::size_t b = (axis + 1) % 3, d = (axis + 2) % 3;
    const LevelTriple half = halvedLevel(from);
    for (int j = 0; j <= (to[d] > from[d] ? 1 : 0); ++j) {
        for (int i = 0; i <= (to[b] > from[b] ? 1 : 0); ++i) {
            Index3 at{2 * c[0], 2 * c[1], 2 * c[2]};
            at[axis] += side ? 2 : -1;
            at[b] += i, at[d] += j;
            f(ancestor(at, half, to));
        }
    }
}

} // namespace i2b
