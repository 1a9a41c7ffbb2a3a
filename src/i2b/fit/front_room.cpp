#include "i2b/fit/front_room.h"
#include "i2b/fit/corner.h"
#include "i2b/fit/fit.h"
#include <algorithm>

namespace i2b {
namespace {

constexpr double goodCorner = 0.2; // scaled Jacobian: corners that were as good stay so, worse ones do not get worse

// Moves a node of the front, if that is well.
bool stepOut(std::size_t node, const Vec3& step, const Band& band, const SurfaceIndex& index, Positions& x, Front& front) {
    const Vec3 from = x[node];
    const double before = worstCorner(band, node, x);
    x[node] = from + withinSides(step, band.outside[node]);
    if (index.firstHit(from, x[node]) || worstCorner(band, node, x) < std::min(before, goodCorner)) {
        x[node] = from;
        return false;
    }
    for (const std::int32_t fan : band.fansOf[node - band.walls]) front.front[static_cast<std::size_t>(fan)] = x[node];
    return true;
}

} // namespace

std::size_t makeRoom(const std::vector<RoomWish>& wishes, const Band& band, const SurfaceIndex& index, Positions& x, Front& front) {
    std::size_t moved = 0;
    const auto frontOf = [&](std::int32_t wall) { return static_cast<std::size_t>(band.frontNode[static_cast<std::size_t>(wall)]); };
    for (const RoomWish& wish : wishes) { // serial: few, and some share a node
        // Both ends of an edge step out: the second one as far as the first has left to do.
        for (const std::int32_t end : {wish.wall, wish.other}) {
            if (end < 0) continue;
            const Vec3& first = x[frontOf(wish.wall)];
            const Vec3 way = (wish.other < 0 ? first : first + (x[frontOf(wish.other)] - first) * wish.t) - wish.place;
            const double step = leastSlope * norm(way) - dot(way, wish.normal);
            if (!(step > 0) || step > longestStep * band.h[static_cast<std::size_t>(end)]) continue;
            moved += stepOut(frontOf(end), wish.normal * step, band, index, x, front);
        }
    }
    return moved;
}

} // namespace i2b
