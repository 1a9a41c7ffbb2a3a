// Does a triangle meet a box? Closed (touching counts) and decided to the safe side: rounding may turn a miss
// by some 1e-15 of the triangle's size into a hit, never a hit into a miss, so that no wall has a pinhole.
//
// Source: the separating-axis test (Akenine-Moeller 2001) in the plane-and-edge form of Schwarz and Seidel,
// "Fast parallel surface and solid voxelization on GPUs", ACM Trans. Graph. 29 (2010). What differs: every
// comparison carries an error bound, needles and points are right too, boxes may have any size, and a row is
// decided at once.
//
// 13 directions can separate the two: the 3 axes (the bounds of the triangle), its normal, and the 9 products
// of an edge with an axis, which are *lines* across one coordinate plane. The box is first clipped to the
// triangle's bounds and both are taken relative to the vertex a: so all numbers, and with them all rounding
// errors, are of the triangle's size, wherever it lies and however large the box is.
#pragma once
#include "i2b/core/vec.h"
#include <cmath>
#include <limits>

namespace i2b {

// Floor and ceiling of what fits an int32, without the library call that they are before SSE 4.1.
inline std::int32_t floorToInt(double x) {
    const auto i = static_cast<std::int32_t>(x);
    return i - (static_cast<double>(i) > x ? 1 : 0);
}
inline std::int32_t ceilToInt(double x) { return -floorToInt(-x); }

// Set up once per triangle, then asked for many boxes, in the coordinates of the setup.
class TriangleBoxTest {
  public:
    TriangleBoxTest() = default;
    TriangleBoxTest(const Vec3& a, const Vec3& b, const Vec3& c) { setup(a, b, c); }

    void setup(const Vec3& a, const Vec3& b, const Vec3& c);
    // True if the triangle meets the closed box [lo, hi].
    bool meets(const Vec3& lo, const Vec3& hi) const;
    // The boxes of a row along x, all with the same y and z: those with hi.x >= first and lo.x <= last meet
    // the triangle (first may exceed last by less than a box). False if none does. Decides a row of any
    // length for the price of a few boxes; at most more to the hit side than meets(), by a rounding of x.
    bool row(double yLo, double yHi, double zLo, double zHi, double& first, double& last) const;
    const Box& bounds() const { return bounds_; }

  private:
    friend class TriangleCells;
    using Pair = double __attribute__((vector_size(16)));
    // Lines across one coordinate plane (u, v), one per edge, the last repeated to fill two pairs: the
    // triangle lies within low <= nu u + nv v <= high, widened by the error bound.
    struct Lines {
        Pair nu[2], nv[2], absU[2], absV[2], low[2], high[2];
        bool miss(double cu, double cv, double hu, double hv) const; // box by centre and half edges
    };
    static constexpr double eps = std::numeric_limits<double>::epsilon();

    static void setLines(Lines& lines, const double (&u)[3], const double (&v)[3], const double (&eu)[3],
                         const double (&ev)[3]);
    static bool narrow(double n, double restMin, double restMax, double low, double high, double& first,
                       double& last);
    const Lines& linesAcross(std::size_t axis) const { return axis == 0 ? yz_ : axis == 1 ? zx_ : xy_; }
    // The three lines of the plane across the axis as bounds on one of its coordinates, where the other lies in lo .. hi
    // (about the origin; `first`: it is the first of the two). False if they miss.
    bool across(std::size_t axis, bool first, double lo, double hi, double& from, double& to) const;
    // From places about the origin to the given coordinates, widened by one rounding of their size, within the bounds.
    // False if nothing is left.
    bool place(std::size_t axis, double& from, double& to) const;

