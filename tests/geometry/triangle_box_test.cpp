// The triangle/box test against exact integer arithmetic: small integer coordinates, scaled and moved by
// powers of two so that the doubles stay exact, make touching, coplanar and degenerate cases common rather
// than rare.
#include "i2b/geometry/triangle_box.h"
#include <gtest/gtest.h>
#include <random>

namespace i2b {
namespace {

using Int3 = std::array<long long, 3>;

Int3 sub(const Int3& a, const Int3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Int3 crossOf(const Int3& a, const Int3& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
long long dotOf(const Int3& a, const Int3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

// Separated along n: exact. gap gets the distance between the two, if larger than before.
bool separated(const Int3& n, const std::array<Int3, 3>& t, const Int3& lo, const Int3& hi, double& gap) {
    if (n == Int3{0, 0, 0}) return false;
    long long triLo = std::numeric_limits<long long>::max(), triHi = std::numeric_limits<long long>::min();
    for (const Int3& v : t) triLo = std::min(triLo, dotOf(n, v)), triHi = std::max(triHi, dotOf(n, v));
    long long boxLo = 0, boxHi = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        boxLo += n[k] * (n[k] > 0 ? lo[k] : hi[k]);
        boxHi += n[k] * (n[k] > 0 ? hi[k] : lo[k]);
    }
    const long long between = std::max(triLo - boxHi, boxLo - triHi);
    gap = std::max(gap, static_cast<double>(between) / std::sqrt(static_cast<double>(dotOf(n, n))));
    return between > 0;
}

// Exact separating-axis test; gap: lower bound of the distance where they are apart.
bool exactMeets(const std::array<Int3, 3>& t, const Int3& lo, const Int3& hi, double& gap) {
    const std::array<Int3, 3> e{sub(t[1], t[0]), sub(t[2], t[1]), sub(t[0], t[2])};
    const std::array<Int3, 3> axes{Int3{1, 0, 0}, Int3{0, 1, 0}, Int3{0, 0, 1}};
    bool apart = false;
    gap = 0;
    for (const Int3& a : axes) apart |= separated(a, t, lo, hi, gap);
    apart |= separated(crossOf(e[0], e[1]), t, lo, hi, gap);
    for (const Int3& a : axes)
        for (const Int3& b : e) apart |= separated(crossOf(a, b), t, lo, hi, gap);
    return !apart;
}

struct Case {
    std::array<Int3, 3> t;
    Int3 lo, hi;
};

Case randomCase(std::mt19937_64& engine, long long reach, long long boxSize) {
    std::uniform_int_distribution<long long> at(-reach, reach), edge(0, boxSize);
    Case c;
    for (Int3& v : c.t)
        for (long long& x : v) x = at(engine);
    switch (engine() % 8) {
    case 0:
        c.t[2] = c.t[0];
        break; // a segment
    case 1:
        c.t[1] = c.t[2] = c.t[0];
        break; // a point
    case 2:
        c.t[2] = {(c.t[0][0] + c.t[1][0]) / 2, (c.t[0][1] + c.t[1][1]) / 2, (c.t[0][2] + c.t[1][2]) / 2};
        break;
    case 3:
        c.t[0][2] = c.t[1][2] = c.t[2][2];
        break; // parallel to a face
    case 4:
        c.t[0][0] = c.t[1][0];
        break; // an edge parallel to a face
    default:
        break;
    }
    for (std::size_t k = 0; k < 3; ++k) {
        c.lo[k] = at(engine);
        c.hi[k] = c.lo[k] + edge(engine);
    }
    if (engine() % 4 == 0) // touching: a vertex on the low plane
        c.lo[0] = c.t[0][0], c.hi[0] = c.lo[0] + edge(engine);
    return c;
}

struct Scale {
    double unit, offset;
    long long reach;
};

class TriangleBox : public testing::TestWithParam<Scale> {
  protected:
    Vec3 place(const Int3& v) const {
        const Scale& s = GetParam();
        return {s.offset + s.unit * double(v[0]), s.offset - s.unit * double(v[1]), s.unit * double(v[2])};
    }
    Box box(const Case& c) const {
        Box b;
        b.add(place(c.lo));
        b.add(place(c.hi));
        return b;
    }
};

// Never a miss where they truly meet; a hit where they do not only within 1e-9 of the coordinates.
TEST_P(TriangleBox, neverMissesAndHardlyEverHitsWrongly) {
    std::mt19937_64 engine(1);
    int touching = 0, apart = 0, wrong = 0;
    for (int i = 0; i < 300000; ++i) {
        const Case c = randomCase(engine, GetParam().reach, GetParam().reach / 2 + 1);
        double gap = 0;
        const bool expected = exactMeets(c.t, c.lo, c.hi, gap);
        const bool found = triangleMeetsBox(place(c.t[0]), place(c.t[1]), place(c.t[2]), box(c));
        if (expected) {
            ASSERT_TRUE(found) << i;
        } else if (found) {
            ASSERT_LT(gap, 1e-9 * double(GetParam().reach)) << i;
            ++wrong;
        }
        touching += expected && gap == 0;
        apart += !expected;
    }
    EXPECT_GT(touching, 10000);
    EXPECT_GT(apart, 10000);
    EXPECT_LE(wrong, 300);
}

// row() says of each box of a row what meets() says of it.
TEST_P(TriangleBox, rowsAgreeWithBoxes) {
    std::mt19937_64 engine(2);
    int met = 0;
    for (int i = 0; i < 20000; ++i) {
        Case c = randomCase(engine, GetParam().reach, GetParam().reach / 4 + 1);
        const TriangleBoxTest test(place(c.t[0]), place(c.t[1]), place(c.t[2]));
        const Box any = box(c);
        double first = 0, last = 0;
        const bool some = test.row(any.lo.y, any.hi.y, any.lo.z, any.hi.z, first, last);
        const long long step = GetParam().reach / 8 + 1;
        for (long long x = -2 * GetParam().reach; x < 2 * GetParam().reach; x += step) {
            c.lo[0] = x;
            c.hi[0] = x + step;
            const Box b = box(c);
            double gap = 0;
            const bool byRow = some && b.hi.x >= first && b.lo.x <= last;
            const bool exact = exactMeets(c.t, c.lo, c.hi, gap);
            if (exact) {
                ASSERT_TRUE(byRow) << i << " " << x;
            } else if (byRow) {
                ASSERT_LT(gap, 1e-9 * double(GetParam().reach) + 1e-14 * GetParam().offset / GetParam().unit)
                    << i;
            }
            met += exact;
        }
    }
    EXPECT_GT(met, 1000);
}

INSTANTIATE_TEST_SUITE_P(Scales, TriangleBox,
                         testing::Values(Scale{1, 0, 8}, Scale{1, 0, 10000}, Scale{0.25, 1 << 20, 50},
                                         Scale{1.0 / (1 << 20), 1 << 10, 1000},
                                         Scale{1.0 / 1024, 1 << 30, 8}));

// Random doubles against long double interval-free sampling: a point of the triangle inside the box proves a
// hit.
TEST(TriangleBoxRandom, aVertexAtACornerTouches) {
    std::mt19937_64 engine(3);
    std::uniform_real_distribution<double> u(-1, 1);
    for (int i = 0; i < 200000; ++i) {
        const double width = std::pow(10.0, 8 * u(engine) - 8), far = i % 2 ? 0 : 1e7;
        const Vec3 a{far + u(engine), u(engine), u(engine)};
        const Vec3 b = a + Vec3{u(engine), u(engine), u(engine)};
        const Vec3 c = a + (b - a) * u(engine) + Vec3{u(engine), u(engine), u(engine)} * width;
        const Vec3* v[3] = {&a, &b, &c};
        const Vec3& on = *v[engine() % 3]; // a vertex is the only point of the triangle that is exact
        const Vec3 size{std::abs(u(engine)), std::abs(u(engine)) * 1e-3, std::abs(u(engine)) * 1e-6};
        for (unsigned side = 0; side < 8; ++side) {
            const Vec3 other{on.x + (side & 1 ? -size.x : size.x), on.y + (side & 2 ? -size.y : size.y),
                             on.z + (side & 4 ? -size.z : size.z)};
            Box box;
            box.add(on);
            box.add(other);
            ASSERT_TRUE(triangleMeetsBox(a, b, c, box)) << i << " " << side;
            ASSERT_TRUE(triangleMeetsBox(c, a, b, box));
        }
    }
}

// A box much larger than the triangle, or the triangle much larger than the box, costs no accuracy.
TEST(TriangleBoxRandom, sizesApart) {
    EXPECT_TRUE(
        triangleMeetsBox({1e-9, 0, 0}, {2e-9, 0, 0}, {1e-9, 1e-9, 0}, {{-1e9, -1e9, 0}, {1e-9, 1e9, 1e9}}));
    EXPECT_FALSE(triangleMeetsBox({1e-9, 0, 0}, {2e-9, 0, 0}, {1e-9, 1e-9, 0},
                                  {{-1e9, -1e9, 0}, {0.999e-9, 1e9, 1e9}}));
    // A plane x + y + z = 0 over 2e6, cells of 1 at the origin.
    const Vec3 a{-1e6, 1e6, 0}, b{1e6, -1e6, 0}, c{0, -1e6, 1e6};
    EXPECT_TRUE(triangleMeetsBox(a, b, c, {{0, 0, 0}, {1, 1, 1}}));
    EXPECT_FALSE(triangleMeetsBox(a, b, c, {{1e-6, 1e-6, 1e-6}, {1, 1, 1}}));
}

} // namespace
} // namespace i2b
