// Features that the user names, on shapes whose edges can be counted: lines from files, parts, boxes.
#include "geometry_files.h"
#include "i2b/geometry/features.h"
#include "soups.h"
#include <tbb/global_control.h>

namespace i2b {
namespace {

using test::addCube;
using test::addQuad;
using test::count;
using test::length;

FeatureGraph graphOf(const Surface& s, const FeatureOptions& options) {
    const FeatureGraph g = buildFeatureGraph(s, options);
    EXPECT_EQ(g.validate(), "");
    return g;
}

bool hasCorner(const FeatureGraph& g, const Vec3& at) {
    return std::any_of(g.corners.begin(), g.corners.end(),
                       [&](std::uint32_t c) { return norm(g.points[c] - at) < 1e-9; });
}

FeatureLines linesOf(const std::vector<std::array<Vec3, 2>>& segments) {
    FeatureLines lines;
    for (const auto& [a, b] : segments) {
        const auto n = static_cast<std::uint32_t>(lines.points.size());
        lines.points.insert(lines.points.end(), {a, b});
        lines.segments.push_back({n, n + 1});
    }
    return lines;
}

// Two flat sheets of two parts, side by side over [0, 2] x [0, 1].
Surface twoSheets() {
    Surface s;
    s.parts = {{"left", "", 2}, {"right", "", 2}};
    addQuad(s, {0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, 0);
    addQuad(s, {1, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}, 1);
    return s;
}

// A line along the flat diagonal of a face names that edge; it ends in corners of the cube, which stay the only ones.
TEST(NamedFeatures, lineAlongAnEdge) {
    Surface s;
    addCube(s, {0, 0, 0});
    FeatureOptions o;
    o.lines = linesOf({{{{0, 0, 0}, {1 + 1e-9, 1, 0}}}, {{{0, 0, 0}, {1, 0, 0}}}, {{{1, 0, 0}, {0, 0, 0}}}});
    const FeatureGraph g = graphOf(s, o);
    EXPECT_EQ(count(g, EdgeKind::named), 2u); // the diagonal, and an edge that is sharp, too
    EXPECT_EQ(g.namedEdges, 2u);
    EXPECT_NEAR(g.namedEdgeLength, 1 + std::sqrt(2), 1e-9);
    EXPECT_EQ(g.sharpEdges, 12u);
    EXPECT_EQ(g.edges.size(), 13u);
    EXPECT_EQ(g.points.size(), 8u);
    EXPECT_EQ(g.corners.size(), 8u);
    EXPECT_EQ(g.weldedPoints, 8u);
}

// Lines off the triangles' edges: their ends, their turns over the angle and their meetings are corners; points that
// they only pass are none.
TEST(NamedFeatures, cornersOfLines) {
    const Surface s = twoSheets();
    FeatureOptions o;
    const Vec3 a{0.1, 0.5, 0}, b{0.3, 0.5, 0}, c{0.5, 0.5, 0}, d{0.7, 0.7, 0}, e{0.7, 0.2, 0}, f{0.7, 0.9, 0};
    o.lines = linesOf({{{a, b}}, {{b, c}}, {{c, d}}});
    FeatureGraph g = graphOf(s, o);
    EXPECT_EQ(count(g, EdgeKind::named), 3u);
    EXPECT_EQ(g.weldedPoints, 6u); // of the triangles alone
    EXPECT_EQ(g.corners.size(), 3u); // two ends and a turn of 45 degrees
    EXPECT_TRUE(hasCorner(g, a) && hasCorner(g, c) && hasCorner(g, d));
    o.angle = 50;
    EXPECT_EQ(graphOf(s, o).corners.size(), 2u);
    o.lines = linesOf({{{e, d}}, {{d, f}}, {{d, c}}});
    g = graphOf(s, o);
    EXPECT_EQ(g.corners.size(), 4u);
    EXPECT_TRUE(hasCorner(g, d));
    EXPECT_TRUE(g.notes.empty());
}

// A sharp line that a milder fold continues ends in no corner; a named one does, whatever goes on.
TEST(NamedFeatures, endOfANamedLineIsACorner) {
    Surface s;
    const auto ridge = [](int i) { return Vec3{double(i), 0, 0}; };
    for (int i = 0; i < 4; ++i)
        for (const double side : {-1.0, 1.0})
            addQuad(s, ridge(i), ridge(i + 1), {i + 1.0, side, -0.25}, {double(i), side, -0.25}); // folds of 28 degrees
    FeatureOptions o;
    EXPECT_EQ(graphOf(s, o).corners.size(), 0u);
    o.lines = linesOf({{{ridge(0), ridge(1)}}, {{ridge(1), ridge(2)}}});
    const FeatureGraph g = graphOf(s, o);
    EXPECT_EQ(g.corners.size(), 2u);
    EXPECT_TRUE(hasCorner(g, ridge(0)) && hasCorner(g, ridge(2)));
}

// Points of a file are corners, on the geometry or off it.
TEST(NamedFeatures, pointsAreCorners) {
    FeatureOptions o;
    o.lines.points = {{1, 0, 0}, {0.2, 0.2, 0}};
    o.lines.corners = {0, 1, 1};
    const FeatureGraph g = graphOf(twoSheets(), o);
    EXPECT_EQ(g.corners.size(), 2u);
    EXPECT_TRUE(hasCorner(g, {1, 0, 0}) && hasCorner(g, {0.2, 0.2, 0}));
    EXPECT_EQ(count(g, EdgeKind::named), 0u);
}

// A named part's free edges and its border to the other part count, though all is flat; its inner edges do not.
TEST(NamedFeatures, partsByNameAndExpression) {
    FeatureOptions o;
    o.parts = {"left"};
    FeatureGraph g = graphOf(twoSheets(), o);
    EXPECT_EQ(count(g, EdgeKind::named), 4u);
    EXPECT_EQ(g.corners.size(), 4u); // the turns of the quad
    o.parts = {"l.*t", "right"};
    g = graphOf(twoSheets(), o);
    EXPECT_EQ(count(g, EdgeKind::named), 7u);
    EXPECT_EQ(g.corners.size(), 6u);
    EXPECT_TRUE(g.notes.empty());
    o.parts = {"lef"};
    g = graphOf(twoSheets(), o);
    EXPECT_EQ(count(g, EdgeKind::named), 0u);
    ASSERT_EQ(g.notes.size(), 1u);
    EXPECT_TRUE(test::contains(g.notes[0], "'lef'"));
}

// No edge counts in a box that says none, every folded edge in one that says all, and edges are cut where boxes end.
TEST(NamedFeatures, boxes) {
    Surface s;
    addCube(s, {0, 0, 0});
    FeatureOptions o;
    const Box upper{{-1, -1, 0.25}, {2, 2, 2}};
    o.boxes = {{upper, BoxEdges::none}};
    FeatureGraph g = graphOf(s, o);
    EXPECT_NEAR(g.sharpEdgeLength, 4 + 4 * 0.25, 1e-9);
    EXPECT_EQ(g.sharpEdges, 8u);
    EXPECT_EQ(g.corners.size(), 4u); // a fold goes on where the box begins: no corner there
    o.angle = 180;
    o.boxes = {{upper, BoxEdges::all}};
    g = graphOf(s, o);
    EXPECT_NEAR(g.sharpEdgeLength, 4 + 4 * 0.75, 1e-9); // the faces' diagonals are flat
    EXPECT_TRUE(hasCorner(g, {1, 1, 1}));
    EXPECT_EQ(g.openEdges, 0u);
}

// The later of two boxes wins where they overlap.
TEST(NamedFeatures, laterBoxesWin) {
    Surface s;
    addCube(s, {0, 0, 0});
    FeatureOptions o;
    const FeatureBox whole{{{-1, -1, -1}, {2, 2, 2}}, BoxEdges::none};
    const FeatureBox upper{{{-1, -1, 0.5}, {2, 2, 2}}, BoxEdges::all};
    o.boxes = {whole, upper};
    EXPECT_NEAR(graphOf(s, o).sharpEdgeLength, 4 + 4 * 0.5, 1e-9);
    o.boxes = {upper, whole};
    EXPECT_EQ(graphOf(s, o).sharpEdges, 0u);
}

// A box takes away what parts name, and leaves what a file draws, whole.
TEST(NamedFeatures, boxesAndNames) {
    FeatureOptions o;
    o.parts = {".*"};
    o.boxes = {{{{-1, -1, -1}, {0.5, 2, 1}}, BoxEdges::none}};
    FeatureGraph g = graphOf(twoSheets(), o);
    EXPECT_NEAR(length(g, EdgeKind::named), 7 - 2, 1e-9);
    EXPECT_EQ(g.openEdges, 6u); // counted before boxes cut them
    EXPECT_NEAR(length(g, EdgeKind::free), 6, 1e-9);
    o.parts.clear();
    o.lines = linesOf({{{{0, 0, 0}, {1, 0, 0}}}});
    g = graphOf(twoSheets(), o);
    EXPECT_EQ(count(g, EdgeKind::named), 1u);
    EXPECT_NEAR(length(g, EdgeKind::named), 1, 1e-9);
}

// Lines in another unit than the geometry's are noted.
TEST(NamedFeatures, farLinesAreNoted) {
    FeatureOptions o;
    o.lines = linesOf({{{{1000, 0, 0}, {2000, 0, 0}}}});
    const FeatureGraph g = graphOf(twoSheets(), o);
    ASSERT_EQ(g.notes.size(), 1u);
    EXPECT_TRUE(test::contains(g.notes[0], "unit"));
}

// The same graph on any number of threads, with names of every kind.
TEST(NamedFeatures, threads) {
    Surface s;
    s.parts = {{"a", "", 0}, {"b", "", 0}};
    for (int i = 0; i < 600; ++i) addCube(s, Vec3{double(i % 10), double(i / 10 % 10), double(i / 100)} * 1.5, i % 2);
    FeatureOptions o;
    o.parts = {"b"};
    o.boxes = {{{{2.2, 2.2, 2.2}, {9.1, 9.1, 9.1}}, BoxEdges::none}, {{{4.7, 1, 1}, {8, 8, 8}}, BoxEdges::all}};
    o.lines = linesOf({{{{0, 0, 0}, {1, 1, 0}}}, {{{1, 1, 0}, {3, 3, 3}}}});
    const std::uint64_t expected = graphOf(s, o).checksum();
    for (const std::size_t n : {1u, 2u, 3u, 8u}) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, n);
        EXPECT_EQ(graphOf(s, o).checksum(), expected) << n;
    }
}

// ---- files

FeatureLines readLines(const std::string& file, double scale, std::vector<std::string>& notes) {
    return readFeatureLines({file}, scale, notes);
}

std::string complaint(const std::string& file) {
    std::vector<std::string> notes;
    try {
        readLines(file, 1, notes);
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::input);
        return error.what();
    }
    return "accepted";
}

