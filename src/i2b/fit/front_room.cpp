#include "i2b/fit/front_room.h"
#include "i2b/fit/corner.h"
#include "i2b/fit/fit.h"
#include <algorithm>

namespace i2b {
namespace {

constexpr double goodCorner = 0.2; // scaled Jacobian: corners that were as good stay so, worse ones do not get worse

double worstCorner(const Band& band, const std::vector<Vec3>& x, std::size_t node) {
    double worst = 1;
    for (const std::int32_t c : band.cornersOf[node]) worst = std::min(worst, scaledJacobian(band.corners[static_cast<std::size_t>(c)], x));
    return worst;
}

} // namespace

std::size_t makeRoom(const std::vector<RoomWish>& wishes, const Band& band, const SurfaceIndex& index, std::vector<Vec3>& x, Front& front) {
    std::size_t moved = 0;
    for (const RoomWish& wish : wishes) { // serial: few, and some share a node
        const auto wall = static_cast<std::size_t>(wish.wall), node = static_cast<std::size_t>(band.frontNode[wall]);
        const Vec3 way = x[node] - x[wall];
        const double step = leastSlope * norm(way) - dot(way, wish.normal);
        if (!(step > 0) || step > longestStep * band.h[wall]) continue;
        const Vec3 from = x[node];
        const double before = worstCorner(band, x, node);
        x[node] = from + withinSides(wish.normal * step, band.outside[node]);
        if (index.firstHit(from, x[node]) || worstCorner(band, x, node) < std::min(before, goodCorner)) {
            x[node] = from;
            continue;
        }
        ++moved;
        for (const std::int32_t fan : band.fansOf[node - band.walls]) front.front[static_cast<std::size_t>(fan)] = x[node];
    }
    return moved;
}

} // namespace i2b
