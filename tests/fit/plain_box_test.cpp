// Proves: wherever a box lies in the lattice, its wall is on it, and its edges are sharp.
#include "i2b/geometry/surface_index.h"
#include "pipeline/stages_run.h"
#include <algorithm>
#include <gtest/gtest.h>

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
        int extreme = 0, edge = 0;
        for (int k = 0; k < 3; ++k) {
            const bool isOut = std::abs(p[k]) > half - 1e-3 * stagesSize;
            extreme += isOut;
            edge += isOut ? (p[k] > 0 ? 1 : 0) << (2 - extreme) : 4 * k;
        }
        atCorners += extreme == 3;
        if (extreme == 2) atEdges[edge] += 1;
    }
    EXPECT_EQ(off, 0u);
    EXPECT_GE(atCorners, 5u); // all eight but at one place of the twenty
    EXPECT_GE(*std::min_element(std::begin(atEdges), std::end(atEdges)), std::floor(2 * half / stagesSize) - 2); // nodes of a cell each
}

INSTANTIATE_TEST_SUITE_P(Places, PlainBox, testing::Range(0, 20));

} // namespace
} // namespace i2b::test
