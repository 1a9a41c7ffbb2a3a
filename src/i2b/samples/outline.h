// Plane outlines for the sample builders, and their triangulation. Everything here uses + - * / and square
// roots only, so that the samples are the same to the last bit on every IEEE machine (libm's sine is not).
#pragma once
#include "i2b/core/vec.h"
#include <array>
#include <cstdint>
#include <vector>

namespace i2b::samples {

struct Vec2 {
    double x = 0, y = 0;
    friend constexpr Vec2 operator+(Vec2 a, Vec2 b) { return {a.x + b.x, a.y + b.y}; }
    friend constexpr Vec2 operator-(Vec2 a, Vec2 b) { return {a.x - b.x, a.y - b.y}; }
    friend constexpr Vec2 operator*(Vec2 a, double s) { return {a.x * s, a.y * s}; }
    friend constexpr bool operator==(const Vec2&, const Vec2&) = default;
};
constexpr double dot(Vec2 a, Vec2 b) { return a.x * b.x + a.y * b.y; }
constexpr double cross(Vec2 a, Vec2 b) { return a.x * b.y - a.y * b.x; }

using Loop2 =
    std::vector<Vec2>; // closed, the last point joined to the first; counterclockwise unless said otherwise
using Triangle = std::array<std::uint32_t, 3>;

// (cos, sin) of i / n of a full turn: exactly symmetric under quarter turns when 4 divides n.
Vec2 unitCircle(int i, int n);

Loop2 circle(Vec2 centre, double radius, int n);

// Axis-parallel rectangle with round corners of `n` segments each. 4 (n + 1) points for any radius > 0.
Loop2 roundedRectangle(Vec2 lo, Vec2 hi, double radius, int n);

// Polygon whose corner k is replaced by an arc of radius radii[k] (0: sharp) of `n` segments.
Loop2 filletedPolygon(const std::vector<Vec2>& corners, const std::vector<double>& radii, int n);

// Every point moved outwards by `d` (inwards if negative) along the bisector of its two sides; same point
// count.
Loop2 offset(const Loop2& loop, double d);

// Adds points on sides so that none is longer than `length`.
Loop2 subdivided(const Loop2& loop, double length);

// Star-like outline of `teeth` flat-topped teeth between two radii (gear, knurled cap).
Loop2 gear(Vec2 centre, double inner, double outer, int teeth);

// Index of the point nearest to p (the first of equals).
std::uint32_t nearest(const Loop2& loop, Vec2 p);

// n + 1 equally spaced values.
std::vector<double> levels(double from, double to, int n);

Loop2 convexHull(std::vector<Vec2> points);

// Ear clipping of loops[0] (counterclockwise) less the holes loops[1..] (counterclockwise as well); indices
// run over the points of all loops in order. Picks the best-shaped ear first. Loops must not touch or cross.
std::vector<Triangle> triangulate(const std::vector<Loop2>& loops);

} // namespace i2b::samples
