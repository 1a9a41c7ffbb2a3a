// Proves: what is kept of a wall node's view is what asking anew gives: at first, asked again, and after the node, or its front node,
// has moved and moved back.
#include "i2b/fit/wall_views.h"
#include "fit/unsnapped.h"
#include <gtest/gtest.h>
#include <random>

namespace i2b::test {
namespace {

void expectAsAsked(WallViews& views, const Positions& x) {
    const Band& band = views.band();
    parallelFor(band.walls, [&](std::size_t n) {
        const WallTarget target = wallTarget(views.index(), band, n, x[static_cast<std::size_t>(band.frontNode[n])], x[n]), kept = views.target(n, x);
        EXPECT_EQ(kept.found, target.found);
        EXPECT_EQ(kept.point, target.point);
        EXPECT_EQ(kept.normal, target.normal);
        const Foot foot = footOf(band, views.index(), x, n), keptFoot = views.foot(n, x);
        EXPECT_EQ(keptFoot.found, foot.found);
        EXPECT_EQ(keptFoot.point, foot.point);
        EXPECT_EQ(keptFoot.normal, foot.normal);
        EXPECT_EQ(keptFoot.part, foot.part);
    }, 64);
}

TEST(WallViews, AreWhatAskingAnewGives) {
    Unsnapped run(turnedBox());
    const Positions before = run.x;
    expectAsAsked(run.views, run.x);
    expectAsAsked(run.views, run.x);
    std::mt19937 random(5);
    std::uniform_real_distribution<double> off(-0.2, 0.2);
    const auto move = [&](std::size_t n) { run.x[n] += Vec3{off(random), off(random), off(random)} * run.band.h[n]; };
    for (int round = 0; round < 3; ++round) {
        for (std::size_t n = 0; n < run.band.walls; ++n) {
            if (random() % 3 == 0) move(n);
            if (random() % 3 == 0) move(static_cast<std::size_t>(run.band.frontNode[n]));
        }
        expectAsAsked(run.views, run.x);
    }
    run.x = before;
    expectAsAsked(run.views, run.x);
}

} // namespace
} // namespace i2b::test
