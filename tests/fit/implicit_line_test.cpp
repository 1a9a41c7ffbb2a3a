// Proves: a node held to a line in which parts cut each other stays with the geometry where that line ends.
#include "i2b/geometry/surface_index.h"
#include "pipeline/random_case.h"
#include "pipeline/stages_run.h"
#include <gtest/gtest.h>

namespace i2b::test {
namespace {

constexpr unsigned shards = 6, casesPerShard = 50;

class BoxesThatCross : public testing::TestWithParam<unsigned> {};

TEST_P(BoxesThatCross, KeepTheirNodes) {
    std::size_t implicit = 0;
    for (unsigned i = 0; i < casesPerShard; ++i) {
        const unsigned seed = caseKinds * (GetParam() * casesPerShard + i) + 2;
        const RandomCase c = randomCase(seed);
        ASSERT_EQ(c.kind, "rotated boxes");
        const ToFront run(c.soup, c.options);
        Front front = run.front;
        const SurfaceIndex index(run.painted.soup);
        const FitSummary fitted = fitFront(front, run.lattice, index, run.graph, c.options.fit, Context());
        for (std::size_t v = 0; v < fitted.snaps.size(); ++v) {
            if (fitted.snaps[v].kind != SnapKind::implicitLine) continue;
            ++implicit;
            EXPECT_TRUE(index.closest(wallPoint(front, v), mostBentAway * front.h[v])) << "seed " << seed << ", node " << v;
        }
    }
    EXPECT_GT(implicit, casesPerShard); // else this would prove little
}

INSTANTIATE_TEST_SUITE_P(Shards, BoxesThatCross, testing::Range(0u, shards));

} // namespace
} // namespace i2b::test
