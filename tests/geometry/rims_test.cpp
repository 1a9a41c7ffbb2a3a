// Proves: the rim of a sheet that ends in the open is found whole, with its corners; cracks, overlaps and feet of
// sheets that stand on others are told from it at the scale asked for.
#include "geometry_files.h"
#include "i2b/geometry/rims.h"
#include "soups.h"
#include <filesystem>
#include <functional>
#include <numbers>
#include <tbb/global_control.h>

namespace i2b {
namespace {

using test::addCube;
using test::addQuad;
using test::count;
using test::length;

FeatureGraph graphOf(const Surface& s, double gap, const FeatureOptions& options = {}) {
    FeatureGraph g = buildFeatureGraph(s, options);
    markRims(g, SurfaceIndex(s), options, gap);
    EXPECT_EQ(g.validate(), "");
    EXPECT_EQ(g.rimEdges, count(g, EdgeKind::rim));
    EXPECT_NEAR(g.rimEdgeLength, length(g, EdgeKind::rim), 1e-9);
    for (const FeatureEdge& e : g.edges)
        EXPECT_TRUE(!(e.kinds & bitOf(EdgeKind::rim)) || (e.kinds & bitOf(EdgeKind::free)));
    return g;
}

// n x n squares over [0, 1] x [0, 1], where place() puts them.
void addSheet(Surface& s, int n, const std::function<Vec3(double, double)>& place) {
    const auto at = [&](int i, int j) { return place(double(i) / n, double(j) / n); };
    for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) addQuad(s, at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
}

double lengthAt(const FeatureGraph& g, const std::function<bool(const Vec3&)>& holds) {
    double sum = 0;
    for (const FeatureEdge& e : g.edges) {
        const Vec3 a = g.points[e.a], b = g.points[e.b];
        if ((e.kinds & bitOf(EdgeKind::rim)) && holds((a + b) * 0.5)) sum += norm(b - a);
    }
    return sum;
}

// Coarse or fine, small or large beside the gap: the four sides of a sheet are its rim, its four corners corners.
TEST(Rims, sheetAlone) {
    for (const int n : {1, 3, 20})
        for (const double gap : {0.0, 0.01, 0.3}) {
            Surface s;
            addSheet(s, n, [](double u, double v) { return Vec3{u, 0.8 * v, 0.6 * v}; });
            const FeatureGraph g = graphOf(s, gap);
            EXPECT_EQ(count(g, EdgeKind::rim), 4u * static_cast<unsigned>(n)) << n << " " << gap;
            EXPECT_EQ(g.corners.size(), 4u) << n << " " << gap;
            EXPECT_EQ(g.sharpEdges, 0u);
        }
}

// A curved sheet, and one with a hole: a rim as long as the hole is wider than the gap.
TEST(Rims, curvedSheetAndHole) {
    Surface half; // of a cylinder of radius 1
    addSheet(half, 24, [](double u, double v) {
        return Vec3{std::cos(std::numbers::pi * u), std::sin(std::numbers::pi * u), 3 * v};
    });
    EXPECT_EQ(count(graphOf(half, 0.3), EdgeKind::rim), 96u);
    Surface ring; // between the radii 0.1 and 1
    addSheet(ring, 24, [](double u, double v) {
        const double a = 2 * std::numbers::pi * u, r = 0.1 + 0.9 * v;
        return Vec3{r * std::cos(a), r * std::sin(a), 0};
    });
    FeatureGraph g = graphOf(ring, 0.15);
    EXPECT_EQ(count(g, EdgeKind::rim), 48u);
    EXPECT_EQ(g.corners.size(), 0u);
    EXPECT_EQ(count(graphOf(ring, 0.25), EdgeKind::rim), 24u);
}

// An open box: its rim runs along its walls, whose folds end in it.
TEST(Rims, openBox) {
    Surface s;
    addCube(s, {0, 0, 0});
    s.triangles.erase(s.triangles.begin() + 2, s.triangles.begin() + 4); // z = 1
    s.partOf.resize(s.triangles.size());
    const FeatureGraph g = graphOf(s, 0.1);
    EXPECT_EQ(count(g, EdgeKind::rim), 4u);
    EXPECT_EQ(g.sharpEdges, 8u);
    EXPECT_EQ(g.corners.size(), 8u);
}

// Two sheets with a crack between them: rims only where the gap asked for is smaller than the crack. The rims of the
// other sides go straight on as cracks, or turn: corners where they turn.
TEST(Rims, cracks) {
    Surface s;
    addSheet(s, 5, [](double u, double v) { return Vec3{u, v, 0}; });
    addSheet(s, 4, [](double u, double v) { return Vec3{1.01 + u, v, 0.002}; });
    const auto inCrack = [](const Vec3& p) { return p.x > 0.999 && p.x < 1.011; };
    FeatureGraph g = graphOf(s, 0.05);
    EXPECT_NEAR(lengthAt(g, inCrack), 0, 1e-9);
    EXPECT_NEAR(g.rimEdgeLength, 6, 1e-9);
    g = graphOf(s, 0.005);
    EXPECT_NEAR(lengthAt(g, inCrack), 2, 1e-9);
    EXPECT_EQ(g.corners.size(), 8u);
}

// A lid that leaves a crack on its box, at the scales of both.
TEST(Rims, lid) {
    Surface s;
    addCube(s, {0, 0, 0});
    for (std::size_t v = 6; v < 12; ++v) s.points[v].z += 1e-3; // the two triangles of z = 1
    EXPECT_EQ(graphOf(s, 0.01).rimEdges, 0u);
    EXPECT_EQ(graphOf(s, 1e-4).rimEdges, 8u);
}

// Sheets that overlap, one a little above the other, and a sheet that lies on another: no rim where they lie together.
TEST(Rims, overlaps) {
    Surface s;
    addSheet(s, 5, [](double u, double v) { return Vec3{u, v, 0}; });
    addSheet(s, 5, [](double u, double v) { return Vec3{0.9 + u, v, 0.01}; });
    const FeatureGraph g = graphOf(s, 0.05);
    const auto together = [](const Vec3& p) { return p.x > 0.89 && p.x < 1.01 && p.y > 0.01 && p.y < 0.99; };
    EXPECT_NEAR(lengthAt(g, together), 0, 1e-9);
    Surface decal;
    addSheet(decal, 2, [](double u, double v) { return Vec3{4 * u - 2, 4 * v - 2, 0}; });
    addSheet(decal, 3, [](double u, double v) { return Vec3{0.5 * u, 0.5 * v, 0.01}; });
    EXPECT_NEAR(graphOf(decal, 0.05).rimEdgeLength, 16, 1e-9);
    EXPECT_NEAR(graphOf(decal, 0.005).rimEdgeLength, 18, 1e-9);
}

// A fin on a plate, without common points, touching it or short of it by less than the gap: its foot is no rim.
TEST(Rims, finOnAPlate) {
    for (const double above : {0.0, 0.01}) {
        Surface s;
        addSheet(s, 1, [](double u, double v) { return Vec3{4 * u - 2, 4 * v - 2, 0}; });
        addSheet(s, 5, [&](double u, double v) { return Vec3{u, 0.3 * u, above + v}; });
        const FeatureGraph g = graphOf(s, 0.05);
        EXPECT_NEAR(lengthAt(g, [](const Vec3& p) { return p.z > 0.02; }), 2 + std::sqrt(1.09), 1e-9) << above;
        EXPECT_NEAR(lengthAt(g, [](const Vec3& p) { return p.z <= 0.02; }), 16, 1e-9) << above;
    }
}

// Where no edge is to be sharp, none is a rim; lines that the user names stay beside rims.
TEST(Rims, angleAndBoxes) {
    Surface s;
    addSheet(s, 1, [](double u, double v) { return Vec3{u, v, 0}; });
    FeatureOptions o;
    o.boxes = {{{{-1, -1, -1}, {0.5, 2, 1}}, BoxEdges::none}};
    EXPECT_NEAR(graphOf(s, 0.1, o).rimEdgeLength, 2, 1e-9);
    o.boxes[0].edges = BoxEdges::all;
    o.angle = 180;
    EXPECT_NEAR(graphOf(s, 0.1, o).rimEdgeLength, 2, 1e-9);
    o.boxes.clear();
    EXPECT_EQ(graphOf(s, 0.1, o).rimEdges, 0u);
}

// A soup without free edges stays what it is.
TEST(Rims, closed) {
    Surface s;
    addCube(s, {0, 0, 0});
    EXPECT_EQ(graphOf(s, 0.1).checksum(), buildFeatureGraph(s, {}).checksum());
}

// The motorbike has thousands of free edges, of sheets and of cracks. The coarser the cells, the less of them is a rim.
TEST(Rims, motorBike) {
    const std::string file = "/usr/share/doc/openfoam-examples/examples/resources/geometry/motorBike.obj.gz";
    if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is not here";
    const auto r = test::read({file});
    ASSERT_FALSE(r.error);
    const FeatureGraph fine = graphOf(r.surface, 0.002), coarse = graphOf(r.surface, 0.016);
    EXPECT_GT(coarse.rimEdgeLength, 0.02 * fine.openEdgeLength);
    EXPECT_LT(coarse.rimEdgeLength, fine.rimEdgeLength);
    EXPECT_LT(fine.rimEdgeLength, fine.openEdgeLength);
}

// The same on any number of threads.
TEST(Rims, threads) {
    Surface s;
    for (int i = 0; i < 200; ++i) {
        const double x = i % 10, y = i / 10;
        addSheet(s, 3, [&](double u, double v) { return Vec3{x + 0.98 * u, y + v, 0.01 * (i % 3)}; });
    }
    const std::uint64_t expected = graphOf(s, 0.05).checksum();
    for (const std::size_t n : {1u, 2u, 3u, 8u}) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, n);
        EXPECT_EQ(graphOf(s, 0.05).checksum(), expected) << n;
    }
}

} // namespace
} // namespace i2b
