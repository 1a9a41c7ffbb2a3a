// Places that sizes are asked for: solids and curves that can say of any box whether it meets them. Closed, and decided
// to the safe side: rounding may turn a miss into a hit.
#pragma once
#include "i2b/geometry/surface_index.h"
#include <cstdint>
#include <memory>
#include <variant>

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

// The triangles of some parts, and the index over them.
struct PartsIndex {
    explicit PartsIndex(Surface triangles) : surface(std::move(triangles)), index(surface) {}
    const Surface surface;
    const SurfaceIndex index;
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
