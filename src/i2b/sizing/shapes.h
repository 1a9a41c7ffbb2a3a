// Places that sizes are asked for: solids and curves that can say of any box whether it meets them. Closed, and decided
// to the safe side: rounding may turn a miss into a hit.
#pragma once
#include "i2b/geometry/surface_index.h"
#include <cstdint>
#include <memory>
#include <variant>
#include <vector>

namespace i2b {

// Everything within radius of a segment. A sphere is one without length, a segment and a point have no radius.
struct Capsule {
    Vec3 from, to;     // m
    double radius = 0; // m
};

// With flat ends.
struct Cylinder {
    Vec3 from, to;     // m
    double radius = 0; // m
};

// The triangles of some parts. The index over them is their own or, where they are most of a surface, the whole surface's with
// the others left out: that is there already, and as large again.
class PartsIndex {
  public:
    explicit PartsIndex(Surface triangles);
    // chosen: per part of the surface. The index must outlive this.
    PartsIndex(const SurfaceIndex& whole, const std::vector<bool>& chosen);

    std::size_t triangles() const { return triangles_; }
    const Box& bounds() const { return bounds_; } // m
    double area() const { return area_; }         // m^2
    // As SurfaceIndex's.
    ClosestPoint closeEnough(const Vec3& q, double radius, double enough) const;

  private:
    template <class Chosen>
    void measure(const Surface& surface, const Chosen& isChosen);

    Surface surface_;                     // where the index is their own
    std::unique_ptr<SurfaceIndex> own_;
    const SurfaceIndex* whole_ = nullptr; // where it is not
    TriangleSubset chosen_;
    std::size_t triangles_ = 0;
    Box bounds_;
    double area_ = 0;
};

// Everything within distance of the parts.
struct PartsBand {
    std::shared_ptr<const PartsIndex> parts;
    double distance = 0; // m
};

using Shape = std::variant<Capsule, Cylinder, PartsBand>;

enum class Cover : std::uint8_t { none, some, all };

// How much of the box the shape covers. `some` may be said of a box that is covered wholly, and by PartsBand of one that
// lies up to half its diagonal beyond the distance.
Cover coverOf(const Shape& shape, const Box& box);
bool meets(const Shape& shape, const Box& box); // coverOf() is not none
// All of the shape lies inside.
Box boundsOf(const Shape& shape);
// m^3, of the shape itself; 0 for curves.
double volumeOf(const Shape& shape);
// m: boxes with no edge over it need not be looked into further, since the shape's border is not known better.
double grainOf(const Shape& shape);

// The squared distance from a segment to a box, 0 where they meet.
double segmentBoxDistance2(const Vec3& from, const Vec3& to, const Box& box);

} // namespace i2b
