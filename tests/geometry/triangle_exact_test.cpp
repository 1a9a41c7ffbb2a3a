// Proves that no cut is ever missed: triangles and boxes that truly meet, be it in one point, are said to meet, and
// those said to meet without meeting are apart by rounding alone. The truth is found in exact integers. Triangles are
// random, needles, slivers, segments and points, flat on a face of the box, or with a corner of the box exactly inside,
// on an edge or on a vertex, a last bit beside it, near the origin and a million cells away. $I2B_TEST_EFFORT=100 runs
// hundreds of millions of pairs.
#include "exact_box.h"
#include "i2b/geometry/triangle_cells.h"
#include <boost/multiprecision/cpp_int.hpp>
#include <gtest/gtest.h>
#include <random>

namespace i2b {
namespace {

using exact::Gap;
using exact::Int128;
using Grid = exact::Point<Int128>; // in units of 2^-shift cells, about the place

// One source of triangles: what they are drawn on, and where.
struct Place {
    int shift;       // the finest bit of coordinates, below a cell
    double offset;   // cells from the origin; a multiple of the unit
    int reach;       // cells around the place
};

class Exact : public testing::TestWithParam<Place> {
  protected:
    double unit() const { return std::ldexp(1.0, -GetParam().shift); }
    Vec3 place(const Grid& g) const {
        const double o = GetParam().offset;
        return {o + unit() * static_cast<double>(g[0]), -o + unit() * static_cast<double>(g[1]), o + unit() * static_cast<double>(g[2])};
    }
    std::array<Vec3, 3> places(const std::array<Grid, 3>& t) const { return {place(t[0]), place(t[1]), place(t[2])}; }
    long long random(long long from, long long to) { return std::uniform_int_distribution<long long>(from, to)(engine_); }
    Grid randomGrid(long long reach) { return {Int128(random(-reach, reach)), Int128(random(-reach, reach)), Int128(random(-reach, reach))}; }

    // A triangle that has the point p inside, on an edge or on a vertex; all exactly.
    std::array<Grid, 3> through(const Grid& p, long long step) {
        const Grid d = randomGrid(step), e = randomGrid(step);
        const long long n = random(1, 4), i = random(0, n), j = random(0, n - i);
        std::array<Grid, 3> t;
        for (std::size_t k = 0; k < 3; ++k) {
            t[0][k] = p[k] - i * d[k] - j * e[k];
            t[1][k] = t[0][k] + n * d[k];
            t[2][k] = t[0][k] + n * e[k];
        }
        return t;
    }
    std::array<Grid, 3> triangle(const Grid& lo, const Grid& hi) {
        const long long cell = 1ll << GetParam().shift, reach = GetParam().reach * cell;
        Grid corner;
        for (std::size_t k = 0; k < 3; ++k) corner[k] = random(0, 1) ? lo[k] : hi[k];
        std::array<Grid, 3> t{randomGrid(reach), randomGrid(reach), randomGrid(reach)};
        const std::size_t axis = static_cast<std::size_t>(random(0, 2));
        switch (random(0, 11)) {
        case 0: t[2] = t[random(0, 1)]; break;                                                          // a segment
        case 1: t[1] = t[2] = t[0]; break;                                                              // a point
        case 2: for (Grid& v : t) v[axis] = random(0, 1) ? corner[axis] : v[axis]; break;               // touches or lies in a face's plane
        case 3: for (Grid& v : t) v[axis] = corner[axis]; break;                                        // flat on a face
        case 4: t[1][axis] = t[0][axis]; t[2] = t[0]; t[2][axis] += random(-2, 2); break;               // a needle of some bits
        case 5: for (std::size_t k = 0; k < 3; ++k) t[2][k] = (t[0][k] + t[1][k]) / 2 + random(-1, 1); break; // a sliver
        case 6: t = through(corner, reach / 8 + 1); break;
        case 7: t = through(corner, reach / 8 + 1); for (Grid& v : t) v[axis] += random(-1, 1); break;  // a bit beside it
        case 8: t = through(corner, 3 * cell); t[random(0, 2)][axis] += random(-1, 1); break;
        case 9: t[0] = corner; t[0][axis] += random(-1, 1); break;
        case 10: for (Grid& v : t) for (std::size_t k = 0; k < 3; ++k) v[k] = v[k] / cell * cell; break; // on the lattice
        default: break;
        }
        return t;
    }

