// Proves: cells along every ray between opposite walls are so small that the number asked for fits, wherever the gap is
// wider than the smallest cell; parts, orientation, repeated sheets and threads do not matter; and nothing is asked for
// where walls stand alone or at a right angle.
#include "grid/cell_at.h"
#include "i2b/grid/build.h"
#include "i2b/grid/cut.h"
#include "i2b/sizing/automatic.h"
#include "sizing/soups.h"
#include <gmock/gmock.h>
#include <tbb/global_control.h>

namespace i2b::test {
namespace {

struct Meshed {
    SizeField field;
    CellGrid grid;
};

Meshed mesh(const Surface& soup, int gapCells, double min = 0.01) {
    SizeOptions size;
    size.surface = 0.2, size.max = 0.4, size.min = min, size.gapCells = gapCells, size.bufferCells = 1;
    DomainOptions domain;
    domain.box = Box{{-2, -2, -2}, {2, 2, 2}};
    Meshed m;
    m.field = makeSizeField(soup, size, domain);
    const SurfaceIndex index(soup);
    addGaps(m.field, findGaps(m.field, index, size), size);
    const std::vector<CellLevel> at = cutAtTargetLevels(soup, m.field);
    m.grid = buildCellGrid(m.field, wantedCells(m.field, at));
    return m;
}

Surface plates(double gap, std::int32_t secondPart = 0) {
    Surface s;
    addQuad(s, {-1, -1, 0.003}, {1, -1, 0.003}, {1, 1, 0.003}, {-1, 1, 0.003});
    addQuad(s, {-1, -1, 0.003 + gap}, {1, -1, 0.003 + gap}, {1, 1, 0.003 + gap}, {-1, 1, 0.003 + gap}, secondPart);
    return s;
}

TEST(Gaps, ParallelPlatesHoldTheCells) {
    for (const double gap : {0.03, 0.07, 0.19, 0.5, 1.1}) {
        for (const int count : {2, 3, 5}) {
            const Meshed m = mesh(plates(gap), count);
            EXPECT_EQ(m.grid.validate(), "");
            const double asked = std::max(gap / count, 0.01);
            for (double x = -0.97; x < 1; x += 0.061) {
                for (double z = 0.05; z < 1; z += 0.1) {
                    EXPECT_LE(cellAt(m.grid, {x, 0.83 * x * x - 0.4, 0.003 + z * gap}), asked * (1 + 1e-9)) << gap << " " << count;
                }
            }
            EXPECT_GE(m.field.minSize, std::min(0.1, asked / 2) * (1 - 1e-9)); // and no smaller than it takes
        }
    }
}

TEST(Gaps, WedgesHoldTheCellsDownToTheSmallest) {
    Surface s; // opens along x by 2 * 0.15 per length
    addQuad(s, {-1, -1, 0}, {1, -1, 0.3}, {1, 1, 0.3}, {-1, 1, 0});
    addQuad(s, {-1, -1, 0}, {1, -1, -0.3}, {1, 1, -0.3}, {-1, 1, 0});
    const Meshed m = mesh(s, 3);
    for (double x = -0.9; x < 0.95; x += 0.017) {
        const double width = 0.3 * (x + 1);
        for (const double y : {-0.71, 0.02, 0.93}) {
            EXPECT_LE(cellAt(m.grid, {x, y, 0.01 * width}), std::max(width / 3, 0.0125) * (1 + 1e-9)) << x;
        }
    }
    EXPECT_THAT(m.field.notes, testing::ElementsAre(testing::HasSubstr("hold fewer than 3")));
}

TEST(Gaps, PartsOrientationAndRepeatsDoNotMatter) {
    const Surface one = plates(0.1);
    const std::uint64_t sum = mesh(one, 4).grid.checksum();
    EXPECT_EQ(mesh(plates(0.1, 1), 4).grid.checksum(), sum);
    for (unsigned seed = 0; seed < 4; ++seed) EXPECT_EQ(mesh(reversedAtRandom(one, seed), 4).grid.checksum(), sum);
    Surface twice = one;
    twice.triangles.insert(twice.triangles.end(), one.triangles.begin(), one.triangles.end());
    twice.partOf.resize(twice.triangles.size());
    EXPECT_EQ(mesh(twice, 4).grid.checksum(), sum);
    for (const std::size_t threads : {1, 2, 3, 8}) {
        const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
        EXPECT_EQ(mesh(one, 4).grid.checksum(), sum);
    }
}

// Sheets closer than the smallest cell are one wall; a plate alone and a right angle hold no gap.
TEST(Gaps, CracksAndLoneWallsAskForNothing) {
    EXPECT_TRUE(mesh(plates(0.004), 4).field.gaps.empty());
    EXPECT_TRUE(mesh(plates(0), 4).field.gaps.empty());
    Surface s;
    addQuad(s, {-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0});
    EXPECT_TRUE(mesh(s, 4).field.gaps.empty());
    addQuad(s, {-1, -1, 0}, {-1, 1, 0}, {-1, 1, 1}, {-1, -1, 1});
    EXPECT_TRUE(mesh(s, 4).field.gaps.empty());
}

// A large triangle of which one corner lies in a gap stays coarse elsewhere.
TEST(Gaps, OnlyTheGapIsRefined) {
    Surface s;
    addTriangle(s, {-1.5, -1.5, 0.003}, {1.5, -1.5, 0.003}, {-1.5, 1.5, 0.003});
    addQuad(s, {-1.5, -1.5, 0.1}, {-1.3, -1.5, 0.1}, {-1.3, -1.3, 0.1}, {-1.5, -1.3, 0.1});
    const Meshed m = mesh(s, 4);
    EXPECT_LE(cellAt(m.grid, {-1.4, -1.4, 0.05}), 0.097 / 4);
    EXPECT_GE(cellAt(m.grid, {0.1, -0.7, 0.05}), 0.1);
}

} // namespace
} // namespace i2b::test
