// The feature graph of shapes whose edges and corners can be counted by hand, made dirty in the ways that
// input is.
#include "geometry_files.h"
#include "i2b/geometry/features.h"
#include "soups.h"
#include <filesystem>
#include <gtest/gtest.h>
#include <numbers>
#include <random>
#include <tbb/global_control.h>

namespace i2b {
namespace {

using test::addCube;
using test::addQuad;
using test::addTriangle;
using test::count;

constexpr auto sharp = EdgeKind::sharp, open = EdgeKind::free, nonManifold = EdgeKind::nonManifold,
               border = EdgeKind::partBorder;

FeatureGraph graphOf(const Surface& s, double angle = 40, double tolerance = 0) {
    const FeatureGraph g = buildFeatureGraph(s, {angle, tolerance});
    EXPECT_EQ(g.validate(), "");
    return g;
}

void expectCube(const FeatureGraph& g) {
    EXPECT_EQ(g.edges.size(), 12u); // no diagonal of a face
    EXPECT_EQ(g.corners.size(), 8u);
    EXPECT_EQ(g.points.size(), 8u);
    EXPECT_EQ(g.weldedPoints, 8u);
    EXPECT_EQ(g.sharpEdges, 12u);
    EXPECT_NEAR(g.sharpEdgeLength, 12, 1e-9);
    EXPECT_EQ(g.openEdges, 0u);
    for (const FeatureEdge& e : g.edges) {
        EXPECT_EQ(e.kinds, bitOf(sharp));
        EXPECT_NEAR(e.angle, 90, 1e-4);
    }
}

// A cube of unwelded triangles has 12 edges of 90 degrees and 8 corners.
TEST(Features, cube) {
    Surface s;
    addCube(s, {3, 4, 5});
    expectCube(graphOf(s));
    EXPECT_EQ(graphOf(s, 89).edges.size(), 12u);
    EXPECT_EQ(graphOf(s, 91).edges.size(), 0u);
    EXPECT_EQ(graphOf(s, 180).edges.size(), 0u);
    EXPECT_EQ(graphOf(s, 180).corners.size(), 0u);
}

// Orientation means nothing, copies count once, and points a little apart are one.
TEST(Features, dirtyCube) {
    Surface s;
    addCube(s, {0, 0, 0});
    for (std::size_t t = 0; t < s.triangles.size(); t += 3) std::swap(s.triangles[t][0], s.triangles[t][1]);
    expectCube(graphOf(s));
    addCube(s, {0, 0, 0});
    addTriangle(s, {0, 0, 0}, {1, 0, 0}, {1, 0, 0});
    FeatureGraph g = graphOf(s);
    expectCube(g);
    EXPECT_EQ(g.duplicateTriangles, 12u);
    EXPECT_EQ(g.degenerateTriangles, 1u);
    std::mt19937_64 engine(1);
    std::uniform_real_distribution<double> u(-1e-5, 1e-5);
    for (Vec3& p : s.points) p += {u(engine), u(engine), u(engine)};
    g = graphOf(s, 40, 1e-4);
    EXPECT_EQ(g.sharpEdges, 12u);
    EXPECT_EQ(g.corners.size(), 8u);
    EXPECT_EQ(g.openEdges, 0u);
}

// Points within the tolerance weld wherever the cells of the hash grid happen to end.
TEST(Features, weldAcrossGridCells) {
    for (int i = 0; i < 40; ++i) {
        Surface s;
        const double x = i * 1.7e-4, gap = 0.9e-3;
        addTriangle(s, {x, 0, 0}, {x, 1, 0}, {-1, 0, 0});
        addTriangle(s, {x + gap, 0, 0}, {x + gap, 1, 0}, {1, 0, 0});
        addTriangle(s, {-2, -2, -2}, {-2, -2, -1}, {-2, -1, -2});
        const FeatureGraph g = graphOf(s, 40, 1e-3);
        EXPECT_EQ(g.weldedPoints, 7u) << i;
        EXPECT_EQ(g.openEdges, 7u) << i;
        EXPECT_EQ(graphOf(s, 40, 0.8e-3).weldedPoints, 9u) << i;
    }
}

// Two cubes that share an edge: their faces continue each other there, yet it is a crease of both.
TEST(Features, cubesSharingAnEdge) {
    Surface s;
    addCube(s, {0, 0, 0});
    addCube(s, {1, 1, 0});
    const FeatureGraph g = graphOf(s);
    EXPECT_EQ(g.edges.size(), 23u);
    EXPECT_EQ(g.sharpEdges, 23u);
    EXPECT_EQ(g.nonManifoldEdges, 1u);
    EXPECT_EQ(g.corners.size(), 14u);
}

// A plane covered twice lies flat; two sheets that cross are a crease, and so is a half sheet on a plane.
TEST(Features, nonManifoldEdges) {
    const Vec3 a{0, 0, 0}, b{1, 0, 0};
    Surface doubled;
    for (const Vec3& c : {Vec3{0.5, 1, 0}, Vec3{0.5, -1, 0}, Vec3{0.4, 1, 0}, Vec3{0.4, -1, 0}})
        addTriangle(doubled, a, b, c);
    FeatureGraph g = graphOf(doubled);
    EXPECT_EQ(g.nonManifoldEdges, 1u);
    EXPECT_EQ(g.sharpEdges, 0u);
    EXPECT_EQ(count(g, open), 8u);
    EXPECT_EQ(g.corners.size(), 0u);

    Surface crossing;
    for (const Vec3& c : {Vec3{0.5, 1, 0}, Vec3{0.5, -1, 0}, Vec3{0.5, 0, 1}, Vec3{0.5, 0, -1}})
        addTriangle(crossing, a, b, c);
    EXPECT_EQ(graphOf(crossing).sharpEdges, 1u);

    Surface stem;
    for (const Vec3& c : {Vec3{0.5, 1, 0}, Vec3{0.5, -1, 0}, Vec3{0.5, 0, 1}}) addTriangle(stem, a, b, c);
    g = graphOf(stem);
    EXPECT_EQ(count(g, sharp), 1u);
    EXPECT_EQ(count(g, nonManifold), 1u);
    EXPECT_EQ(g.corners.size(), 2u); // a line that ends in the open

    Surface rim; // two skins that end together
    for (const Vec3& c : {Vec3{0.5, 1, 0}, Vec3{0.4, 1, 0}, Vec3{0.6, 1, 0}}) addTriangle(rim, a, b, c);
    g = graphOf(rim);
    EXPECT_EQ(count(g, sharp), 1u);
}

// An open sheet of two parts: its border is free, the seam belongs to both, nothing is sharp.
TEST(Features, sheetOfTwoParts) {
    Surface s;
    addQuad(s, {0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, 0);
    addQuad(s, {1, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}, 1);
    const FeatureGraph g = graphOf(s);
    EXPECT_EQ(count(g, open), 6u);
    EXPECT_EQ(count(g, border), 1u);
    EXPECT_EQ(count(g, sharp), 0u);
    EXPECT_NEAR(g.openEdgeLength, 6, 1e-9);
}

// Two sheets folded back on each other: 180 degrees, whichever way they are oriented.
TEST(Features, foldedBack) {
    Surface s;
    addTriangle(s, {0, 0, 0}, {1, 0, 0}, {0.5, 1, 1e-3});
    addTriangle(s, {0, 0, 0}, {1, 0, 0}, {0.5, 1, -1e-3});
    FeatureGraph g = graphOf(s);
    ASSERT_EQ(count(g, sharp), 1u);
    const float angle = std::max_element(g.edges.begin(), g.edges.end(), [](auto& a, auto& b) {
                            return a.angle < b.angle;
                        })->angle;
    EXPECT_NEAR(angle, 180, 0.2);
    std::swap(s.triangles[0][0], s.triangles[0][1]);
    EXPECT_EQ(graphOf(s).checksum(), g.checksum());
    EXPECT_EQ(graphOf(s, 180).sharpEdges, 0u);
}

// A cylinder: its two rims are sharp lines without corners, its wall is smooth.
TEST(Features, cylinder) {
    Surface s;
    constexpr int n = 48;
    const auto p = [&](int i, double z) {
        const double a = 2 * std::numbers::pi * (i % n) / n;
        return Vec3{std::cos(a), std::sin(a), z};
    };
    for (int i = 0; i < n; ++i) {
        addQuad(s, p(i, 0), p(i + 1, 0), p(i + 1, 2), p(i, 2));
        addTriangle(s, {0, 0, 0}, p(i, 0), p(i + 1, 0));
        addTriangle(s, {0, 0, 2}, p(i, 2), p(i + 1, 2));
    }
    const FeatureGraph g = graphOf(s);
    EXPECT_EQ(g.sharpEdges, 2u * n);
    EXPECT_EQ(g.corners.size(), 0u);
    EXPECT_EQ(graphOf(s, 7).sharpEdges, 3u * n); // 7.5 degrees between the facets
}

// A needle on an edge of the cube (a T-junction closed with a triangle of no height) changes nothing.
TEST(Features, needleInTheSeam) {
    Surface s;
    addCube(s, {0, 0, 0});
    // The face z = 0 again, with a point on the middle of the edge y = z = 0 and a needle to close the gap.
    s.triangles.erase(s.triangles.begin(), s.triangles.begin() + 2);
    s.partOf.resize(s.triangles.size());
    const Vec3 a{0, 0, 0}, b{1, 0, 0}, c{1, 1, 0}, d{0, 1, 0}, m{0.5, 0, 0};
    addTriangle(s, a, m, d);
    addTriangle(s, m, c, d);
    addTriangle(s, m, b, c);
    addTriangle(s, a, m, b);
    const FeatureGraph g = graphOf(s);
    EXPECT_EQ(g.degenerateTriangles, 1u);
    EXPECT_EQ(g.openEdges, 0u);
    EXPECT_EQ(g.sharpEdges, 13u);
    EXPECT_EQ(g.corners.size(), 8u);
    EXPECT_NEAR(g.sharpEdgeLength, 12, 1e-9);
}

// A crease that opens from flat to a right angle: the line ends where it fades, but that end is no corner.
TEST(Features, fadingCrease) {
    Surface s;
    const auto ridge = [](int i) { return Vec3{double(i), 0, 0}; };
    const auto flank = [](int i, double side) {
        const double a = i * 4.5 * std::numbers::pi / 180; // half the fold
        return Vec3{double(i), side * std::cos(a), -std::sin(a)};
    };
    for (int i = 0; i < 10; ++i)
        for (const double side : {-1.0, 1.0}) {
            addTriangle(s, ridge(i), ridge(i + 1), flank(i, side));
            addTriangle(s, ridge(i + 1), flank(i + 1, side), flank(i, side));
        }
    const FeatureGraph g = graphOf(s);
    EXPECT_EQ(count(g, sharp), 5u); // folds of 9 i degrees along the edges i = 5 .. 9
    ASSERT_EQ(g.corners.size(), 1u);
    EXPECT_EQ(g.points[g.corners[0]], ridge(10));
}

// The motorbike of the OpenFOAM examples: 331,653 triangles, a fifth of them copies, many sheets that meet in
// one edge. Judging it without welding, copies and non-manifold edges gives 12,600 corners.
TEST(Features, motorBike) {
    const std::string file = "/usr/share/doc/openfoam-examples/examples/resources/geometry/motorBike.obj.gz";
    if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is not here";
    const auto r = test::read({file});
    ASSERT_FALSE(r.error);
    const FeatureGraph g = graphOf(r.surface);
    EXPECT_EQ(g.weldedPoints, 132871u);
    EXPECT_EQ(g.duplicateTriangles, 67326u);
    EXPECT_GT(g.sharpEdgeLength, 100);
    EXPECT_GT(g.corners.size(), 300u);
    EXPECT_LT(g.corners.size(), 1500u);
}

// Nothing in, nothing out.
TEST(Features, empty) { EXPECT_TRUE(graphOf(Surface{}).edges.empty()); }

// The same graph on any number of threads.
TEST(Features, threads) {
    Surface s;
    std::mt19937_64 engine(2);
    std::uniform_int_distribution<int> at(0, 12);
    const auto p = [&] { return Vec3{double(at(engine)), double(at(engine)), double(at(engine))} * 0.1; };
    for (int i = 0; i < 20000; ++i) addTriangle(s, p(), p(), p(), i % 3);
    const std::uint64_t expected = graphOf(s).checksum();
    for (const std::size_t n : {1u, 2u, 3u, 8u}) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, n);
        EXPECT_EQ(graphOf(s).checksum(), expected) << n;
    }
}

} // namespace
} // namespace i2b
