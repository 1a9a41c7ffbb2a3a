#include "i2b/core/parallel.h"
#include "i2b/fit/corner.h"
#include "i2b/fit/fit.h"

namespace i2b {
namespace {

double worstCorner(const Band& band, std::size_t n, const std::vector<Vec3>& x) {
    double worst = 1;
    for (std::int32_t c : band.cornersOf[n]) worst = std::min(worst, scaledJacobian(band.corners[static_cast<std::size_t>(c)], x));
    return worst;
}

} // namespace

void snapExactly(const Band& band, const SurfaceIndex& index, const FeatureIndex& features, const std::vector<Snap>& snaps,
                 std::vector<Vec3>& x, const EnergyOptions& options) {
    std::vector<std::uint8_t> walls(band.movable, 0);
    std::fill_n(walls.begin(), band.walls, std::uint8_t(1));
    std::int32_t colours = 0;
    const std::vector<std::int32_t> colour = colourNodes(band, walls, colours);
    for (std::int32_t k = 0; k < colours; ++k) {
        parallelFor(band.walls, [&](std::size_t b) {
            if (colour[b] != k) return;
            const Vec3 f = x[static_cast<std::size_t>(band.frontNode[b])], old = x[b];
            Vec3 to;
            const double floor = snaps[b].kind == SnapKind::none ? options.floor : options.featureFloor;
            if (snaps[b].kind == SnapKind::none) {
                const WallTarget target = wallTarget(index, band, b, f, old);
                if (!target.found) return;
                to = target.point;
            } else {
                to = snapLine(index, features, snaps[b], old, band.h[b]).point;
            }
            const Vec3 way = withinSides(to - old, band.outside[b]);
            if (norm(way) < 1e-12 * band.h[b]) return;
            const double before = worstCorner(band, b, x);
            for (double part : {1.0, 0.5, 0.25}) {
                x[b] = old + way * part;
                const double after = worstCorner(band, b, x);
                if (after >= std::min(before, floor) && after > 0) return;
            }
            x[b] = old;
        });
    }
}

} // namespace i2b
