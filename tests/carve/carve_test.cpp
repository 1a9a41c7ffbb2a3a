// Proves: what carve() leaves can be extruded at every vertex, comes apart alike at both ends of every edge,
// keeps its clearance and is in one piece, for random walls and for random soups, on grids with jumps in
// level.
#include "carve/kept_checks.h"
#include "i2b/carve/carve.h"
#include <gtest/gtest.h>
#include <tbb/global_control.h>

namespace i2b::test {
namespace {

class RandomWalls : public testing::TestWithParam<unsigned> {};

TEST_P(RandomWalls, LeaveAFrontThatCanBeExtruded) {
    for (unsigned i = 0; i < 12; ++i) {
        const unsigned seed = 100 * GetParam() + i;
        const int levels = 1 + static_cast<int>(seed % 3), buffer = 1 + static_cast<int>(seed / 3 % 2);
        const double closed = 0.02 + 0.04 * (seed % 8);
        const CarvedAtRandom c(seed, {7, 6, 9}, levels, buffer, closed, i % 2 == 1); // every other with one level per axis
        EXPECT_EQ(frontFault(c.grid, c.kept), "") << "seed " << seed;
        // Nothing is added, and all that goes is accounted for.
        const Region* painted = nullptr;
        for (const Region& r : c.regions.table) painted = r.painted ? &r : painted;
        ASSERT_NE(painted, nullptr);
        std::uint64_t outside = 0;
        const std::vector<Mask::Ptr> cells = c.regions.cellsOf(painted->id);
        for (std::size_t l = 0; l < cells.size(); ++l)
            outside += countOf(*differenceOf(*c.kept.levels[l], *cells[l]));
        EXPECT_EQ(outside, 0u);
        EXPECT_EQ(c.kept.carvedForClearance, 0u);
        EXPECT_EQ(c.kept.cellCount() + c.kept.carvedForFront + c.kept.droppedIslands, painted->cells)
            << "seed " << seed;
    }
}

INSTANTIATE_TEST_SUITE_P(Many, RandomWalls, testing::Range(0u, 8u));

class RandomSoups : public testing::TestWithParam<unsigned> {};

TEST_P(RandomSoups, KeepClearance) {
    for (unsigned i = 0; i < 5; ++i) {
        const unsigned seed = GetParam() + caseKinds * i;
        RandomCase c = randomCase(seed);
        c.options.fit.clearance = 0.1 + 0.05 * (i % 3);
        c.options.fit.passages = false;
        try {
            const Painted p(c);
            const KeptCells kept = carve(p.grid, p.cut, p.regions, *p.index, c.options.fit);
            EXPECT_EQ(frontFault(p.grid, kept), "") << c.kind << ", seed " << seed;
            EXPECT_GE(leastClearance(p.grid, kept, *p.index), c.options.fit.clearance)
                << c.kind << ", seed " << seed;
            std::uint64_t cut = 0;
            for (std::size_t l = 0; l < p.cut.levels.size(); ++l)
                cut += countOf(*intersectionOf(*kept.levels[l], *p.cut.levels[l]));
            EXPECT_EQ(cut, 0u);
            EXPECT_EQ(kept.zones.empty(), kept.zoneNames.size() == 1);
            for (std::size_t threads : {1, 3}) {
                const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
                EXPECT_EQ(carve(p.grid, p.cut, p.regions, *p.index, c.options.fit).checksum(),
                          kept.checksum());
            }
        } catch (const Error& e) {
            EXPECT_EQ(e.kind(), ErrorKind::input) << e.problem();
        }
    }
}

// Cells that come back have room, no wall to the kept cells that they share a face with, and leave a front that can be
// extruded; the same on any number of threads.
TEST_P(RandomSoups, GiveBackCellsThatHaveRoom) {
    for (unsigned i = 0; i < 5; ++i) {
        RandomCase c = randomCase(GetParam() + caseKinds * i);
        try {
            const Painted p(c);
            const KeptCells kept = carve(p.grid, p.cut, p.regions, *p.index, c.options.fit);
            EXPECT_EQ(frontFault(p.grid, kept), "") << c.kind;
            EXPECT_EQ(wallBetweenKept(p.grid, p.cut, kept, *p.index), "") << c.kind;
            EXPECT_EQ(voidInFlow(p.grid, p.cut, p.regions, kept), "") << c.kind << ", seed " << GetParam() + caseKinds * i;
            for (std::size_t threads : {1, 3}) {
                const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
                EXPECT_EQ(carve(p.grid, p.cut, p.regions, *p.index, c.options.fit).checksum(), kept.checksum());
            }
        } catch (const Error& e) {
            EXPECT_EQ(e.kind(), ErrorKind::input) << e.problem();
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Kinds, RandomSoups, testing::Range(0u, caseKinds));

// Six sides; the top is cut in two, so far to either side of y = 0.
void addBlock(Surface& soup, const Box& b, double crack = 0) {
    const auto side = [&](std::initializer_list<Vec3> corners) {
        const auto n = static_cast<std::uint32_t>(soup.points.size());
        soup.points.insert(soup.points.end(), corners);
        soup.triangles.insert(soup.triangles.end(), {{n, n + 1, n + 2}, {n, n + 2, n + 3}});
        soup.partOf.insert(soup.partOf.end(), {0, 0});
    };
    const Vec3 &l = b.lo, &h = b.hi;
    side({{l.x, l.y, l.z}, {h.x, l.y, l.z}, {h.x, h.y, l.z}, {l.x, h.y, l.z}});
    side({{l.x, l.y, h.z}, {h.x, l.y, h.z}, {h.x, -crack, h.z}, {l.x, -crack, h.z}});
    side({{l.x, crack, h.z}, {h.x, crack, h.z}, {h.x, h.y, h.z}, {l.x, h.y, h.z}});
    for (double x : {l.x, h.x}) side({{x, l.y, l.z}, {x, h.y, l.z}, {x, h.y, h.z}, {x, l.y, h.z}});
    for (double y : {l.y, h.y}) side({{l.x, y, l.z}, {h.x, y, l.z}, {h.x, y, h.z}, {l.x, y, h.z}});
}

// A slot of 1.7 cells between two blocks, off the lattice: no cell in it is uncut, yet it is meshed from end to end. A
// crack of a quarter of a cell in a plate lets nothing through.
TEST(Carve, MeshesNarrowSlotsAndClosesCracks) {
    RandomCase c = randomCase(0);
    c.options.size = {};
    c.options.size.surface = c.options.size.max = 0.1;
    c.options.domain.flow = Flow::external;
    c.options.domain.box = Box{{-2, -2, -2}, {2, 2, 2}};
    c.soup = Surface{};
    c.soup.parts = {{"blocks", "", 28}};
    for (double z : {-0.3, 0.187}) addBlock(c.soup, {{-1, -1, z}, {1, 1, z + 0.317}});
    const Painted slot(c);
    const KeptCells kept = carve(slot.grid, slot.cut, slot.regions, *slot.index, FitOptions{});
    const int level = slot.grid.lattice.maxLevel;
    for (double x = -0.85; x < 0.9; x += 0.1) {
        bool meshed = false;
        for (double z : {0.05, 0.15}) {
            const Index3 cell = slot.grid.lattice.cellAt(level, {x, 0.05, z});
            meshed = meshed || kept.levels[static_cast<std::size_t>(level)]->isValueOn(toCoord(cell));
        }
        EXPECT_TRUE(meshed) << x;
    }
    c.soup = Surface{};
    c.soup.parts = {{"box", "", 14}};
    addBlock(c.soup, {{-1, -1, -1}, {1, 1, 1}}, 0.0125);
    const Painted box(c);
    const KeptCells outside = carve(box.grid, box.cut, box.regions, *box.index, FitOptions{});
    const Index3 within = box.grid.lattice.cellAt(level, {0, 0, 0.85});
    EXPECT_FALSE(outside.levels[static_cast<std::size_t>(level)]->isValueOn(toCoord(within)));
    EXPECT_EQ(wallBetweenKept(box.grid, box.cut, outside, *box.index), "");
}

// An opening of two cells into a chamber: paint runs through, but all cells in it have vertices too near its edges. They come back as a
// passage, and with them all of the chamber, whatever the size of its cells; without passages it is left out, and that is told.
TEST(Carve, BringsBackWhatAPassageLeadsTo) {
    RandomCase c = randomCase(0);
    c.options.size = {};
    c.options.size.surface = 0.1, c.options.size.max = 0.4;
    c.options.domain.flow = Flow::external;
    c.options.domain.box = Box{{-4, -4, -4}, {4, 4, 4}};
    c.soup = Surface{};
    c.soup.parts = {{"chamber", "", 14}};
    addBlock(c.soup, {{-1.995, -1.995, -1.995}, {1.995, 1.995, 1.995}}, 0.105);
    const Painted p(c);
    const auto isKept = [&](const KeptCells& kept, const Vec3& at) {
        for (std::size_t l = 0; l < kept.levels.size(); ++l)
            if (kept.levels[l]->isValueOn(toCoord(p.grid.lattice.cellAt(static_cast<int>(l), at)))) return true;
        return false;
    };
    const KeptCells kept = carve(p.grid, p.cut, p.regions, *p.index, FitOptions{});
    EXPECT_FALSE(p.grid.levels.front().cells->isValueOff(toCoord(p.grid.lattice.cellAt(0, {0.1, 0.1, 0.1})))) << "the middle is coarse";
    for (const Vec3& at : {Vec3{0.1, 0.1, 0.1}, Vec3{1.7, 1.7, 1.7}, Vec3{0.05, 0.05, 1.99}}) EXPECT_TRUE(isKept(kept, at)) << at.x << " " << at.z;
    EXPECT_EQ(voidInFlow(p.grid, p.cut, p.regions, kept), "");
    EXPECT_TRUE(kept.leftOut.empty());
    FitOptions without;
    without.passages = false;
    const KeptCells outside = carve(p.grid, p.cut, p.regions, *p.index, without);
    EXPECT_FALSE(isKept(outside, {0.1, 0.1, 0.1}));
    ASSERT_EQ(outside.leftOut.size(), 1u);
    EXPECT_EQ(outside.leftOut[0].cells, outside.droppedIslands);
}

// A passage one cell wide between walls that fill their cells: nothing can be left of it.
TEST(Carve, RefusesWhatIsTooNarrow) {
    RandomCase c = randomCase(0);
    c.soup = Surface{};
    c.soup.parts = {{"slit", "", 4}};
    for (double x : {-0.1, 0.1}) {
        const auto n = static_cast<std::uint32_t>(c.soup.points.size());
        c.soup.points.insert(c.soup.points.end(), {{x, -2, -2}, {x, 2, -2}, {x, 2, 2}, {x, -2, 2}});
        c.soup.triangles.insert(c.soup.triangles.end(), {{n, n + 1, n + 2}, {n, n + 2, n + 3}});
        c.soup.partOf.insert(c.soup.partOf.end(), {0, 0});
    }
    c.options.size = {};
    c.options.size.surface = c.options.size.max =
        0.2; // planes at -0.1 and 0.1 are faces of cells: one cell between
    c.options.domain.flow = Flow::automatic;
    c.options.domain.box = Box{{-1.1, -1, -1}, {1.1, 1, 1}};
    const Painted all(c);
    EXPECT_EQ(all.regions.table.size(), 2u); // the cells between are cut, for touching counts
    c.options.domain.seeds = {{"slit", {0, 0, 0}}};
    EXPECT_THROW(Painted{c}, Error);
}

// Around one cell and a little more: painted, but too close to the walls to be kept. That is refused, never an empty mesh.
TEST(Carve, RefusesWhatHasNoCellLeft) {
    for (const double around : {0.001, 0.003, 0.006}) {
        RandomCase c = randomCase(0);
        c.soup = Surface{};
        c.soup.parts = {{"box", "", 14}};
        const double lo = 0.2 - around, hi = 0.3 + around;
        addBlock(c.soup, {{lo, -lo - 0.5, lo}, {hi, hi, hi}});
        c.options.size = {};
        c.options.size.surface = c.options.size.max = 0.1;
        c.options.domain.flow = Flow::internal;
        c.options.domain.box = Box{{-1, -1, -1}, {1, 1, 1}};
        const Painted p(c);
        EXPECT_GT(p.regions.table.size(), 1u);
        try {
            EXPECT_GT(carve(p.grid, p.cut, p.regions, *p.index, c.options.fit).cellCount(), 0u) << around;
        } catch (const Error& e) {
            EXPECT_EQ(e.kind(), ErrorKind::input);
            EXPECT_NE(e.problem().find("nothing is left"), std::string::npos) << e.problem();
        }
    }
}

} // namespace
} // namespace i2b::test
