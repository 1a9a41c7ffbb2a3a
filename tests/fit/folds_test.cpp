// Proves: nodes that a feature's crossings leave out are snapped to it where a neighbour is on it and no other comes upon
// them, those that are snapped stay so, smooth walls get none; the same on any number of threads.
#include "i2b/fit/folds.h"
#include "fit/unsnapped.h"
#include <gtest/gtest.h>
#include <tbb/global_control.h>

namespace i2b::test {
namespace {

std::size_t snapFolds(const Unsnapped& run, std::vector<Snap>& snaps) {
    return i2b::snapFolds(run.band, run.front, *run.painted.index, run.features, run.x, snaps);
}

// Every third snap to the box's edges is taken away: folds find at least as many as half of them.
TEST(Folds, FindsWhatCrossingsLeaveOut) {
    Unsnapped run(turnedBox());
    std::vector<Snap> all(run.band.walls);
    snapToFeatures(run.views, run.front, run.features, run.x, all);
    std::vector<Snap> before = all;
    std::size_t kept = 0, taken = 0;
    for (Snap& s : before) {
        if (s.kind == SnapKind::line && ++kept % 3 == 0) s = {}, ++taken;
    }
    ASSERT_GT(taken, 20u);
    std::vector<Snap> after = before;
    const std::size_t added = snapFolds(run, after);
    EXPECT_GT(added, taken / 2);
    std::size_t found = 0;
    for (std::size_t n = 0; n < after.size(); ++n) {
        if (before[n].kind != SnapKind::none) {
            EXPECT_EQ(after[n].kind, before[n].kind);
            EXPECT_EQ(after[n].point, before[n].point);
            continue;
        }
        if (after[n].kind == SnapKind::none) continue;
        ++found;
        EXPECT_LT(norm(run.features.closestLine(after[n].point, stagesSize).point - after[n].point), 1e-9);
        EXPECT_LT(norm(after[n].point - run.x[n]), 1.2 * run.band.h[n]);
        bool beside = false;
        for (const BandEdge& e : run.band.edges[n]) {
            const auto m = static_cast<std::size_t>(e.b);
            if (m >= run.band.walls || after[m].kind == SnapKind::none) continue;
            beside = true;
            EXPECT_GT(norm(after[m].point - after[n].point), 0.15 * run.band.h[n]);
        }
        EXPECT_TRUE(beside);
    }
    EXPECT_EQ(found, added);
}

TEST(Folds, NothingWhereNoNeighbourIsOnAFeature) {
    const Unsnapped run(turnedBox());
    std::vector<Snap> snaps(run.band.walls);
    EXPECT_EQ(snapFolds(run, snaps), 0u);
}

TEST(Folds, SameOnAnyNumberOfThreads) {
    const Unsnapped run(turnedBox());
    std::vector<std::vector<Snap>> results;
    for (std::size_t threads : {1, 2, 3}) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        std::vector<Snap>& snaps = results.emplace_back(run.band.walls);
        WallViews views(run.band, *run.painted.index); // each looks by itself
        snapToFeatures(views, run.front, run.features, run.x, snaps);
        snapFolds(run, snaps);
    }
    for (std::size_t k = 1; k < results.size(); ++k)
        for (std::size_t n = 0; n < results[0].size(); ++n) {
            ASSERT_EQ(results[k][n].kind, results[0][n].kind);
            ASSERT_EQ(results[k][n].point, results[0][n].point);
        }
}

} // namespace
} // namespace i2b::test