    std::mt19937_64 engine_{7};
};

// Any box against any triangle, by meets() and by the row that the box stands in.
TEST_P(Exact, NoPairThatMeetsIsMissed) {
    const long long cell = 1ll << GetParam().shift, reach = GetParam().reach * cell;
    int met = 0, wrong = 0;
    const int n = exact::rounds(250000);
    for (int i = 0; i < n; ++i) {
        Grid lo = randomGrid(reach / 2), hi = lo;
        for (std::size_t k = 0; k < 3; ++k) {
            if (i % 2) lo[k] = lo[k] / cell * cell;
            hi[k] = lo[k] + (i % 2 ? cell : random(0, cell));
        }
        const std::array<Grid, 3> t = triangle(lo, hi);
        const std::array<Vec3, 3> v = places(t);
        const Vec3 boxLo = place(lo), boxHi = place(hi);
        const TriangleBoxTest test(v[0], v[1], v[2]);
        const Gap gap = exact::gapOf(t, lo, hi);
        const bool found = test.meets(boxLo, boxHi);
        double first = 0, last = 0;
        const bool inRow = test.row(boxLo.y, boxHi.y, boxLo.z, boxHi.z, first, last) && boxHi.x >= first && boxLo.x <= last;
        if (gap.meets()) {
            ++met;
            ASSERT_TRUE(found) << i;
            ASSERT_TRUE(inRow) << i;
            continue;
        }
        Gap inCells = gap;
        inCells.axes *= unit(), inCells.lines *= unit(), inCells.plane *= unit();
        wrong += found;
        if (found) { ASSERT_TRUE(exact::withinRounding(inCells, v, false)) << i << " " << inCells.axes << " " << inCells.lines << " " << inCells.plane; }
        if (inRow) { ASSERT_TRUE(exact::withinRounding(inCells, v, true)) << i << " " << inCells.axes << " " << inCells.lines << " " << inCells.plane; }
    }
    EXPECT_GT(met, n / 10);
    EXPECT_LE(wrong, n / 10000 + 10);
    RecordProperty("hits_by_rounding", wrong);
}

// All cells around a triangle at once, as the cutter asks for them.
TEST_P(Exact, NoCellThatMeetsIsMissed) {
    const long long cell = 1ll << GetParam().shift;
    const Int128 o = static_cast<Int128>(GetParam().offset);
    int met = 0, wrong = 0, all = 0;
    const int n = exact::rounds(1500);
    for (int i = 0; i < n; ++i) {
        const Grid lo{Int128(0), Int128(0), Int128(0)}, hi{Int128(cell), Int128(cell), Int128(cell)};
        const std::array<Grid, 3> t = triangle(lo, hi);
        const std::array<Vec3, 3> v = places(t);
        const TriangleBoxTest test(v[0], v[1], v[2]);
        std::array<std::int32_t, 3> from{}, to{};
        for (int k = 0; k < 3; ++k) {
            from[std::size_t(k)] = floorToInt(test.bounds().lo[k]) - 2;
            to[std::size_t(k)] = floorToInt(test.bounds().hi[k]) + 2;
        }
        std::vector<std::array<std::int32_t, 3>> cells;
        TriangleCells(test).visit(from, to, [&](const std::array<std::int32_t, 3>& at, const std::array<std::uint64_t, 8>& words) {
            for (int x = 0; x < 8; ++x)
                for (int b = 0; b < 64; ++b)
                    if (words[std::size_t(x)] >> b & 1) cells.push_back({at[0] + x, at[1] + b / 8, at[2] + b % 8});
        });
        std::sort(cells.begin(), cells.end());
        ASSERT_TRUE(std::adjacent_find(cells.begin(), cells.end()) == cells.end()) << i;
        std::array<std::int32_t, 3> c{};
        for (c[0] = from[0]; c[0] <= to[0]; ++c[0])
            for (c[1] = from[1]; c[1] <= to[1]; ++c[1])
                for (c[2] = from[2]; c[2] <= to[2]; ++c[2], ++all) {
                    const Grid low{(c[0] - o) * cell, (c[1] + o) * cell, (c[2] - o) * cell};
                    const Grid high{low[0] + cell, low[1] + cell, low[2] + cell};
                    Gap gap = exact::gapOf(t, low, high);
                    const bool found = std::binary_search(cells.begin(), cells.end(), c);
                    if (gap.meets()) {
                        ++met;
                        ASSERT_TRUE(found) << i << ": " << c[0] << " " << c[1] << " " << c[2];
                    } else if (found) {
                        ++wrong;
                        gap.axes *= unit(), gap.lines *= unit(), gap.plane *= unit();
                        ASSERT_TRUE(exact::withinRounding(gap, v, true)) << i << " " << gap.axes << " " << gap.lines << " " << gap.plane;
                    }
                }
    }
    EXPECT_GT(met, 10 * n);
    EXPECT_LE(wrong, all / 1000 + 10);
    RecordProperty("hits_by_rounding", wrong);
    RecordProperty("pairs", all);
}

INSTANTIATE_TEST_SUITE_P(Places, Exact,
                         testing::Values(Place{20, 0, 6}, Place{2, 0, 6}, Place{32, 1 << 20, 4}, Place{10, 1000000, 6}, Place{30, 1 << 10, 2}));

// Full doubles of very different sizes, where even differences of coordinates are rounded.
TEST(ExactDoubles, NoPairThatMeetsIsMissed) {
    using Wide = boost::multiprecision::int512_t;
    std::mt19937_64 engine(11);
    std::uniform_real_distribution<double> u(-1, 1);
    const auto wide = [](double x) {
        int e = 0;
        const double m = std::frexp(x, &e);
        return e < -67 ? Wide(0) : Wide(static_cast<long long>(std::ldexp(m, 53))) << (e - 53 + 120);
    };
    const auto point = [&](const Vec3& p) { return exact::Point<Wide>{wide(p.x), wide(p.y), wide(p.z)}; };
    int met = 0;
    for (int i = 0; i < exact::rounds(40000); ++i) {
        const auto value = [&] { return u(engine) * std::pow(10.0, -6 * std::abs(u(engine))); };
        std::array<Vec3, 3> t;
        for (Vec3& v : t) v = {value(), value(), value()};
        if (i % 3 == 0) t[2] = t[0] + (t[1] - t[0]) * std::abs(u(engine)) + Vec3{value(), value(), value()} * 1e-12; // a needle
        // A box that has a point of the triangle, as nearly as doubles allow, for a corner.
        const double a = std::abs(u(engine)), b = (1 - a) * std::abs(u(engine));
        const Vec3 p = i % 5 ? t[0] + (t[1] - t[0]) * a + (t[2] - t[0]) * b : t[0], q = p + Vec3{value(), value(), value()} * 0.3;
        Box box;
        box.add(p);
        box.add(q);
        Gap gap = exact::gapOf<Wide>({point(t[0]), point(t[1]), point(t[2])}, point(box.lo), point(box.hi));
        const TriangleBoxTest test(t[0], t[1], t[2]);
        const bool found = test.meets(box.lo, box.hi);
        double first = 0, last = 0;
        const bool inRow = test.row(box.lo.y, box.hi.y, box.lo.z, box.hi.z, first, last) && box.hi.x >= first && box.lo.x <= last;
        if (gap.meets()) {
            ++met;
            ASSERT_TRUE(found) << i;
            ASSERT_TRUE(inRow) << i;
        } else if (found) {
            const double scale = std::ldexp(1.0, -120);
            gap.axes *= scale, gap.lines *= scale, gap.plane *= scale;
            ASSERT_TRUE(exact::withinRounding(gap, t, true)) << i << " " << gap.axes << " " << gap.lines << " " << gap.plane;
        }
    }
    EXPECT_GT(met, 1000);
}

} // namespace
} // namespace i2b