// Polylines, points counted from the end, corners; scaled. Faces beside them are left out, with a note.
TEST(FeatureLinesFile, readsLinesAndPoints) {
    const test::TempFolder folder;
    const std::string file = folder.write("a.obj", "v 0 0 0\nv 9 9 9\nv 1000 0 0\nv 1000 500 0\nv 0 0 7\n"
                                                   "f 1 2 3\nl 1 3 4\nl -1 -5\np 4\n");
    std::vector<std::string> notes;
    const FeatureLines lines = readLines(file, 0.001, notes);
    EXPECT_EQ(lines.points.size(), 4u); // not the one that only the face uses
    ASSERT_EQ(lines.segments.size(), 3u);
    const auto at = [&](std::size_t s, std::size_t end) { return lines.points[lines.segments[s][end]]; };
    EXPECT_LT(norm(at(1, 0) - Vec3{1, 0, 0}) + norm(at(1, 1) - Vec3{1, 0.5, 0}), 1e-12);
    EXPECT_LT(norm(at(2, 0) - Vec3{0, 0, 0.007}), 1e-12);
    ASSERT_EQ(lines.corners.size(), 1u);
    EXPECT_LT(norm(lines.points[lines.corners[0]] - Vec3{1, 0.5, 0}), 1e-12);
    ASSERT_EQ(notes.size(), 1u);
    EXPECT_TRUE(test::contains(notes[0], "1 triangle"));
}

