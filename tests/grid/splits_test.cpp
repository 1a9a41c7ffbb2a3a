// Axes that split on their own: random wishes per axis give a valid, graded 2^n tree that grants every one of them.
#include "i2b/grid/build.h"
#include "i2b/grid/splits.h"
#include "i2b/grid/resample.h"
#include <gtest/gtest.h>
#include <random>

namespace i2b {
namespace {

SizeField emptyField(int maxLevel, int buffer) {
    SizeField field;
    field.lattice.origin = {0, 0, 0};
    field.lattice.base = {1, 1, 1};
    field.lattice.count = {5, 4, 3};
    field.lattice.maxLevel = maxLevel;
    field.bufferCells = buffer;
    return field;
}

// Boxes with a level of their own along each axis.
SizeField randomWishes(unsigned seed, int maxLevel, int buffer) {
    std::mt19937 random(seed);
    const auto unit = [&] { return static_cast<double>(random()) / 4294967296.0; };
    SizeField field = emptyField(maxLevel, buffer);
    for (int i = 0; i < 4; ++i) {
        const Vec3 lo{5 * unit(), 4 * unit(), 3 * unit()};
        LevelBox rule{{lo, lo + Vec3{0.4 * unit(), 0.4 * unit(), 0.4 * unit()}}, {}};
        for (std::size_t a = 0; a < 3; ++a) rule.level[a] = static_cast<std::uint8_t>(random() % unsigned(maxLevel + 1));
        field.boxes.push_back(rule);
    }
    return field;
}

class RandomSplits : public testing::TestWithParam<unsigned> {};

TEST_P(RandomSplits, GrantEveryWishInAValidGrid) {
    const unsigned seed = GetParam();
    const SizeField field = randomWishes(seed, 2 + static_cast<int>(seed % 3), 1 + static_cast<int>(seed % 2));
    const CellGrid grid = buildCellGrid(field, wantedCells(field, {}));
    ASSERT_EQ(grid.validate(), "");
    for (const LevelBox& rule : field.boxes) {
        for (const CellLevel& level : grid.levels) {
            if (finerOf(level.level, rule.level) == level.level) continue;
            for (auto it = level.cells->cbeginValueOn(); it; ++it) {
                const Box box = grid.lattice.cellBox(level.level, toIndex(it.getCoord()));
                EXPECT_FALSE(box.lo.x < rule.box.hi.x && box.hi.x > rule.box.lo.x && box.lo.y < rule.box.hi.y &&
                             box.hi.y > rule.box.lo.y && box.lo.z < rule.box.hi.z && box.hi.z > rule.box.lo.z);
            }
        }
    }
}
INSTANTIATE_TEST_SUITE_P(Seeds, RandomSplits, testing::Range(0u, 40u));

// The general road must give the octree where all axes ask for the same.
TEST(Splits, EqualAxesGiveTheOctree) {
    for (unsigned seed = 0; seed < 10; ++seed) {
        SizeField field = randomWishes(seed, 3, 2);
        for (LevelBox& rule : field.boxes) rule.level = allAxes(rule.level.x);
        WantedCells wanted = wantedCells(field, {});
        ASSERT_FALSE(wanted.perAxis);
        const CellGrid octree = buildCellGrid(field, wanted);
        wanted.perAxis = true;
        const CellGrid general = buildCellGrid(field, wanted);
        EXPECT_EQ(general.cellCount(), octree.cellCount());
        for (const CellLevel& level : general.levels) {
            ASSERT_TRUE(level.level.same());
            const Mask& same = *octree.levels[level.level.x].cells;
            EXPECT_EQ(countOf(*differenceOf(*level.cells, same)), 0u);
            EXPECT_EQ(countOf(*differenceOf(same, *level.cells)), 0u);
        }
    }
}

// A wish along one axis alone splits nothing else, so it costs the ratio and not its cube.
TEST(Splits, OneAxisSplitsAlone) {
    SizeField field = emptyField(3, 1);
    field.boxes.push_back({field.lattice.domain(), {3, 0, 0}});
    const CellGrid grid = buildCellGrid(field, wantedCells(field, {}));
    EXPECT_EQ(grid.validate(), "");
    ASSERT_EQ(grid.levels.size(), 1u);
    EXPECT_EQ(grid.levels[0].level, (LevelTriple{3, 0, 0}));
    EXPECT_EQ(grid.cellCount(), 8u * 5 * 4 * 3);
}

TEST(Resample, GoesThereAndBack) {
    std::mt19937 random(7);
    Mask cells(false);
    for (int i = 0; i < 300; ++i) cells.setValueOn({int(random() % 40), int(random() % 40), int(random() % 40)});
    const LevelTriple from{2, 3, 1}, fine{3, 4, 4}, coarse{1, 3, 0}, mixed{4, 1, 2};
    const Mask::Ptr up = overlapping(cells, from, fine);
    EXPECT_EQ(countOf(*up), countOf(cells) * 2 * 2 * 8);
    EXPECT_EQ(countOf(*differenceOf(*sampled(*up, fine, from), cells)), 0u);
    EXPECT_EQ(countOf(*overlapping(*up, fine, from)), countOf(cells));
    const Mask::Ptr down = overlapping(cells, from, coarse), across = overlapping(cells, from, mixed);
    for (auto it = cells.cbeginValueOn(); it; ++it) {
        const openvdb::Coord c = it.getCoord();
        EXPECT_TRUE(down->isValueOn({c.x() >> 1, c.y(), c.z() >> 1}));
        EXPECT_TRUE(across->isValueOn({c.x() * 4 + 3, c.y() >> 2, c.z() * 2 + 1}));
    }
}

} // namespace
} // namespace i2b