    Box bounds_;
    Vec3 origin_, normal_, absNormal_;
    double planeError_ = 0;
    Lines yz_{}, zx_{}, xy_{};
};

inline bool triangleMeetsBox(const Vec3& a, const Vec3& b, const Vec3& c, const Box& box) {
    return TriangleBoxTest(a, b, c).meets(box.lo, box.hi);
}

inline void TriangleBoxTest::setLines(Lines& lines, const double (&u)[3], const double (&v)[3],
                                      const double (&eu)[3], const double (&ev)[3]) {
    const double reachU = std::max(std::abs(u[1]), std::abs(u[2])) + std::abs(eu[1]);
    const double reachV = std::max(std::abs(v[1]), std::abs(v[2])) + std::abs(ev[1]);
    for (int i = 0; i < 4; ++i) {
        const int k = std::min(i, 2);
        const double nu = -ev[k], nv = eu[k];
        // The edge has one value at both its ends, so two of the three vertices tell the range.
        const double p = nu * u[k] + nv * v[k], q = nu * u[(k + 2) % 3] + nv * v[(k + 2) % 3];
        const double error = 16 * eps * (std::abs(nu) * reachU + std::abs(nv) * reachV);
        const auto lane = static_cast<std::size_t>(i % 2);
        const auto pair = static_cast<std::size_t>(i / 2);
        lines.nu[pair][lane] = nu;
        lines.nv[pair][lane] = nv;
        lines.absU[pair][lane] = std::abs(nu);
        lines.absV[pair][lane] = std::abs(nv);
        lines.low[pair][lane] = std::min(p, q) - error;
        lines.high[pair][lane] = std::max(p, q) + error;
    }
}

inline void TriangleBoxTest::setup(const Vec3& a, const Vec3& b, const Vec3& c) {
    bounds_ = {};
    bounds_.add(a);
    bounds_.add(b);
    bounds_.add(c);
    origin_ = a;
    const Vec3 p = b - a, q = c - a, r = c - b; // the edge opposite to c, b, a; each is exact to one rounding
    const double x[3] = {0, p.x, q.x}, y[3] = {0, p.y, q.y}, z[3] = {0, p.z, q.z};
    const double ex[3] = {p.x, r.x, q.x}, ey[3] = {p.y, r.y, q.y}, ez[3] = {p.z, r.z, q.z};
    setLines(yz_, y, z, ey, ez);
    setLines(zx_, z, x, ez, ex);
    setLines(xy_, x, y, ex, ey);
    normal_ = cross(p, q);
    absNormal_ = {std::abs(normal_.x), std::abs(normal_.y), std::abs(normal_.z)};
    // Of each component of the normal by its two products, times the farthest a point of the bounds can be.
    const Vec3 size = bounds_.extent();
    planeError_ = 16 * eps *
                  ((std::abs(p.y * q.z) + std::abs(p.z * q.y)) * size.x +
                   (std::abs(p.z * q.x) + std::abs(p.x * q.z)) * size.y +
                   (std::abs(p.x * q.y) + std::abs(p.y * q.x)) * size.z);
}

inline bool TriangleBoxTest::Lines::miss(double cu, double cv, double hu, double hv) const {
    const Pair c0 = nu[0] * cu + nv[0] * cv, r0 = absU[0] * hu + absV[0] * hv;
    const Pair c1 = nu[1] * cu + nv[1] * cv, r1 = absU[1] * hu + absV[1] * hv;
    const auto out = (c0 + r0 < low[0]) | (c0 - r0 > high[0]) | (c1 + r1 < low[1]) | (c1 - r1 > high[1]);
    return (out[0] | out[1]) != 0;
}

inline bool TriangleBoxTest::meets(const Vec3& boxLo, const Vec3& boxHi) const {
    if (boxLo.x > bounds_.hi.x || boxLo.y > bounds_.hi.y || boxLo.z > bounds_.hi.z ||
        boxHi.x < bounds_.lo.x || boxHi.y < bounds_.lo.y || boxHi.z < bounds_.lo.z)
        return false;
    const Vec3 lo = cwiseMax(boxLo, bounds_.lo) - origin_, hi = cwiseMin(boxHi, bounds_.hi) - origin_;
    const Vec3 c = (lo + hi) * 0.5, h = (hi - lo) * 0.5;
    if (std::abs(dot(normal_, c)) > dot(absNormal_, h) + planeError_) return false;
    return !(xy_.miss(c.x, c.y, h.x, h.y) || yz_.miss(c.y, c.z, h.y, h.z) || zx_.miss(c.z, c.x, h.z, h.x));
}

// One line as a bound on x: n x + rest must reach low at its largest and high at its smallest, with restMin
// and restMax the range of the rest over the row. False if the row misses whatever x is.
inline bool TriangleBoxTest::narrow(double n, double restMin, double restMax, double low, double high,
                                    double& first, double& last) {
    if (n == 0) return restMax >= low && restMin <= high;
    const double s = (low - restMax) / n, t = (high - restMin) / n;
    const double from = n > 0 ? s : t, to = n > 0 ? t : s;
    if (from > first) first = from;
    if (to < last) last = to;
    return true;
}

inline bool TriangleBoxTest::row(double yLo, double yHi, double zLo, double zHi, double& first,
                                 double& last) const {
    if (yLo > bounds_.hi.y || zLo > bounds_.hi.z || yHi < bounds_.lo.y || zHi < bounds_.lo.z) return false;
    const double y0 = std::max(yLo, bounds_.lo.y) - origin_.y, y1 = std::min(yHi, bounds_.hi.y) - origin_.y;
    const double z0 = std::max(zLo, bounds_.lo.z) - origin_.z, z1 = std::min(zHi, bounds_.hi.z) - origin_.z;
    const double cy = (y0 + y1) * 0.5, hy = (y1 - y0) * 0.5, cz = (z0 + z1) * 0.5, hz = (z1 - z0) * 0.5;
    if (yz_.miss(cy, cz, hy, hz)) return false;
    first = -std::numeric_limits<double>::infinity(), last = -first;
    const double c = normal_.y * cy + normal_.z * cz, r = absNormal_.y * hy + absNormal_.z * hz;
    return narrow(normal_.x, c - r, c + r, -planeError_, planeError_, first, last) && across(2, false, y0, y1, first, last) &&
           across(1, true, z0, z1, first, last) && place(0, first, last);
}

inline bool TriangleBoxTest::across(std::size_t axis, bool first, double lo, double hi, double& from, double& to) const {
    const Lines& lines = linesAcross(axis);
    for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t p = i / 2, k = i % 2;
        const double known = first ? lines.nu[p][k] : lines.nv[p][k], other = first ? lines.nv[p][k] : lines.nu[p][k];
        const double a = known * lo, b = known * hi;
        if (!narrow(other, std::min(a, b), std::max(a, b), lines.low[p][k], lines.high[p][k], from, to)) return false;
    }
    return true;
}

inline bool TriangleBoxTest::place(std::size_t axis, double& from, double& to) const {
    const int a = static_cast<int>(axis);
    from = std::max(origin_[a] + from, bounds_.lo[a]);
    to = std::min(origin_[a] + to, bounds_.hi[a]);
    // So that a place that is on a plane between two cells lies, after rounding, in both.
    from -= 2 * eps * std::abs(from) + std::numeric_limits<double>::min();
    to += 2 * eps * std::abs(to);
    return from <= bounds_.hi[a] && to >= bounds_.lo[a];
}

} // namespace i2b
