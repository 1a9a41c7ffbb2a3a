// The Cartesian lattice that all cells, vertices and faces are counted on.
// Level 0 is the base grid of count[] cells of base[] metres; each level halves them. The cell (i, j, k) of level l
// spans origin + (i, j, k) * base / 2^l. Coordinates are non-negative and below count * 2^l.
#pragma once
#include "i2b/core/vec.h"
#include <array>
#include <cstdint>
#include <string>

namespace i2b {

using Index3 = std::array<std::int32_t, 3>;

// The level of a cell along each axis: in a 2^n tree every axis splits on its own.
struct LevelTriple {
    std::uint8_t x = 0, y = 0, z = 0;
    friend constexpr auto operator<=>(const LevelTriple&, const LevelTriple&) = default;
};

struct Lattice {
    Vec3 origin;         // m, the low corner of the domain box
    Vec3 base;           // m, edges of a base cell
    Index3 count{};      // base cells along each axis
    std::int32_t maxLevel = 0; // finest level in use

    Vec3 cellSize(int level) const { return base / static_cast<double>(std::int64_t(1) << level); }
    double h(int level) const { // one length for a cell: the smallest edge
        const Vec3 s = cellSize(level);
        return std::min(s.x, std::min(s.y, s.z));
    }
    Index3 cells(int level) const { return {count[0] << level, count[1] << level, count[2] << level}; }
    Vec3 corner(int level, const Index3& v) const {
        const Vec3 s = cellSize(level);
        return {origin.x + s.x * v[0], origin.y + s.y * v[1], origin.z + s.z * v[2]};
    }
    Box cellBox(int level, const Index3& c) const {
        return {corner(level, c), corner(level, {c[0] + 1, c[1] + 1, c[2] + 1})};
    }
    Box domain() const { return {origin, corner(0, count)}; }
    // The cell of the level that holds p (clamped to the domain).
    Index3 cellAt(int level, const Vec3& p) const;
};

} // namespace i2b
