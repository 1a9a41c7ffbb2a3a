// Proves: every kind of source marks all cells that it meets and, but for a band's tolerance, no others, on lattices with
// and without one size for all axes, across the domain's sides too; the result is the same on any number of threads.
#include "i2b/core/checksum.h"
#include "i2b/grid/fill_shape.h"
#include "i2b/grid/mask_ops.h"
#include <gtest/gtest.h>
#include <random>
#include <tbb/global_control.h>

namespace i2b {
namespace {

struct Random {
    explicit Random(unsigned seed) : engine(seed) {}
    double unit() { return static_cast<double>(engine()) / 4294967296.0; }
    Vec3 place() { return {8 * unit() - 1.5, 6 * unit() - 1, 5 * unit() - 1}; } // some outside the domain
    std::mt19937 engine;
};

Lattice lattice(bool cubes) {
    Lattice l;
    l.origin = {-1, -0.5, 0};
    l.base = cubes ? Vec3{1, 1, 1} : Vec3{1, 0.8, 0.7};
    l.count = {6, 5, 4};
    l.maxLevel = 3;
    return l;
}

// Calls f(cell box, marked) for every cell of the level.
template <class F>
void forEachCell(const Lattice& l, const LevelTriple& level, const Mask& mask, const F& f) {
    const Index3 n = l.cells(level);
    for (int x = 0; x < n[0]; ++x) {
        for (int y = 0; y < n[1]; ++y) {
            for (int z = 0; z < n[2]; ++z) f(l.cellBox(level, {x, y, z}), mask.isValueOn(openvdb::Coord(x, y, z)));
        }
    }
}

// Points of a box on a grid, its corners among them.
template <class F>
void forEachSample(const Box& box, const F& f) {
    constexpr int n = 4;
    const Vec3 e = box.extent();
    for (int i = 0; i <= n; ++i) {
        for (int j = 0; j <= n; ++j) {
            for (int k = 0; k <= n; ++k) f(box.lo + Vec3{e.x * i / n, e.y * j / n, e.z * k / n});
        }
    }
}

double pointBoxDistance(const Vec3& p, const Box& box) { return norm(p - cwiseMin(cwiseMax(p, box.lo), box.hi)); }

// By ternary search: the distance to a convex box is convex along a segment.
double segmentDistance(const Vec3& a, const Vec3& b, const Box& box) {
    double lo = 0, hi = 1;
    for (int i = 0; i < 120; ++i) {
        const double s = lo + (hi - lo) / 3, t = hi - (hi - lo) / 3;
        (pointBoxDistance(a + (b - a) * s, box) < pointBoxDistance(a + (b - a) * t, box) ? hi : lo) =
            pointBoxDistance(a + (b - a) * s, box) < pointBoxDistance(a + (b - a) * t, box) ? t : s;
    }
    return pointBoxDistance(a + (b - a) * (0.5 * (lo + hi)), box);
}

const LevelTriple levels[] = {{0, 0, 0}, {2, 2, 2}, {3, 1, 2}, {0, 3, 1}};

class Fill : public testing::TestWithParam<unsigned> {};

TEST_P(Fill, CapsulesMeetTheCellsThatTheyMark) {
    Random random(GetParam());
    const Lattice l = lattice(GetParam() % 2 == 0);
    const Vec3 a = random.place(), b = GetParam() % 3 == 0 ? a : random.place();
    const Capsule capsule{a, b, GetParam() % 4 == 0 ? 0 : 0.05 + random.unit()};
    for (const LevelTriple& level : levels) {
        const Mask::Ptr mask = cellsOf(Shape(capsule), l, level);
        EXPECT_FALSE(mask->hasActiveTiles());
        forEachCell(l, level, *mask, [&](const Box& cell, bool marked) {
            const double d = segmentDistance(a, b, cell) - capsule.radius;
            if (std::abs(d) > 1e-6) {
                EXPECT_EQ(marked, d < 0);
            }
        });
    }
}

// Points of the cells decide: one inside must mark its cell; a marked cell has one that is nearly inside.
TEST_P(Fill, CylindersHaveFlatEnds) {
    Random random(GetParam() + 100);
    const Lattice l = lattice(GetParam() % 2 == 0);
    const Cylinder c{random.place(), random.place(), 0.05 + random.unit()};
    const Vec3 axis = normalized(c.to - c.from);
    const double length = norm(c.to - c.from);
    for (const LevelTriple& level : levels) {
        const Mask::Ptr mask = cellsOf(Shape(c), l, level);
        const double coarse = norm(l.cellSize(level)) / 4;
        forEachCell(l, level, *mask, [&](const Box& cell, bool marked) {
            double best = 1e9; // how far the nearest sample lies outside
            forEachSample(cell, [&](const Vec3& p) {
                const double along = dot(p - c.from, axis), across = norm(p - c.from - axis * along);
                best = std::min(best, std::max({-along, along - length, across - c.radius}));
            });
            if (best < -1e-9) {
                EXPECT_TRUE(marked);
            }
            if (marked) {
                EXPECT_LE(best, coarse);
            }
        });
    }
}

// A slanted cylinder beside a cell's edge is told from its bounding boxes: a case whose answer is known.
TEST(FillCylinder, MissesWhatOnlyItsBoundsMeet) {
    const double s = std::sqrt(0.5);
    const Cylinder c{{0, 0, 0.5}, {4, 4, 0.5}, 0.3};
    EXPECT_EQ(coverOf(Shape(c), {{2 + 0.31 * s, 1 - 0.31 * s, 0}, {3, 1.4, 1}}), Cover::none);
    EXPECT_EQ(coverOf(Shape(c), {{4.1, 4.1, 0.4}, {5, 5, 0.6}}), Cover::none); // beyond the end, where it would be round
    EXPECT_EQ(coverOf(Shape(c), {{3.9, 3.9, 0.4}, {5, 5, 0.6}}), Cover::some);
    EXPECT_EQ(coverOf(Shape(c), {{1.9, 1.9, 0.45}, {2.1, 2.1, 0.55}}), Cover::all);
}

Surface randomSoup(Random& random, int triangles) {
    Surface s;
    s.parts = {{"a", "", 0}};
    for (int t = 0; t < triangles; ++t) {
        const Vec3 c = random.place();
        for (int k = 0; k < 3; ++k) s.points.push_back(c + Vec3{random.unit(), random.unit(), random.unit()});
        const auto n = static_cast<std::uint32_t>(3 * t);
        s.triangles.push_back({n, n + 1, n + 2});
        s.partOf.push_back(0);
    }
    return s;
}

// All of the band is fine, and what is marked beyond lies within half the diagonal of a cell or of the grain.
TEST_P(Fill, BandsReachAsFarAsAsked) {
    Random random(GetParam() + 200);
    const Lattice l = lattice(GetParam() % 2 == 0);
    const Surface soup = randomSoup(random, 4);
    const SurfaceIndex index(soup);
    const PartsBand band{std::make_shared<PartsIndex>(soup), 0.1 + 1.5 * random.unit()};
    for (const LevelTriple& level : levels) {
        const Mask::Ptr mask = cellsOf(Shape(band), l, level);
        const double slack = std::max(0.5 * norm(l.cellSize(level)), band.distance / 16);
        forEachCell(l, level, *mask, [&](const Box& cell, bool marked) {
            bool inside = false;
            forEachSample(cell, [&](const Vec3& p) { inside = inside || index.closest(p).distance <= band.distance; });
            if (inside) {
                EXPECT_TRUE(marked);
            }
            if (marked) {
                EXPECT_LE(index.closest(cell.centre()).distance, band.distance + 2 * slack);
            }
        });
    }
}

TEST_P(Fill, BoxesMarkTheCellsThatTheyShareVolumeWith) {
    Random random(GetParam() + 300);
    const Lattice l = lattice(GetParam() % 2 == 0);
    const Vec3 lo = random.place();
    const Box box{lo, lo + Vec3{2 * random.unit(), 2 * random.unit(), 2 * random.unit()}};
    for (const LevelTriple& level : levels) {
        const Mask::Ptr mask = cellsOf(box, l, level);
        EXPECT_FALSE(mask->hasActiveTiles());
        forEachCell(l, level, *mask, [&](const Box& cell, bool marked) {
            bool shares = true;
            for (int a = 0; a < 3; ++a) shares = shares && cell.lo[a] < box.hi[a] && cell.hi[a] > box.lo[a];
            EXPECT_EQ(marked, shares && box.overlaps(l.domain()));
        });
    }
}

INSTANTIATE_TEST_SUITE_P(Random, Fill, testing::Range(0u, 12u));

// A box that ends on planes between cells fills what it holds and nothing beside it.
TEST(FillBox, AlignedBoxesDoNotSpill) {
    EXPECT_EQ(countOf(*cellsOf(Box{{0, 0.5, 1}, {2, 2.5, 3}}, lattice(true), allAxes(2))), 8u * 8 * 8);
    EXPECT_EQ(countOf(*cellsOf(Box{{-9, -9, -9}, {9, 9, 9}}, lattice(true), allAxes(1))), 8u * 6 * 5 * 4);
    EXPECT_EQ(countOf(*cellsOf(Box{{7, 7, 7}, {9, 9, 9}}, lattice(true), allAxes(1))), 0u);
}

// Whole nodes and the border alike: the count comes near the volume, on any number of threads.
TEST(FillShape, SphereOfManyCellsIsTheSameOnAnyNumberOfThreads) {
    Lattice l = lattice(true);
    l.maxLevel = 6;
    const Shape sphere = Capsule{{2, 2, 2}, {2, 2, 2}, 1.7};
    std::vector<std::uint64_t> sums;
    for (const std::size_t threads : {1, 2, 3, 8}) {
        const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
        const Mask::Ptr mask = cellsOf(sphere, l, allAxes(6));
        Checksum sum;
        addTo(sum, *mask);
        sums.push_back(sum.value());
        EXPECT_NEAR(static_cast<double>(countOf(*mask)) / (volumeOf(sphere) * 262144), 1.03, 0.03);
    }
    for (const std::uint64_t s : sums) EXPECT_EQ(s, sums.front());
}

} // namespace
} // namespace i2b
