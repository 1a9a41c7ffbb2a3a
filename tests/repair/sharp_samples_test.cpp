// Proves: samples and those of them that are captured are those of the report; judged anew after a node of an edge has moved away the samples
// beside it are lost, and after it is back all is as before. (Beside the repair, as it takes a mesh with a wall that can be moved.)
#include "i2b/quality/sharp_samples.h"
#include "repair/boxed.h"
#include <gtest/gtest.h>

namespace i2b::test {
namespace {

std::size_t lostOf(const SharpSamples& s) {
    std::size_t lost = 0;
    for (std::size_t i = 0; i < s.samples().size(); ++i) lost += !s.isCaptured(i);
    return lost;
}

TEST(SharpSamples, AreThoseOfTheReport) {
    Boxed b;
    const SharpSamples samples(b.run.mesh, b.cellFaces, b.run.graph, *b.run.painted.index, stagesSize);
    const FitReport fit = measureFit(b.run.mesh, b.cellFaces, *b.run.painted.index, b.run.graph);
    ASSERT_GT(fit.featureSamples, 500);
    EXPECT_EQ(static_cast<std::int64_t>(samples.samples().size()), fit.featureSamples);
    EXPECT_DOUBLE_EQ(1 - double(lostOf(samples)) / double(fit.featureSamples), fit.featureCaptureFraction);
}

TEST(SharpSamples, AreJudgedAnewWherePointsMove) {
    Boxed b;
    SharpSamples samples(b.run.mesh, b.cellFaces, b.run.graph, *b.run.painted.index, stagesSize);
    const std::size_t lost = lostOf(samples);
    std::vector<std::uint32_t> all(samples.samples().size());
    for (std::uint32_t i = 0; i < all.size(); ++i) all[i] = i;
    samples.judge(all);
    EXPECT_EQ(lostOf(samples), lost); // nothing has moved

    std::size_t v = 0; // held to an edge, far from corners
    while (b.run.fitted.snaps[v].kind != SnapKind::line || b.run.features.closestCorner(b.wallOf(v), 3 * stagesSize)) ++v;
    const Vec3 from = b.wallOf(v);
    std::vector<std::int32_t> beside; // faces of samples there
    for (const LostSample& s : samples.samples())
        if (norm(s.point - from) < 0.5 * stagesSize) beside.push_back(s.at.face);
    ASSERT_FALSE(beside.empty());
    const std::vector<std::uint32_t> near = samples.at(samples.grown(beside, 1));
    ASSERT_LT(near.size(), all.size() / 4);
    b.put(v, from + normalized(b.run.front.front[v] - from) * (0.4 * stagesSize));
    samples.judge(near);
    EXPECT_GT(lostOf(samples), lost);
    const std::vector<std::uint32_t> there = near;
    samples.judge(all);
    const std::size_t byAll = lostOf(samples);
    samples.judge(there);
    EXPECT_EQ(lostOf(samples), byAll); // none is lost farther away
    b.put(v, from);
    samples.judge(near);
    EXPECT_EQ(lostOf(samples), lost);
}

} // namespace
} // namespace i2b::test
