// The Cartesian lattice that all cells, vertices and faces are counted on.
// Level 0 is the base grid of count[] cells of base[] metres; each level halves them, on each axis on its own. The cell
// (i, j, k) of level l spans origin + (i, j, k) * base / 2^l. Coordinates are non-negative and below count * 2^l.
#pragma once
#include "i2b/core/vec.h"
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>

namespace i2b {

using Index3 = std::array<std::int32_t, 3>;

// The level of a cell along each axis: in a 2^n tree every axis splits on its own.
struct LevelTriple {
    std::uint8_t x = 0, y = 0, z = 0;
    friend constexpr auto operator<=>(const LevelTriple&, const LevelTriple&) = default;

    constexpr int operator[](std::size_t axis) const { return axis == 0 ? x : axis == 1 ? y : z; }
    constexpr std::uint8_t& operator[](std::size_t axis) { return axis == 0 ? x : axis == 1 ? y : z; }
    constexpr int finest() const { return std::max(x, std::max(y, z)); }
    constexpr bool same() const { return x == y && y == z; }
};

constexpr LevelTriple allAxes(int level) {
    const auto l = static_cast<std::uint8_t>(level);
    return {l, l, l};
}
constexpr LevelTriple finerOf(const LevelTriple& a, const LevelTriple& b) {
    return {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)};
}

struct Lattice {
    Vec3 origin;         // m, the low corner of the domain box
    Vec3 base;           // m, edges of a base cell
    Index3 count{};      // base cells along each axis
    std::int32_t maxLevel = 0; // finest level in use on any axis

    Vec3 cellSize(const LevelTriple& level) const {
        return {std::ldexp(base.x, -level.x), std::ldexp(base.y, -level.y), std::ldexp(base.z, -level.z)};
    }
    double h(const LevelTriple& level) const { // one length for a cell: the smallest edge
        const Vec3 s = cellSize(level);
        return std::min(s.x, std::min(s.y, s.z));
    }
    Index3 cells(const LevelTriple& level) const {
        return {count[0] << level.x, count[1] << level.y, count[2] << level.z};
    }
    Vec3 corner(const LevelTriple& level, const Index3& v) const {
        const Vec3 s = cellSize(level);
        return {origin.x + s.x * v[0], origin.y + s.y * v[1], origin.z + s.z * v[2]};
    }
    Box cellBox(const LevelTriple& level, const Index3& c) const {
        return {corner(level, c), corner(level, {c[0] + 1, c[1] + 1, c[2] + 1})};
    }
    // The cell of the level that holds p (clamped to the domain).
    Index3 cellAt(const LevelTriple& level, const Vec3& p) const;

    // The same on a level that all axes have in common.
    Vec3 cellSize(int level) const { return cellSize(allAxes(level)); }
    double h(int level) const { return h(allAxes(level)); }
    Index3 cells(int level) const { return cells(allAxes(level)); }
    Vec3 corner(int level, const Index3& v) const { return corner(allAxes(level), v); }
    Box cellBox(int level, const Index3& c) const { return cellBox(allAxes(level), c); }
    Index3 cellAt(int level, const Vec3& p) const { return cellAt(allAxes(level), p); }

    Box domain() const { return {origin, corner(0, count)}; }
};

} // namespace i2b
