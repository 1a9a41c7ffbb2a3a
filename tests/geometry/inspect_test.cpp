#include "geometry_files.h"
#include "i2b/geometry/inspect.h"
#include <gmock/gmock.h>
#include <tbb/global_control.h>

namespace i2b::test {
namespace {

Surface surfaceOf(const std::vector<std::vector<Corners>>& parts) {
    Surface s;
    for (std::size_t p = 0; p < parts.size(); ++p) {
        s.parts.push_back({fmt::format("part{}", p), "x.stl", parts[p].size()});
        for (const Corners& c : parts[p]) {
            const auto first = static_cast<std::uint32_t>(s.points.size());
            s.points.insert(s.points.end(), c.begin(), c.end());
            s.triangles.push_back({first, first + 1, first + 2});
            s.partOf.push_back(static_cast<std::int32_t>(p));
        }
    }
    return s;
}

// Proves: boxes, areas and edge lengths against values worked out by hand.
TEST(Inspect, Figures) {
    const Surface s = surfaceOf({tetrahedron(), {{Vec3{10, 0, 0}, Vec3{13, 0, 0}, Vec3{10, 4, 0}}}});
    const InspectReport r = inspect(s, {});
    ASSERT_EQ(r.parts.size(), 2u);
    EXPECT_EQ(r.triangles, 5u);
    EXPECT_EQ(r.parts[1].triangles, 1u);
    EXPECT_EQ(r.parts[1].box, (Box{{10, 0, 0}, {13, 4, 0}}));
    EXPECT_NEAR(r.parts[0].area, 1.5 + std::sqrt(3.0) / 2, 1e-14);
    EXPECT_DOUBLE_EQ(r.parts[1].area, 6);
    EXPECT_DOUBLE_EQ(r.area, r.parts[0].area + 6);
    EXPECT_EQ(r.bounds, (Box{{0, 0, 0}, {13, 4, 1}}));
    EXPECT_DOUBLE_EQ(r.smallestEdge, 1);
    EXPECT_DOUBLE_EQ(r.largestEdge, 5);
    // 6 x 1, 6 x sqrt 2, then 3, 4, 5: the 8th of 15.
    EXPECT_EQ(r.medianEdge, double(std::sqrt(2.0f)));
}

// Proves: the median found by halves of the bits is the median of the sorted list, whatever the number of
// threads, and an edge without length does not become the smallest.
TEST(Inspect, MedianIsThatOfTheSortedList) {
    auto triangles = sheet(64);
    for (std::size_t t = 0; t < triangles.size(); ++t) triangles[t][2].z += 1e-3 * double((t * 7919) % 1000);
    triangles.push_back({Vec3{0, 0, 0}, Vec3{0, 0, 0}, Vec3{1, 0, 0}});
    std::vector<float> lengths;
    for (const Corners& c : triangles)
        for (std::size_t k = 0; k < 3; ++k)
            lengths.push_back(static_cast<float>(norm(c[(k + 1) % 3] - c[k])));
    std::sort(lengths.begin(), lengths.end());
    const Surface s = surfaceOf({triangles});
    for (const std::size_t threads : {1u, 2u, 3u}) {
        const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
        const InspectReport r = inspect(s, {});
        EXPECT_EQ(r.medianEdge, double(lengths[(lengths.size() - 1) / 2]));
        EXPECT_GT(r.smallestEdge, 0);
        EXPECT_EQ(r.area, inspect(s, {}).area);
    }
}

// Proves: counts and lengths come from the feature graph; its non-manifold and border edges are measured.
TEST(Inspect, Features) {
    FeatureGraph f;
    f.points = {{0, 0, 0}, {2, 0, 0}, {2, 3, 0}};
    f.edges = {{0, 1, std::uint8_t(EdgeKind::nonManifold) | std::uint8_t(EdgeKind::sharp), 90},
               {1, 2, std::uint8_t(EdgeKind::partBorder), 0}};
    f.corners = {1};
    f.openEdges = 7, f.openEdgeLength = 0.5, f.sharpEdges = 1, f.sharpEdgeLength = 2, f.nonManifoldEdges = 1;
    f.degenerateTriangles = 3, f.duplicateTriangles = 4, f.weldedPoints = 11;
    const InspectReport r = inspect(surfaceOf({tetrahedron()}), f);
    EXPECT_EQ(r.openEdges, 7u);
    EXPECT_EQ(r.partBorderEdges, 1u);
    EXPECT_EQ(r.corners, 1u);
    EXPECT_DOUBLE_EQ(r.nonManifoldEdgeLength, 2);
    const std::string text = format(r);
    for (const char* words :
         {"part0", "open edges           7, 500 mm long", "non-manifold edges   1, 2 m long",
          "duplicate triangles  4", "degenerate triangles 3", "suggested size       0.005 m"})
        EXPECT_THAT(text, testing::HasSubstr(words));
    EXPECT_EQ(text.back(), '\n');
}

// Proves: the suggestion is a round number within its bounds, finer where the geometry is finer, and 0 for
// nothing.
TEST(Inspect, SuggestedSize) {
    EXPECT_DOUBLE_EQ(suggestSize(4.6, 0.0094), 0.01); // a car
    EXPECT_DOUBLE_EQ(suggestSize(1, 1), 0.005);       // a box of twelve triangles
    EXPECT_DOUBLE_EQ(suggestSize(1000, 1e-6), 1);     // dust: the bound, extent / 1000
    EXPECT_EQ(suggestSize(0, 0), 0);
    EXPECT_EQ(inspect({}, {}).suggestedSize, 0);
}

} // namespace
} // namespace i2b::test
