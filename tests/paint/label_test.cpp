// Proves: regions are exactly the face-connected sets that a plain flood over the cells finds, across nodes
// and levels, in the promised order, with the right figures, on any number of threads.
#include "paint/random_grid.h"
#include <gtest/gtest.h>
#include <tbb/global_control.h>

namespace i2b::test {
namespace {

struct Case {
    unsigned seed;
    Index3 count;
    int levels, buffer;
    double closed; // share of the cells
    bool perAxis = false;
};

class Label : public testing::TestWithParam<Case> {};

TEST_P(Label, EqualsAPlainFlood) {
    const auto [seed, count, levels, buffer, closed, perAxis] = GetParam();
    const CellGrid grid = randomGrid(seed, count, levels, buffer, perAxis);
    ASSERT_EQ(grid.validate(), "");
    const CutCells cut = randomCut(grid, seed + 100, closed);
    const Regions regions = labelRegions(grid, cut);
    const CellArray array(grid);
    std::vector<bool> open = array.flagged(cut.levels);
    open.flip();
    const std::vector<int> label = array.flood(open);

    const int expected = label.empty() ? 0 : *std::max_element(label.begin(), label.end()) + 1;
    ASSERT_EQ(regions.table.size(), static_cast<std::size_t>(expected));
    std::vector<int> mine(array.cells.size(), -1);
    for (const Region& r : regions.table) {
        const std::vector<bool> in = array.flagged(regions.cellsOf(r.id));
        for (std::size_t i = 0; i < in.size(); ++i) {
            if (!in[i]) continue;
            EXPECT_EQ(std::exchange(mine[i], r.id), -1) << "cell in two regions";
        }
    }
    // The flood numbers by first cell in the same order, so labels must agree one by one. Inside a node
    // "first" goes bit by bit, which is the array's order too.
    EXPECT_EQ(mine, label);

    for (const Region& r : regions.table) {
        Region brute;
        bool first = true;
        for (std::size_t i = 0; i < array.cells.size(); ++i) {
            if (label[i] != r.id) continue;
            const Box box = grid.lattice.cellBox(array.cells[i].triple, array.cells[i].at);
            if (std::exchange(first, false)) brute.seed = box.centre();
            const Vec3 e = box.extent();
            ++brute.cells;
            brute.volume += e.x * e.y * e.z;
            brute.box.add(box);
        }
        const Box all = grid.lattice.domain();
        bool touches = false;
        for (int a = 0; a < 3; ++a)
            touches = touches || brute.box.lo[a] == all.lo[a] || brute.box.hi[a] == all.hi[a];
        EXPECT_EQ(r.id, &r - regions.table.data());
        EXPECT_EQ(r.cells, brute.cells);
        EXPECT_NEAR(r.volume, brute.volume, 1e-12);
        EXPECT_EQ(r.box, brute.box);
        EXPECT_EQ(r.seed, brute.seed); // levels come coarse first: the largest, then first cell
        EXPECT_EQ(r.touchesDomainBox, touches);
        EXPECT_FALSE(r.painted);
    }
}

TEST_P(Label, IsTheSameOnAnyNumberOfThreads) {
    const auto [seed, count, levels, buffer, closed, perAxis] = GetParam();
    const CellGrid grid = randomGrid(seed, count, levels, buffer, perAxis);
    const CutCells cut = randomCut(grid, seed + 100, closed);
    const std::uint64_t expected = labelRegions(grid, cut).checksum();
    for (std::size_t threads : {1, 2, 3, 8}) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        EXPECT_EQ(labelRegions(grid, cut).checksum(), expected) << threads << " threads";
    }
}

INSTANTIATE_TEST_SUITE_P(Random, Label,
                         testing::Values(Case{1, {9, 7, 11}, 3, 1, 0.6}, Case{2, {5, 12, 9}, 3, 2, 0.7},
                                         Case{3, {17, 18, 5}, 2, 3, 0.65}, Case{4, {20, 20, 20}, 1, 1, 0.68},
                                         Case{5, {3, 4, 5}, 4, 1, 0.6}, Case{6, {6, 6, 6}, 4, 1, 0.75},
                                         Case{7, {1, 1, 9}, 3, 1, 0.4}, Case{8, {8, 8, 8}, 2, 1, 0.0},
                                         Case{9, {8, 8, 8}, 2, 1, 1.0},
                                         Case{10, {9, 7, 11}, 3, 1, 0.5, true}, Case{11, {5, 6, 4}, 4, 1, 0.6, true},
                                         Case{12, {3, 4, 5}, 4, 2, 0.5, true}, Case{13, {8, 3, 4}, 3, 1, 0.0, true}));

} // namespace
} // namespace i2b::test