// Several files are one set; gzip as everywhere.
TEST(FeatureLinesFile, joinsFiles) {
    const test::TempFolder folder;
    const std::string a = folder.write("a.obj", "v 0 0 0\nv 1 0 0\nl 1 2\n");
    const std::string b = folder.write("b.obj.gz", test::gzip("v 0 0 5\nv 1 0 5\nl 1 2\np 2\n"));
    std::vector<std::string> notes;
    const FeatureLines lines = readFeatureLines({a, b}, 1, notes);
    ASSERT_EQ(lines.segments.size(), 2u);
    EXPECT_EQ(lines.points[lines.segments[1][0]], (Vec3{0, 0, 5}));
    EXPECT_EQ(lines.points[lines.corners.at(0)], (Vec3{1, 0, 5}));
    EXPECT_TRUE(notes.empty());
}

// What is wrong is told with the file, the line where there is one, and what to do.
TEST(FeatureLinesFile, refusesWhatIsNoLines) {
    const test::TempFolder folder;
    EXPECT_TRUE(test::contains(complaint(folder.path("none.obj")), "none.obj"));
    const std::string stl = complaint(folder.write("a.obj", test::asciiSolid("a", test::tetrahedron())));
    EXPECT_TRUE(test::contains(stl, "no Wavefront OBJ") && test::contains(stl, "a.obj") && test::contains(stl, "as l"));
    const std::string faces = complaint(folder.write("b.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"));
    EXPECT_TRUE(test::contains(faces, "neither lines nor points") && test::contains(faces, "b.obj"));
    const std::string broken = complaint(folder.write("c.obj", "v 0 0 0\nv 1 0 0\nl 1 two\n"));
    EXPECT_TRUE(test::contains(broken, "line 3") && test::contains(broken, "c.obj"));
    EXPECT_TRUE(test::contains(complaint(folder.write("d.obj", "v 0 0 0\nl 1 2\n")), "names point 2"));
}

} // namespace
} // namespace i2b
