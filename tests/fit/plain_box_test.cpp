// Proves: wherever a box lies in the lattice, its wall is on it, its edges are sharp, and each corner has a node.
#include "i2b/geometry/surface_index.h"
#include "pipeline/stages_run.h"
#include <algorithm>
#include <gtest/gtest.h>
#include <random>

namespace i2b::test {
namespace {

class PlainBox : public testing::TestWithParam<int> {}; // twentieths of a cell that its sides lie beyond faces of the lattice

TEST_P(PlainBox, IsMetEverywhere) {
    const double half = 0.6 + GetParam() * stagesSize / 20;
    Surface soup;
    addPart(soup, samples::box({-half, -half, -half}, {half, half, half}), "box");
    const ToMesh run(soup, stagesOptions());
    const SurfaceIndex index(run.painted.soup);
    std::size_t atCorners = 0, off = 0;
    double atEdges[12] = {};
    for (std::size_t v = 0; v < run.front.front.size(); ++v) {
        const Vec3 p = wallPoint(run.front, v);
        off += index.closest(p).distance > 0.01 * stagesSize;
        int extreme = 0, ends = 0, along = 0; // sides of the box that the node is on; where these are two, at which ends of them
        for (int k = 0; k < 3; ++k) {
            const bool isOut = std::abs(p[k]) > half - 1e-3 * stagesSize;
            if (isOut) ends = 2 * ends + (p[k] > 0);
            else along = k;
            extreme += isOut;
        }
        atCorners += extreme == 3;
        if (extreme == 2) atEdges[4 * along + ends] += 1;
    }
    EXPECT_EQ(off, 0u);
    const bool isOnRim = GetParam() == 6; // 0.3 h: centres lie just at the least distance from the geometry, rounding decides which cells are kept
    EXPECT_GE(atCorners, isOnRim ? 5u : 8u);
    EXPECT_GE(*std::min_element(std::begin(atEdges), std::end(atEdges)), std::floor(2 * half / stagesSize) - 2); // nodes of a cell each
}

INSTANTIATE_TEST_SUITE_P(Places, PlainBox, testing::Range(0, 20));

class AnyBox : public testing::TestWithParam<unsigned> {}; // sides anywhere in their cells

TEST_P(AnyBox, HasItsCorners) {
    std::mt19937 random(GetParam());
    int exact = 0;
    constexpr int boxes = 5;
    for (int i = 0; i < boxes; ++i) {
        Vec3 lo, hi;
        for (int k = 0; k < 3; ++k) {
            lo[k] = -0.6 - stagesSize * double(random() % 1000) / 1000;
            hi[k] = 0.6 + stagesSize * double(random() % 1000) / 1000;
        }
        Surface soup;
        addPart(soup, samples::box(lo, hi), "box");
        const ToMesh run(soup, stagesOptions());
        for (int c = 0; c < 8; ++c) {
            const Vec3 corner{c & 1 ? hi.x : lo.x, c & 2 ? hi.y : lo.y, c & 4 ? hi.z : lo.z};
            double nearest = 1;
            for (std::size_t v = 0; v < run.front.front.size(); ++v) nearest = std::min(nearest, norm(wallPoint(run.front, v) - corner));
            EXPECT_LT(nearest, 0.1 * stagesSize) << "box " << i << ", corner " << c;
            exact += nearest < 0.01 * stagesSize;
        }
    }
    EXPECT_GE(exact, 8 * boxes - 3);
}

INSTANTIATE_TEST_SUITE_P(Seeds, AnyBox, testing::Range(0u, 8u));

} // namespace
} // namespace i2b::test
