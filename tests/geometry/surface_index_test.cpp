// SurfaceIndex against brute force over soups that a tree in single precision would get wrong: needles,
// points, repeated and coplanar triangles, far from the origin.
#include "i2b/core/parallel.h"
#include "i2b/geometry/surface_index.h"
#include <gtest/gtest.h>
#include <random>

namespace i2b {
namespace {

struct Random {
    std::mt19937_64 engine;
    explicit Random(std::uint64_t seed) : engine(seed) {}
    double operator()(double lo, double hi) { return std::uniform_real_distribution<double>(lo, hi)(engine); }
    Vec3 vec(double r) { return {(*this)(-r, r), (*this)(-r, r), (*this)(-r, r)}; }
};

void addTriangle(Surface& s, const Vec3& a, const Vec3& b, const Vec3& c) {
    const auto n = static_cast<std::uint32_t>(s.points.size());
    s.points.insert(s.points.end(), {a, b, c});
    s.triangles.push_back({n, n + 1, n + 2});
    s.partOf.push_back(0);
}

// Triangles of all sizes with every tenth a needle, a segment, a point, a copy, or coplanar with a neighbour.
Surface dirtySoup(std::size_t n, const Vec3& at, std::uint64_t seed) {
    Random random(seed);
    Surface s;
    s.parts.push_back({"soup", "", n});
    while (s.triangles.size() < n) {
        const double size = std::pow(10.0, random(-3, 0));
        const Vec3 p = at + random.vec(1), u = random.vec(size), v = random.vec(size);
        switch (s.triangles.size() % 10) {
        case 0:
            addTriangle(s, p, p + u, p + u * 0.4 + v * 1e-9);
            break;
        case 1:
            addTriangle(s, p, p + u, p + u * 0.5);
            break;
        case 2:
            addTriangle(s, p, p, p);
            break;
        case 3: {
            const auto t = s.triangles.back();
            addTriangle(s, s.points[t[1]], s.points[t[2]], s.points[t[0]]);
            break;
        }
        case 4:
            addTriangle(s, p, p + Vec3{size, 0, 0}, p + Vec3{0, size, 0});
            addTriangle(s, p + Vec3{size, 0, 0}, p + Vec3{size, size, 0}, p + Vec3{0, size, 0});
            break;
        default:
            addTriangle(s, p, p + u, p + v);
        }
    }
    return s;
}

// A flat sheet of n x n squares with exact coordinates, two triangles each, sharing points.
Surface sheet(int n) {
    Surface s;
    s.parts.push_back({"sheet", "", 0});
    for (int j = 0; j <= n; ++j)
        for (int i = 0; i <= n; ++i) s.points.push_back({double(i), double(j), 0});
    for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) {
            const auto a = static_cast<std::uint32_t>(j * (n + 1) + i), b = a + 1,
                       c = a + static_cast<std::uint32_t>(n) + 1, d = c + 1;
            s.triangles.push_back({a, b, d});
            s.triangles.push_back({a, d, c});
            s.partOf.insert(s.partOf.end(), {0, 0});
        }
    return s;
}

ClosestPoint bruteClosest(const Surface& s, const Vec3& q) {
    ClosestPoint best;
    double best2 = std::numeric_limits<double>::infinity();
    for (std::uint32_t t = 0; t < s.triangles.size(); ++t) {
        const auto& v = s.triangles[t];
        const Vec3 p = closestPointOnTriangle(q, s.points[v[0]], s.points[v[1]], s.points[v[2]]);
        if (const double d2 = norm2(q - p); d2 < best2) best2 = d2, best = {p, std::sqrt(d2), t};
    }
    return best;
}

// One index a triangle: the same single-triangle test, but no tree to prune anything.
struct BruteHits {
    std::vector<std::unique_ptr<Surface>> surfaces;
    std::vector<SurfaceIndex> indices;
    explicit BruteHits(const Surface& s) {
        for (const auto& v : s.triangles) {
            surfaces.push_back(std::make_unique<Surface>());
            surfaces.back()->parts.push_back({"one", "", 1});
            addTriangle(*surfaces.back(), s.points[v[0]], s.points[v[1]], s.points[v[2]]);
            indices.emplace_back(*surfaces.back());
        }
    }
    SegmentHit operator()(const Vec3& a, const Vec3& b) const {
        SegmentHit best;
        for (std::uint32_t t = 0; t < indices.size(); ++t)
            if (const SegmentHit h = indices[t].firstHit(a, b); h && h.t < best.t) best = {h.t, t};
        return best;
    }
};

class Soups : public testing::TestWithParam<double> {};

// The tree loses no triangle to rounding, near the origin, far from it, and for queries near and far: the
// answer is the brute-force one to the bit, ties included.
TEST_P(Soups, closestEqualsBruteForce) {
    const Vec3 at = Vec3{1, -0.7, 0.3} * GetParam();
    const Surface s = dirtySoup(700, at, 1);
    const SurfaceIndex index(s);
    Random random(2);
    for (int i = 0; i < 3000; ++i) {
        Vec3 q = at + random.vec(i % 3 == 0 ? 0.1 : i % 3 == 1 ? 1.5 : 300);
        if (i % 7 == 0) q = s.points[static_cast<std::size_t>(i) % s.points.size()];
        const ClosestPoint expected = bruteClosest(s, q), found = index.closest(q);
        ASSERT_EQ(found.triangle, expected.triangle) << i;
        ASSERT_EQ(found.distance, expected.distance) << i;
        ASSERT_EQ(found.point, expected.point) << i;
        // A radius that just reaches finds the same, one that does not finds nothing.
        ASSERT_EQ(index.closest(q, found.distance).triangle, found.triangle);
        if (found.distance > 0) {
            ASSERT_FALSE(index.closest(q, found.distance * (1 - 1e-12)));
        }
    }
}

// A query over some of the triangles is one over an index of these alone: a third of them, one only, none.
TEST_P(Soups, subsetsEqualAnIndexOfTheirOwn) {
    const Vec3 at = Vec3{1, -0.7, 0.3} * GetParam();
    const Surface s = dirtySoup(700, at, 1);
    const SurfaceIndex index(s);
    const std::function<bool(std::uint32_t)> choices[] = {[](std::uint32_t t) { return t % 3 == 0; }, [](std::uint32_t t) { return t == 41; },
                                                          [](std::uint32_t) { return false; }};
    for (const auto& choice : choices) {
        Surface some = s;
        some.triangles.clear();
        std::vector<std::uint32_t> number;
        for (std::uint32_t t = 0; t < s.triangles.size(); ++t)
            if (choice(t)) some.triangles.push_back(s.triangles[t]), number.push_back(t);
        const SurfaceIndex own(some);
        const TriangleSubset subset = index.subset(choice);
        Random random(5);
        for (int i = 0; i < 1000; ++i) {
            const Vec3 q = at + random.vec(i % 2 == 0 ? 0.3 : 3);
            const ClosestPoint expected = own.closest(q), found = index.closeEnough(q, std::numeric_limits<double>::infinity(), -1, subset);
            ASSERT_EQ(bool(found), bool(expected)) << i;
            if (!found) continue;
            ASSERT_EQ(found.triangle, number[expected.triangle]) << i;
            ASSERT_EQ(found.distance, expected.distance) << i;
            const double enough = expected.distance * (i % 5 == 0 ? 0.5 : 1.5), radius = 2 * expected.distance;
            const ClosestPoint any = index.closeEnough(q, radius, enough, subset);
            ASSERT_TRUE(any && choice(any.triangle)) << i;
            ASSERT_LE(any.distance, std::max(enough, expected.distance)) << i;
        }
    }
}

// The first hit of the tree is the first hit of all triangles one by one, also along triangles' own edges.
TEST_P(Soups, firstHitEqualsBruteForce) {
    const Vec3 at = Vec3{1, -0.7, 0.3} * GetParam();
    const Surface s = dirtySoup(150, at, 3);
    const SurfaceIndex index(s);
    const BruteHits brute(s);
    Random random(4);
    int hits = 0;
    for (int i = 0; i < 1500; ++i) {
        Vec3 a = at + random.vec(1.2), b = at + random.vec(1.2);
        if (i % 5 == 0) b = s.points[static_cast<std::size_t>(i) % s.points.size()];
        if (i % 5 == 1) b = {b.x, a.y, a.z};
        if (i % 5 == 2) a = a + (a - b) * 50;
        const SegmentHit expected = brute(a, b), found = index.firstHit(a, b);
        ASSERT_EQ(found.triangle, expected.triangle) << i;
        ASSERT_EQ(found.t, expected.t) << i;
        hits += bool(found);
    }
    EXPECT_GT(hits, 300);
}

// Every query that touches a corner, an edge or the inside of a triangle by construction says so.
TEST_P(Soups, touchingIsNeverMissed) {
    const Vec3 at = Vec3{1, -0.7, 0.3} * GetParam();
    const Surface s = dirtySoup(500, at, 5);
    const SurfaceIndex index(s);
    for (std::uint32_t t = 0; t < s.triangles.size(); ++t)
        for (const std::uint32_t v : s.triangles[t]) {
            const Vec3 p = s.points[v];
            EXPECT_EQ(index.closest(p).distance, 0);
            EXPECT_TRUE(index.overlaps({p, p + Vec3{1e-3, 1e-3, 1e-3}}));
            EXPECT_TRUE(index.overlaps({p, p}));
            EXPECT_TRUE(index.firstHit(p + Vec3{0.3, 0.2, -0.1}, p));
            EXPECT_LT(index.firstHit(p, p + Vec3{0.3, 0.2, -0.1}).t, 1e-9);
            EXPECT_TRUE(index.firstHit(p, p));
        }
}

INSTANTIATE_TEST_SUITE_P(Offsets, Soups, testing::Values(0.0, 10.0, 1e6));

// candidates() are exactly the triangles whose bounds meet the box, overlaps() needs more than that.
TEST(SurfaceIndex, boxes) {
    const Surface s = dirtySoup(600, {5, 5, 5}, 6);
    const SurfaceIndex index(s);
    Random random(7);
    for (int i = 0; i < 300; ++i) {
        const Vec3 c = Vec3{5, 5, 5} + random.vec(1), h = random.vec(0.1);
        const Box box{c - cwiseMax(h, -h), c + cwiseMax(h, -h)};
        std::vector<std::uint32_t> expected;
        for (std::uint32_t t = 0; t < s.triangles.size(); ++t) {
            Box b;
            for (const std::uint32_t v : s.triangles[t]) b.add(s.points[v]);
            if (b.overlaps(box)) expected.push_back(t);
        }
        EXPECT_EQ(index.candidates(box), expected);
        if (expected.empty()) {
            EXPECT_FALSE(index.overlaps(box));
        }
    }
    Surface one;
    addTriangle(one, {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    const SurfaceIndex small(one);
    EXPECT_TRUE(small.overlaps({{0.5, 0.5, -1}, {1, 1, 1}}));    // touches the long edge at its middle
    EXPECT_FALSE(small.overlaps({{0.51, 0.51, -1}, {1, 1, 1}})); // in the bounds, beside the edge
    EXPECT_EQ(small.candidates({{0.51, 0.51, -1}, {1, 1, 1}}).size(), 1u);
}

// Rays through the shared edges and corners of a sheet, from everywhere: there are no cracks.
TEST(SurfaceIndex, noCracks) {
    Surface s = sheet(8);
    Random random(8);
    // Tilted and stretched, so that no coordinate of the shared edges is exact.
    for (Vec3& p : s.points)
        p = {p.x * 0.1 + p.y * 0.037 + 1e3, p.y * 0.1 - p.x * 0.011, p.x * 0.07 + p.y * 0.013};
    const SurfaceIndex index(s);
    const auto onBorder = [](std::uint32_t v) { return v % 9 == 0 || v % 9 == 8 || v < 9 || v >= 72; };
    for (const auto& t : s.triangles)
        for (std::size_t i = 0; i < 3; ++i) {
            const std::uint32_t v = t[i], w = t[(i + 1) % 3];
            if (onBorder(v) && onBorder(w)) continue; // rounding may put the ray beside the sheet
            const Vec3 p = s.points[v], q = s.points[w];
            for (int k = 0; k <= 200; ++k) {
                const Vec3 x = p + (q - p) * random(0.01, 0.99), d = random.vec(1);
                const SegmentHit h = index.firstHit(x + d, x - d);
                ASSERT_TRUE(h);
                EXPECT_NEAR(h.t, 0.5, 1e-5); // grazing ones magnify the rounding of x
            }
        }
}

// Of triangles equally near or equally far along, the lowest number answers; the order of the tree plays no
// part.
TEST(SurfaceIndex, tiesGoToTheLowestNumber) {
    Surface s;
    for (int i = 0; i < 50; ++i) addTriangle(s, {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    const SurfaceIndex index(s);
    EXPECT_EQ(index.closest({0.2, 0.2, 1}).triangle, 0u);
    EXPECT_EQ(index.firstHit({0.2, 0.2, 1}, {0.2, 0.2, -1}).triangle, 0u);
    EXPECT_EQ(index.closest({0.2, 0.2, 1}, 5, [](std::uint32_t t) { return t >= 17; }).triangle, 17u);
    const Surface flat = sheet(4);
    const SurfaceIndex corner(flat);
    const SegmentHit h = corner.firstHit({2, 2, 1}, {2, 2, -1}); // six triangles meet there
    EXPECT_EQ(h.t, 0.5);
    std::uint32_t lowest = ~0u;
    for (std::uint32_t t = 0; t < flat.triangles.size(); ++t)
        for (const std::uint32_t v : flat.triangles[t])
            if (flat.points[v] == Vec3{2, 2, 0}) lowest = std::min(lowest, t);
    EXPECT_EQ(h.triangle, lowest);
    EXPECT_EQ(corner.closest({2, 2, 1}).triangle, lowest);
}

// A segment in the plane of the sheet meets it where it enters, and not at all if it passes beside.
TEST(SurfaceIndex, segmentsInThePlane) {
    const Surface s = sheet(4);
    const SurfaceIndex index(s);
    EXPECT_DOUBLE_EQ(index.firstHit({-4, 1.5, 0}, {4, 1.5, 0}).t, 0.5);
    EXPECT_EQ(index.firstHit({1.2, 1.5, 0}, {9, 1.5, 0}).t, 0);
    EXPECT_FALSE(index.firstHit({-4, 1.5, 0}, {-1, 1.5, 0}));
    EXPECT_FALSE(index.firstHit({-4, 4.1, 0}, {4, 4.1, 0}));
    EXPECT_TRUE(index.firstHit({-4, 4, 0}, {4, 4, 0})); // along the border: closed
    EXPECT_FALSE(index.firstHit({2, 2, 1}, {2, 2, 1e-6}));
    EXPECT_EQ(index.firstHit({2, 2, 1}, {2, 2, 0}).t, 1);
}

// A needle's closest point is right to the needle's own size, where plain barycentrics would be cancellation.
TEST(SurfaceIndex, needles) {
    Random random(9);
    for (int i = 0; i < 20000; ++i) {
        const Vec3 a = random.vec(1), u = random.vec(1);
        const double width = std::pow(10.0, random(-18, -2));
        const Vec3 b = a + u, c = a + u * random(-0.5, 1.5) + random.vec(width);
        const Vec3 q = a + random.vec(std::pow(10.0, random(-2, 3)));
        const Vec3 p = closestPointOnTriangle(q, a, b, c);
        // Against a fine sampling of the three edges: the true distance is within the width of theirs.
        double nearest = std::numeric_limits<double>::infinity();
        for (int k = 0; k <= 400; ++k) {
            const double t = k / 400.0;
            for (const Vec3& x : {a + (b - a) * t, b + (c - b) * t, c + (a - c) * t})
                nearest = std::min(nearest, norm(q - x));
        }
        ASSERT_LE(norm(q - p), nearest + 1e-12 * (1 + norm(q))) << i;
        ASSERT_GE(norm(q - p), nearest - 2.0 / 400 - width * 2) << i;
    }
}

// Nothing to find is an answer too.
// Strips of an extruded profile, as CAD programs write them: triangles a thousand times as long as wide. Their plane is known to less than
// their corners are, which must let no segment through.
TEST(SurfaceIndex, stripsLetNoSegmentThrough) {
    Random random(5);
    for (const double width : {1e-2, 1e-3, 1e-5, 1e-7}) {
        for (int pose = 0; pose < 20; ++pose) {
            const Vec3 along = normalized(random.vec(1)), across = normalized(cross(along, random.vec(1)));
            const Vec3 a = random.vec(1), b = a + across * width, c = b + along, d = a + along;
            Surface s;
            s.parts.push_back({"strip", "", 2});
            addTriangle(s, a, b, c), addTriangle(s, a, c, d);
            const SurfaceIndex index(s);
            int through = 0, beside = 0;
            for (int i = 0; i < 200; ++i) {
                const Vec3 p = a + along * random(0.001, 0.999) + across * (width * random(0.001, 0.999)), way = random.vec(0.02);
                through += !index.firstHit(p - way, p + way);
                const Vec3 off = across * (1.01 * width);
                beside += bool(index.firstHit(p + off - cross(along, across) * 0.01, p + off + cross(along, across) * 0.01));
            }
            EXPECT_EQ(through, 0) << width;
            EXPECT_EQ(beside, 0) << width;
        }
    }
}

TEST(SurfaceIndex, empty) {
    const Surface s;
    const SurfaceIndex index(s);
    EXPECT_FALSE(index.closest({1, 2, 3}));
    EXPECT_FALSE(index.firstHit({0, 0, 0}, {1, 1, 1}));
    EXPECT_FALSE(index.overlaps({{-1, -1, -1}, {1, 1, 1}}));
    EXPECT_TRUE(index.candidates({{-1, -1, -1}, {1, 1, 1}}).empty());
}

// Queries are const: many threads at once get what one gets.
TEST(SurfaceIndex, threads) {
    const Surface s = dirtySoup(3000, {0, 0, 0}, 10);
    const SurfaceIndex index(s);
    std::vector<Vec3> q(5000);
    Random random(11);
    for (Vec3& p : q) p = random.vec(1.5);
    std::vector<std::uint32_t> serial(q.size()), parallel(q.size());
    const auto ask = [&](std::size_t i) {
        return index.closest(q[i]).triangle ^ index.firstHit(q[i], -q[i]).triangle;
    };
    for (std::size_t i = 0; i < q.size(); ++i) serial[i] = ask(i);
    parallelFor(
        q.size(), [&](std::size_t i) { parallel[i] = ask(i); }, 16);
    EXPECT_EQ(serial, parallel);
}

} // namespace
} // namespace i2b
