// The reference that the triangle/box tests are held against: the same 13 directions in exact integers. Int must hold
// products of three coordinates: __int128 for up to 40 bits, boost's int512_t for any doubles of like size.
#pragma once
#include "i2b/core/vec.h"
#include <array>
#include <cmath>
#include <cstdlib>
#include <string>

namespace i2b::exact {

__extension__ typedef __int128 Int128;

template <class Int>
using Point = std::array<Int, 3>;

template <class Int>
Point<Int> minus(const Point<Int>& a, const Point<Int>& b) {
    return {Int(a[0] - b[0]), Int(a[1] - b[1]), Int(a[2] - b[2])};
}
template <class Int>
Point<Int> cross(const Point<Int>& a, const Point<Int>& b) {
    return {Int(a[1] * b[2] - a[2] * b[1]), Int(a[2] * b[0] - a[0] * b[2]), Int(a[0] * b[1] - a[1] * b[0])};
}
template <class Int>
Int dot(const Point<Int>& a, const Point<Int>& b) {
    return Int(a[0] * b[0] + a[1] * b[1] + a[2] * b[2]);
}

// How far apart the two are along the axes, the lines and the normal (the largest of each kind; 0: not apart).
struct Gap {
    double axes = 0, lines = 0, plane = 0;
    bool meets() const { return axes == 0 && lines == 0 && plane == 0; }
};

template <class Int>
double apart(const Point<Int>& n, const std::array<Point<Int>, 3>& t, const Point<Int>& lo, const Point<Int>& hi) {
    const Point<Int> zero{Int(0), Int(0), Int(0)};
    if (n == zero) return 0;
    Int triLo = dot(n, t[0]), triHi = triLo, boxLo = 0, boxHi = 0;
    for (std::size_t i = 1; i < 3; ++i) {
        const Int d = dot(n, t[i]);
        if (d < triLo) triLo = d;
        if (d > triHi) triHi = d;
    }
    for (std::size_t k = 0; k < 3; ++k) {
        boxLo += n[k] * (n[k] > 0 ? lo[k] : hi[k]);
        boxHi += n[k] * (n[k] > 0 ? hi[k] : lo[k]);
    }
    const Int between = triLo > boxHi ? Int(triLo - boxHi) : boxLo > triHi ? Int(boxLo - triHi) : Int(0);
    if (between == 0) return 0;
    const double x = static_cast<double>(n[0]), y = static_cast<double>(n[1]), z = static_cast<double>(n[2]);
    return static_cast<double>(between) / std::sqrt(x * x + y * y + z * z);
}

// The box is closed, and may have no extent.
template <class Int>
Gap gapOf(const std::array<Point<Int>, 3>& t, const Point<Int>& lo, const Point<Int>& hi) {
    const std::array<Point<Int>, 3> edges{minus(t[1], t[0]), minus(t[2], t[1]), minus(t[0], t[2])};
    Gap gap;
    for (std::size_t k = 0; k < 3; ++k) {
        Point<Int> axis{Int(0), Int(0), Int(0)};
        axis[k] = 1;
        gap.axes = std::max(gap.axes, apart(axis, t, lo, hi));
        for (const Point<Int>& e : edges) gap.lines = std::max(gap.lines, apart(cross(axis, e), t, lo, hi));
    }
    gap.plane = apart(cross(edges[0], edges[1]), t, lo, hi);
    return gap;
}

// What rounding may take for a hit, in the coordinates of the triangle: a few units in the last place of its extent,
// and of the place where `places` are turned to and fro; the plane of a needle is no better known than its own width.
inline bool withinRounding(const Gap& gap, const std::array<Vec3, 3>& t, bool places) {
    Box box;
    for (const Vec3& v : t) box.add(v);
    const double eps = 2.3e-16, size = norm(box.extent());
    const double place = places ? 8 * eps * std::max(norm(box.lo), norm(box.hi)) : 0;
    const Vec3 p = t[1] - t[0], q = t[2] - t[0];
    const double products = (std::abs(p.y * q.z) + std::abs(p.z * q.y) + std::abs(p.z * q.x) + std::abs(p.x * q.z) + std::abs(p.x * q.y) + std::abs(p.y * q.x));
    const double normal = norm(i2b::cross(p, q));
    const double plane = normal > 0 ? 64 * eps * products / normal * size : size;
    return gap.axes <= place && gap.lines <= 64 * eps * size + place && gap.plane <= std::max(plane, 64 * eps * size) + place;
}

// Rounds of a randomized test, times $I2B_TEST_EFFORT (1 where it is not set).
inline int rounds(int n) {
    const char* effort = std::getenv("I2B_TEST_EFFORT");
    return static_cast<int>(n * (effort ? std::max(0.01, std::atof(effort)) : 1.0));
}

} // namespace i2b::exact
