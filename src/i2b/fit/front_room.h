// Room for prisms that new vertices will make: front nodes step a little way out over a face whose prism would have no
// height at a corner, as that of a ledge beside a sharp edge whose front node stands over the other side.
#pragma once
#include "i2b/fit/band.h"
#include "i2b/geometry/surface_index.h"

namespace i2b {

struct RoomWish {
    std::int32_t wall = -1;  // node of the band at the corner, or the first end of the edge that the corner is on
    Vec3 normal;             // unit, of the face there, into the fluid
    std::int32_t other = -1; // the other end, or none
    double t = 0;            // share of the way to it
    Vec3 place;              // m, of the corner on the wall
};

inline constexpr double leastSlope = 0.25; // of the way from wall to front over a face: its sine
inline constexpr double longestStep = 0.35; // of h: of a front node

// Moves the front nodes of the wishes, in their order, where every corner of the band around stays good and no geometry lies
// between; x: positions of the band's nodes. The front is told. Gives how many moved.
std::size_t makeRoom(const std::vector<RoomWish>& wishes, const Band& band, const SurfaceIndex& index, Positions& x, Front& front);

} // namespace i2b
