#include "i2b/core/parallel.h"
#include "i2b/fit/corner.h"
#include "i2b/fit/wall_views.h"

namespace i2b {

void snapExactly(WallViews& views, const FeatureIndex& features, const std::vector<Snap>& snaps,
                 Positions& x, const EnergyOptions& options) {
    const Band& band = views.band();
    const auto snapOne = [&](std::size_t b) {
        const Vec3 old = x[b];
        Vec3 to;
        const double floor = snaps[b].kind == SnapKind::none ? options.floor : options.featureFloor;
        if (snaps[b].kind == SnapKind::none) {
            const WallTarget& target = views.target(b, x);
            if (!target.found) return;
            to = target.point;
        } else {
            to = snapLine(views.index(), features, snaps[b], old, band.h[b]).point;
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
    };
    constexpr std::array kinds{NodeBlocks::wall};
    band.blocks.sweep(kinds, [&](std::size_t block, NodeBlocks::Kind kind) {
        for (const std::int32_t n : band.blocks.nodes(block, kind)) snapOne(static_cast<std::size_t>(n));
    });
}

} // namespace i2b
