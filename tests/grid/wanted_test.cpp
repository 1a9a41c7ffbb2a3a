// Proves: in the finished grid every cell that meets a source is as fine as it asks, along each axis, whichever mix of
// sources and sizes is asked for; and the grid is the same on any number of threads.
#include "i2b/grid/build.h"
#include "i2b/grid/cut.h"
#include "i2b/grid/mask_ops.h"
#include <gtest/gtest.h>
#include <random>
#include <tbb/global_control.h>

namespace i2b {
namespace {

Surface plate() {
    Surface s;
    s.points = {{-0.5, -0.5, 0.1}, {0.7, -0.4, 0.2}, {0.1, 0.9, -0.2}};
    s.triangles = {{0, 1, 2}};
    s.partOf = {0};
    s.parts = {{"plate", "", 1}};
    return s;
}

SizeField randomField(const Surface& surface, unsigned seed) {
    std::mt19937 random(seed);
    const auto unit = [&] { return static_cast<double>(random()) / 4294967296.0; };
    const auto place = [&] { return Vec3{4 * unit() - 2, 4 * unit() - 2, 4 * unit() - 2}; };
    const auto size = [&] {
        if (seed % 2 == 0) return sameSize(0.06 + 0.4 * unit());
        return Vec3{0.06 + 0.4 * unit(), 0.06 + 0.4 * unit(), 0.06 + 0.4 * unit()};
    };
    SizeOptions o;
    o.surface = 0.4, o.max = 0.5, o.bufferCells = 1 + static_cast<int>(seed % 3);
    o.boxes = {{{{-1, -1, -1}, {-0.7, 0.2, -0.4}}, size()}};
    o.spheres = {{place(), 0.1 + 0.4 * unit(), size()}};
    o.cylinders = {{place(), place(), 0.1 + 0.2 * unit(), size()}};
    o.bands = {{"plate", 0.1 + 0.2 * unit(), size()}};
    o.points = {{place(), size()}};
    o.segments = {{place(), place(), size()}};
    o.lines = {{place(), place(), size()}};
    DomainOptions domain;
    domain.box = Box{{-2, -2, -2}, {2, 2.3, 2}};
    return makeSizeField(surface, o, domain);
}

CellGrid gridOf(const Surface& surface, const SizeField& field) {
    return buildCellGrid(field, wantedCells(field, cutAtTargetLevels(surface, field)));
}

class Wanted : public testing::TestWithParam<unsigned> {};

TEST_P(Wanted, SizesHoldWhereTheyAreAskedFor) {
    const Surface surface = plate();
    const SizeField field = randomField(surface, GetParam());
    ASSERT_EQ(field.shapes.size(), 6u);
    const CellGrid grid = gridOf(surface, field);
    EXPECT_EQ(grid.validate(), "");
    for (const CellLevel& level : grid.levels) {
        for (auto it = level.cells->cbeginValueOn(); it; ++it) {
            Box cell = grid.lattice.cellBox(level.level, toIndex(it.getCoord()));
            const Vec3 rim = cell.extent() * 1e-6; // what only touches a cell may count as its neighbour's
            cell = {cell.lo + rim, cell.hi - rim};
            for (const LevelBox& rule : field.boxes) {
                if (rule.box.overlaps(cell)) {
                    EXPECT_EQ(finerOf(level.level, rule.level), level.level);
                }
            }
            for (const LevelShape& rule : field.shapes) {
                const auto* const band = std::get_if<PartsBand>(&rule.shape);
                const bool meets = band ? bool(band->parts->closeEnough(cell.centre(), band->distance, band->distance))
                                        : coverOf(rule.shape, cell) != Cover::none;
                if (meets) {
                    EXPECT_EQ(finerOf(level.level, rule.level), level.level);
                }
            }
        }
    }
}

TEST_P(Wanted, IsTheSameOnAnyNumberOfThreads) {
    const Surface surface = plate();
    std::vector<std::uint64_t> sums;
    for (const std::size_t threads : {1, 2, 3, 8}) {
        const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
        sums.push_back(gridOf(surface, randomField(surface, GetParam())).checksum());
    }
    for (const std::uint64_t s : sums) EXPECT_EQ(s, sums.front());
}
INSTANTIATE_TEST_SUITE_P(Random, Wanted, testing::Range(0u, 8u));

} // namespace
} // namespace i2b
