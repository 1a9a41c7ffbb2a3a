// Spatial index over a Surface: closest point, first hit of a segment, box overlap. O(log N) a query.
// Embree 3 builds the tree (triangle_tree.h) in single precision about the soup's own centre with padded
// boxes; the walks decide by triangles in double precision, so an answer is the one a loop over all triangles
// would give, bit for bit. Queries are const and may run on any number of threads. The closest point costs
// about a microsecond on 330,000 triangles; a radius, such as a neighbour's answer plus the step between
// them, makes it cheaper.
#pragma once
#include "i2b/core/vec.h"
#include "i2b/geometry/surface.h"
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <vector>

namespace i2b {

struct ClosestPoint {
    Vec3 point; // on the triangle
    double distance = std::numeric_limits<double>::infinity();
    std::uint32_t triangle = ~0u; // ~0u: nothing within the radius asked for
    explicit operator bool() const { return triangle != ~0u; }
};

struct SegmentHit {
    double t = 2; // along a + t (b - a), 0 <= t <= 1 where there is a hit
    std::uint32_t triangle = ~0u;
    explicit operator bool() const { return triangle != ~0u; }
};

// Some of the triangles of an index: queries pass over what holds none of them, so that they cost no more than those of an
// index over these alone, however many others lie around.
class TriangleSubset {
  private:
    friend class SurfaceIndex;
    std::vector<bool> taken_;             // per triangle of the surface
    std::vector<std::uint8_t> children_;  // per node of the tree: bit i, child i holds one
};

class SurfaceIndex {
  public:
    explicit SurfaceIndex(const Surface& surface); // keeps a reference: the surface must outlive it
    ~SurfaceIndex();
    SurfaceIndex(SurfaceIndex&&) noexcept;
    SurfaceIndex& operator=(SurfaceIndex&&) noexcept;

    const Surface& surface() const;

    // The closest point of all triangles within radius; among equals the triangle with the lowest number.
    ClosestPoint closest(const Vec3& q, double radius = std::numeric_limits<double>::infinity()) const;
    // As closest(), over the triangles that accept() takes.
    ClosestPoint closest(const Vec3& q, double radius,
                         const std::function<bool(std::uint32_t)>& accept) const;
    // As closest(), or any point not farther than `enough`: cheaper where nothing nearer matters.
    ClosestPoint closeEnough(const Vec3& q, double radius, double enough) const;
    // The same, over some of the triangles.
    ClosestPoint closeEnough(const Vec3& q, double radius, double enough, const TriangleSubset& of) const;
    TriangleSubset subset(const std::function<bool(std::uint32_t)>& accept) const;
    // The first triangle along the closed segment, from a; among equals the lowest number. Rounding decides
    // for the hit (1e-13 of the segment's and the triangle's size), so that nothing slips between triangles
    // sharing an edge.
    SegmentHit firstHit(const Vec3& a, const Vec3& b) const { return firstHit(a, b, 1); }
    // The same where t <= before, or none: cheaper where the end of the segment lies on the geometry.
    SegmentHit firstHit(const Vec3& a, const Vec3& b, double before) const;
    // True if any triangle meets the closed box (exact separating-axis test in doubles).
    bool overlaps(const Box& box) const;
    // All triangles whose bounding boxes meet the box, ascending.
    std::vector<std::uint32_t> candidates(const Box& box) const;
    // Asks accept() of the triangles whose bounding boxes meet the box, in no order that means anything, until it takes
    // one; whether it did.
    bool any(const Box& box, const std::function<bool(std::uint32_t)>& accept) const;
    Vec3 normal(std::uint32_t triangle) const; // unit, or zero where the triangle has no area

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

// Closest point of one triangle to q (Ericson, Real-Time Collision Detection, section 5.1.5); degenerate ones
// too.
Vec3 closestPointOnTriangle(const Vec3& q, const Vec3& a, const Vec3& b, const Vec3& c);

} // namespace i2b
