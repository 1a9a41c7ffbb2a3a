// Proves: the fit sees every line that a mesh should show, sharp, named or rim, and no other edge of the graph, which of them are faint,
// and which a node stands all but on; creases are kept apart from lines.
#include "i2b/fit/features.h"
#include "i2b/geometry/rims.h"
#include <gtest/gtest.h>
#include <numbers>

namespace i2b {
namespace {

// Two unit squares side by side, of two parts; flat.
Surface sheets() {
    Surface s;
    s.points = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 1, 0}, {1, 1, 0}, {2, 1, 0}};
    s.triangles = {{0, 1, 4}, {0, 4, 3}, {1, 2, 5}, {1, 5, 4}};
    s.partOf = {0, 0, 1, 1};
    s.parts = {{"left", "", 2}, {"right", "", 2}};
    return s;
}

bool seesLineAt(const FeatureGraph& graph, const Vec3& q) {
    const FeatureIndex::Line line = FeatureIndex(graph).closestLine(q, 0.1);
    return line.found && norm(line.point - q) < 1e-9;
}

TEST(FeatureIndex, namedLinesAndRims) {
    const Surface s = sheets();
    const SurfaceIndex index(s);
    const Vec3 onBorder{1, 0.5, 0}, onRim{0.5, 1, 0}, drawn{0.5, 0.25, 0};
    FeatureOptions options;
    FeatureGraph graph = buildFeatureGraph(s, options);
    EXPECT_TRUE(FeatureIndex(graph).empty()); // free edges and borders alone are no lines
    markRims(graph, index, options, 0.1);
    EXPECT_TRUE(seesLineAt(graph, onRim));
    EXPECT_FALSE(seesLineAt(graph, onBorder));
    EXPECT_TRUE(FeatureIndex(graph).closestCorner({0, 0, 0}, 0.1));
    EXPECT_FALSE(FeatureIndex(graph).closestCorner({1, 0, 0}, 0.1)); // the rim only passes there
    options.parts = {"left"};
    EXPECT_TRUE(seesLineAt(buildFeatureGraph(s, options), onBorder));
    options.parts.clear();
    options.lines = {{{0.25, 0.25, 0}, {0.75, 0.25, 0}}, {{0, 1}}, {}};
    EXPECT_TRUE(seesLineAt(buildFeatureGraph(s, options), drawn));
}

// Nodes up to a fifth of a cell beside a line stand all but on it; what a rim needs is done later.
TEST(FeatureIndex, linesUponWhichNodesStand) {
    const Surface s = sheets();
    FeatureOptions options;
    options.parts = {"left"};
    const FeatureIndex named(buildFeatureGraph(s, options));
    EXPECT_TRUE(lineUpon(named, {1.015, 0.5, 0.005}, 0.1).found);
    EXPECT_FALSE(lineUpon(named, {1.03, 0.5, 0}, 0.1).found);
    options.lines = {{{1.05, 0, 0}, {1.05, 1, 0}}, {{0, 1}}, {}}; // half a cell beside it
    EXPECT_FALSE(lineUpon(FeatureIndex(buildFeatureGraph(s, options)), {1.015, 0.5, 0.005}, 0.1).found);
    options.parts.clear(), options.lines = {};
    FeatureGraph graph = buildFeatureGraph(s, options);
    markRims(graph, SurfaceIndex(s), options, 0.1);
    const FeatureIndex rims(graph);
    EXPECT_TRUE(rims.closestLine({0.5, 1.01, 0}, 0.1).isRim);
    EXPECT_FALSE(lineUpon(rims, {0.5, 1.01, 0}, 0.1).found);
}

// Two squares that fold by so many degrees.
Surface folded(double degrees) {
    Surface s = sheets();
    const double angle = degrees * std::numbers::pi / 180;
    for (Vec3& p : s.points) {
        if (p.x > 1) p.x = 1 + std::cos(angle), p.z = std::sin(angle);
    }
    return s;
}

// Lines at which the normals of the two sides do not tell: named ones on flat walls, and folds over a small angle of the user's.
TEST(FeatureIndex, faintLines) {
    const Vec3 onBorder{1, 0.5, 0};
    const FeatureIndex small(buildFeatureGraph(folded(20), {.angle = 15}));
    EXPECT_TRUE(small.hasFaint());
    EXPECT_TRUE(small.closestLine(onBorder, 0.1).isFaint);
    EXPECT_TRUE(small.closestFaint(onBorder, 0.1).found);
    EXPECT_TRUE(small.isFaint(small.closestCorner({1, 0, 0}, 0.1)));
    const FeatureIndex large(buildFeatureGraph(folded(60), {.angle = 15}));
    EXPECT_FALSE(large.hasFaint());
    EXPECT_FALSE(large.closestLine(onBorder, 0.1).isFaint);
    EXPECT_FALSE(large.isFaint(large.closestCorner({1, 0, 0}, 0.1)));
    const FeatureIndex named(buildFeatureGraph(sheets(), {.parts = {"left"}}));
    EXPECT_TRUE(named.closestFaint(onBorder, 0.1).found);
}

// Folds below the angle, and over that of creases, are such, which are no lines; without sharp edges there are none.
TEST(FeatureIndex, creases) {
    const Vec3 onBorder{1, 0.5, 0};
    const FeatureIndex mild(buildFeatureGraph(folded(20), {}));
    EXPECT_TRUE(mild.hasCreases());
    EXPECT_TRUE(mild.closestCrease(onBorder, 0.1).found);
    EXPECT_TRUE(mild.closestCrease(onBorder, 0.1, 15).found);
    EXPECT_FALSE(mild.closestCrease(onBorder, 0.1, 25).found);
    EXPECT_FALSE(mild.closestLine(onBorder, 0.1).found);
    EXPECT_TRUE(mild.empty());
    EXPECT_FALSE(mild.closestCorner({1, 0, 0}, 0.1));
    for (const double degrees : {3.0, 50.0}) EXPECT_FALSE(FeatureIndex(buildFeatureGraph(folded(degrees), {})).hasCreases()) << degrees;
    EXPECT_TRUE(FeatureIndex(buildFeatureGraph(folded(3), {.crease = 2})).hasCreases());
    for (const double least : {25.0, 180.0}) EXPECT_FALSE(FeatureIndex(buildFeatureGraph(folded(20), {.crease = least})).hasCreases()) << least;
    EXPECT_FALSE(FeatureIndex(buildFeatureGraph(folded(20), {.angle = 180})).hasCreases());
    const FeatureBox none{{{-1, -1, -1}, {3, 3, 3}}, BoxEdges::none};
    EXPECT_FALSE(FeatureIndex(buildFeatureGraph(folded(20), {.boxes = {none}})).hasCreases());
}

} // namespace
} // namespace i2b
