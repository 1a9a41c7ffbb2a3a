// Proves: the parts beside a region are those of the triangles that meet a cut cell which shares a face with it, in grids
// of any levels, on any number of threads.
#include "i2b/geometry/triangle_box.h"
#include "i2b/grid/cut.h"
#include "i2b/paint/touched_parts.h"
#include "paint/random_grid.h"
#include <gtest/gtest.h>
#include <set>
#include <tbb/global_control.h>

namespace i2b::test {
namespace {

struct Soup {
    Surface surface;
    SizeField field;
    CellGrid grid;
    CutCells cut;
    Regions regions;

    // Closed shells of a few parts each, so that there are regions to tell apart.
    Soup(unsigned seed, bool perAxis) {
        std::mt19937 random(seed);
        const auto unit = [&] { return static_cast<double>(random()) / 4294967296.0; };
        for (int b = 0; b < 4; ++b) addBox({3 * unit(), 3 * unit(), 3 * unit()}, 0.4 + unit());
        SizeOptions size;
        size.surface = 0.25, size.max = 0.5, size.bufferCells = 1;
        size.parts = {{"p.*1", perAxis ? Vec3{0.25, 0.12, 0.06} : sameSize(0.12)}};
        DomainOptions domain;
        domain.box = Box{{-0.5, -0.5, -0.5}, {4.5, 4.5, 4.5}};
        field = makeSizeField(surface, size, domain);
        const std::vector<CellLevel> at = cutAtTargetLevels(surface, field);
        grid = buildCellGrid(field, wantedCells(field, at));
        cut = cutLeafCells(surface, field, grid, at);
        regions = labelRegions(grid, cut);
        findTouchedParts(regions, surface, field, grid, cut);
    }
    void addBox(const Vec3& lo, double e) {
        const auto n = static_cast<std::uint32_t>(surface.points.size());
        for (int i = 0; i < 8; ++i) {
            surface.points.push_back(lo + Vec3{e * (i & 1), e * (i >> 1 & 1), e * (i >> 2)});
        }
        constexpr std::uint32_t sides[6][4] = {{0, 1, 3, 2}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 3, 7, 5}};
        for (const auto& s : sides) { // every side a part
            const auto part = static_cast<std::int32_t>(surface.parts.size());
            surface.parts.push_back({"p" + std::to_string(part), "", 2});
            surface.triangles.push_back({n + s[0], n + s[1], n + s[2]});
            surface.triangles.push_back({n + s[0], n + s[2], n + s[3]});
            surface.partOf.insert(surface.partOf.end(), 2, part);
        }
    }
    std::vector<std::set<std::int32_t>> bruteForce() const;
};

std::vector<std::set<std::int32_t>> Soup::bruteForce() const {
    const CellArray array(grid);
    const std::vector<bool> closed = array.flagged(cut.levels);
    std::vector<std::vector<bool>> member;
    for (const Region& r : regions.table) member.push_back(array.flagged(regions.cellsOf(r.id)));
    std::vector<std::set<std::int32_t>> parts(regions.table.size());
    const Index3 n = array.size;
    for (int i = 0; i < n[0] * n[1] * n[2]; ++i) {
        const Index3 p{i % n[0], i / n[0] % n[1], i / n[0] / n[1]};
        const int c = array.at(p);
        if (!closed[std::size_t(c)]) continue;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            for (int step : {-1, 1}) {
                Index3 q = p;
                q[axis] += step;
                const int other = array.at(q);
                if (other < 0 || closed[std::size_t(other)]) continue;
                for (std::size_t r = 0; r < parts.size(); ++r) {
                    if (!member[r][std::size_t(other)]) continue;
                    const GridCell& cell = array.cells[std::size_t(c)];
                    const Box box = grid.lattice.cellBox(cell.triple, cell.at);
                    for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
                        const auto& v = surface.triangles[t];
                        if (triangleMeetsBox(surface.points[v[0]], surface.points[v[1]], surface.points[v[2]], box)) {
                            parts[r].insert(surface.partOf[t]);
                        }
                    }
                }
            }
        }
    }
    return parts;
}

class TouchedParts : public testing::TestWithParam<unsigned> {};

TEST_P(TouchedParts, AreThoseOfTheCutCellsBeside) {
    const Soup soup(GetParam(), GetParam() % 2 == 1);
    ASSERT_GE(soup.regions.table.size(), 2u);
    const auto expected = soup.bruteForce();
    for (std::size_t r = 0; r < expected.size(); ++r) {
        EXPECT_EQ(soup.regions.table[r].parts, std::vector<std::int32_t>(expected[r].begin(), expected[r].end())) << r;
    }
}
INSTANTIATE_TEST_SUITE_P(Random, TouchedParts, testing::Range(0u, 6u));

TEST(TouchedPartsThreads, DoNotMatter) {
    Soup soup(3, false);
    const std::vector<Region> first = soup.regions.table;
    for (const std::size_t threads : {1, 2, 3, 8}) {
        const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
        findTouchedParts(soup.regions, soup.surface, soup.field, soup.grid, soup.cut);
        for (std::size_t r = 0; r < first.size(); ++r) EXPECT_EQ(soup.regions.table[r].parts, first[r].parts);
    }
}

} // namespace
} // namespace i2b::test
