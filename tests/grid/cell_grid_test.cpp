// Proves: the grid covers the domain without overlap, is graded 2:1 across faces, edges and corners, meets the sizes
// asked for where the geometry is, keeps the buffer, and cut cells are exactly those that a triangle meets.
#include "i2b/geometry/triangle_box.h"
#include "i2b/grid/build.h"
#include "i2b/grid/cut.h"
#include "i2b/grid/mask_ops.h"
#include <gtest/gtest.h>
#include <random>
#include <tbb/global_control.h>

namespace i2b {
namespace {

Surface randomSoup(unsigned seed, int triangles, int parts) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> place(-1, 1), size(-0.4, 0.4);
    Surface s;
    for (int p = 0; p < parts; ++p) s.parts.push_back({"p" + std::to_string(p), "", 0});
    for (int t = 0; t < triangles; ++t) {
        const Vec3 c{place(random), place(random), place(random)};
        for (int k = 0; k < 3; ++k) s.points.push_back(c + Vec3{size(random), size(random), size(random)});
        const auto n = static_cast<std::uint32_t>(3 * t);
        s.triangles.push_back({n, n + 1, n + 2});
        s.partOf.push_back(t % parts);
    }
    return s;
}

struct Built {
    SizeField field;
    CellGrid grid;
    CutCells cut;
};

Built build(const Surface& soup, const SizeOptions& size) {
    Built b;
    DomainOptions domain;
    domain.box = Box{{-2, -2.5, -2}, {2, 2, 3}};
    b.field = makeSizeField(soup, size, domain);
    const std::vector<CellLevel> at = cutAtTargetLevels(soup, b.field);
    b.grid = buildCellGrid(b.field, wantedCells(b.field, at));
    b.cut = cutLeafCells(soup, b.field, b.grid, at);
    return b;
}

// Every leaf cell is marked cut exactly where a triangle meets it, and as fine as those triangles ask.
void expectExact(const Surface& soup, const SizeOptions& size) {
    const Built b = build(soup, size);
    EXPECT_EQ(b.grid.validate(), "");
    for (std::size_t l = 0; l < b.grid.levels.size(); ++l) {
        const MaskReader cut(*b.cut.levels[l]);
        for (auto it = b.grid.levels[l].cells->cbeginValueOn(); it; ++it) {
            const Box box = b.grid.lattice.cellBox(b.grid.levels[l].level, toIndex(it.getCoord()));
            bool meets = false;
            for (std::size_t t = 0; t < soup.triangles.size(); ++t) {
                const auto& v = soup.triangles[t];
                if (!triangleMeetsBox(soup.points[v[0]], soup.points[v[1]], soup.points[v[2]], box)) continue;
                meets = true;
                const LevelTriple asked = b.field.target(soup, t), level = b.grid.levels[l].level;
                EXPECT_EQ(finerOf(level, asked), level);
            }
            EXPECT_EQ(cut.isValueOn(it.getCoord()), meets);
            if (box.overlaps(Box{{-1.49, -1.49, -1.49}, {-1.21, -1.11, -1.01}})) {
                EXPECT_LE(b.grid.lattice.h(b.grid.levels[l].level), 0.08 * (1 + 1e-9));
            }
        }
    }
}

class Grid : public testing::TestWithParam<unsigned> {};

TEST_P(Grid, IsValidAndCutsAreExact) {
    SizeOptions size;
    size.surface = 0.13;
    size.max = 0.6;
    size.parts.push_back({"p1", sameSize(0.07)});
    size.boxes.push_back({{{-1.5, -1.5, -1.5}, {-1.2, -1.1, -1}}, sameSize(0.08)});
    expectExact(randomSoup(GetParam(), 30, 3), size);
}

TEST_P(Grid, IsValidAndExactWithOneSizePerAxis) {
    SizeOptions size;
    size.surface = 0.26;
    size.max = 0.6;
    size.parts.push_back({"p1", {0.07, 0.26, 0.13}});
    size.parts.push_back({"p2", {0.26, 0.26, 0.07}});
    size.boxes.push_back({{{-1.5, -1.5, -1.5}, {-1.2, -1.1, -1}}, sameSize(0.08)});
    expectExact(randomSoup(GetParam(), 15, 3), size);
}

TEST_P(Grid, IsTheSameOnAnyNumberOfThreads) {
    const Surface soup = randomSoup(GetParam(), 60, 2);
    SizeOptions size;
    size.surface = 0.1;
    size.max = 1;
    std::vector<std::uint64_t> sums;
    for (std::size_t threads : {1, 2, 3, 8}) {
        tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
        sums.push_back(build(soup, size).grid.checksum());
    }
    for (std::uint64_t s : sums) EXPECT_EQ(s, sums.front());
}

INSTANTIATE_TEST_SUITE_P(Random, Grid, testing::Range(1u, 6u));

} // namespace
} // namespace i2b
