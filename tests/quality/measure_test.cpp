#include "cell_mesh.h"
#include "i2b/quality/quality_report.h"
#include <cmath>
#include <gmock/gmock.h>
#include <numbers>
#include <random>
#include <tbb/global_control.h>

namespace i2b::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Pair;

std::vector<std::int32_t> idsOf(const QualityReport& report, const char* name) {
    const QualityCheck* check = findCheck(report, name);
    return check != nullptr ? check->ids : std::vector<std::int32_t>{};
}

// A single cube has the figures of a cube; with no internal face its determinant is zero, and that alone
// fails.
TEST(MeasureQuality, UnitCube) {
    const PolyMesh mesh = columnOf({square(0), square(1)});
    ASSERT_EQ(mesh.validate(), "");
    const QualityReport r = measureQuality(mesh);
    EXPECT_DOUBLE_EQ(r.totalVolume, 1);
    EXPECT_DOUBLE_EQ(r.minFaceArea, 1);
    EXPECT_DOUBLE_EQ(r.maxFaceArea, 1);
    EXPECT_DOUBLE_EQ(r.maxAspectRatio, 1);
    EXPECT_NEAR(r.maxOpenness, 0, 1e-15);
    EXPECT_NEAR(r.maxSkewness, 0, 1e-14);
    EXPECT_DOUBLE_EQ(r.minFaceFlatness, 1);
    EXPECT_EQ(r.minDeterminant, 0);
    EXPECT_EQ(r.statistics.hexahedra, 1);
    EXPECT_EQ(r.patches.at(0).topology, SurfaceTopology::closed);
    EXPECT_EQ(r.failedChecks, 1);
    EXPECT_THAT(idsOf(r, "underdeterminedCells"), ElementsAre(0));
    EXPECT_THAT(idsOf(r, "oneInternalFaceCells"), ElementsAre(0));
}

// Weight and volume ratio of a face between cells of height 1 and 3 follow from the heights.
TEST(MeasureQuality, UnequalNeighbours) {
    const QualityReport r = measureQuality(columnOf({square(0), square(1), square(4)}));
    EXPECT_DOUBLE_EQ(r.minFaceWeight, 0.25);
    EXPECT_DOUBLE_EQ(r.minVolumeRatio, 1.0 / 3);
    EXPECT_NEAR(r.maxNonOrthogonality, 0, 1e-6);
    EXPECT_DOUBLE_EQ(r.maxAspectRatio, 3); // the tall cell's side areas over its end areas
    EXPECT_DOUBLE_EQ(r.totalVolume, 4);
}

// Shearing a column by one cell per height leaves the faces horizontal and leans the line between centres by
// 45 degrees; that line still meets the face's centre.
TEST(MeasureQuality, ShearedColumn) {
    const QualityReport r = measureQuality(columnOf({square(0), square(1, {1, 0, 0}), square(2, {2, 0, 0})}));
    EXPECT_NEAR(r.maxNonOrthogonality, 45, 1e-12);
    EXPECT_NEAR(r.meanNonOrthogonality, 45, 1e-12);
    EXPECT_EQ(r.severeNonOrthogonalFaces, 0);
    EXPECT_DOUBLE_EQ(r.totalVolume, 2);
}

// Over 70 degrees a face is severely non-orthogonal but no failed check.
TEST(MeasureQuality, SevereNonOrthogonalityOnlyWarns) {
    const QualityReport r = measureQuality(columnOf({square(0), square(1, {4, 0, 0}), square(2, {8, 0, 0})}));
    EXPECT_NEAR(r.maxNonOrthogonality, std::atan(4.0) * 180 / std::numbers::pi, 1e-12);
    EXPECT_EQ(r.severeNonOrthogonalFaces, 1);
    ASSERT_NE(findCheck(r, "nonOrthoFaces"), nullptr);
    EXPECT_FALSE(findCheck(r, "nonOrthoFaces")->fails);
    EXPECT_EQ(findCheck(r, "nonOrthoFaces")->worst, (Vec3{4.5, 0.5, 1}));
}

// Skewness is how far the line between the centres misses the face's centre, over the face's extent that way;
// on the boundary the line runs along the normal.
TEST(MeasureQuality, SkewFace) {
    // The upper cell leans by 2 over its height: the line meets the middle face 0.5 off, the normal the lid 1
    // off. The faces reach 0.5 to either side.
    const QualityReport r = measureQuality(columnOf({square(0), square(1), square(2, {2, 0, 0})}));
    EXPECT_NEAR(r.maxSkewness, 2, 1e-12);
    EXPECT_EQ(r.highlySkewFaces, 0);
    // Under a second, upright cell the lid is internal: its line misses by 0.5 as well.
    const QualityReport s =
        measureQuality(columnOf({square(0), square(1), square(2, {2, 0, 0}), square(3, {2, 0, 0})}));
    EXPECT_NEAR(s.maxSkewness, 1, 1e-12);
}

// A top pulled below the bottom: one negative volume, faces that point the wrong way, and a line between
// centres that runs against its face.
TEST(MeasureQuality, NegativeCell) {
    const QualityReport r = measureQuality(columnOf({square(0), square(1), square(-1)}));
    EXPECT_EQ(r.negativeVolumeCells, 1);
    EXPECT_DOUBLE_EQ(r.minVolume, -2);
    EXPECT_THAT(idsOf(r, "zeroVolumeCells"), ElementsAre(1));
    EXPECT_EQ(r.nonOrthogonalityErrors, 1);
    EXPECT_GT(r.wrongOrientedFaces, 0);
    EXPECT_GT(r.tetErrors, 0);
    EXPECT_FALSE(r.ok());
}

// Shapes are told by their faces: a prism, a pyramid and a tetrahedron with their volumes.
TEST(MeasureQuality, ShapesWithTriangles) {
    const std::vector<Vec3> points{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}};
    const QualityReport prism = measureQuality(
        meshOfCells(points, {{{0, 2, 1}, {3, 4, 5}, {0, 1, 4, 3}, {1, 2, 5, 4}, {2, 0, 3, 5}}}));
    EXPECT_EQ(prism.statistics.prisms, 1);
    EXPECT_NEAR(prism.totalVolume, 0.5, 1e-15);
    const std::vector<Vec3> tip{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5, 0.5, 3}};
    const QualityReport pyramid =
        measureQuality(meshOfCells(tip, {{{0, 3, 2, 1}, {0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}}}));
    EXPECT_EQ(pyramid.statistics.pyramids, 1);
    EXPECT_NEAR(pyramid.totalVolume, 1, 1e-15);
    const std::vector<Vec3> four{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    const QualityReport tet =
        measureQuality(meshOfCells(four, {{{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}}));
    EXPECT_EQ(tet.statistics.tetrahedra, 1);
    EXPECT_NEAR(tet.totalVolume, 1.0 / 6, 1e-15);
    EXPECT_TRUE(findCheck(tet, "oneInternalFaceCells") != nullptr);
}

// At a jump in level the large cell is a polyhedron of nine faces, closed edge by edge thanks to the hanging
// nodes in its neighbours' polygons. Its four coplanar faces make it concave by checkMesh's rule.
TEST(MeasureQuality, HangingNodes) {
    const PolyMesh mesh = levelJump();
    ASSERT_EQ(mesh.validate(), "");
    const QualityReport r = measureQuality(mesh);
    EXPECT_EQ(r.statistics.hexahedra, 4);
    EXPECT_THAT(r.statistics.polyhedraByFaces, ElementsAre(Pair(9, 1)));
    EXPECT_NEAR(r.totalVolume, 12, 1e-14);
    EXPECT_EQ(r.openCellsByEdges, 0);
    EXPECT_THAT(idsOf(r, "concaveCells"), ElementsAre(0));
    EXPECT_EQ(r.concaveFaces, 0);
    EXPECT_EQ(r.nonConsecutiveFaces, 0);
    EXPECT_EQ(r.patches.at(0).topology, SurfaceTopology::closed);
    // The line from the large centre to a small one against the face normal x: offset 0.5 in y and z, 1.5 in
    // x.
    EXPECT_NEAR(r.maxNonOrthogonality, std::atan(std::sqrt(0.5) / 1.5) * 180 / std::numbers::pi, 1e-12);
}

// A cell without its lid: open by its edges and by its areas; so is the boundary.
TEST(MeasureQuality, OpenCell) {
    CellLoops open = hexLoops(corners(0));
    open.erase(open.begin() + 1);
    const QualityReport r = measureQuality(meshOfCells(boxPoints({0, 0, 0}, {1, 1, 1}), {open}));
    EXPECT_EQ(r.openCellsByEdges, 1);
    EXPECT_THAT(idsOf(r, "zipUpCells"), ElementsAre(0));
    EXPECT_EQ(r.openCells, 1);
    EXPECT_DOUBLE_EQ(r.maxOpenness, 1);
    EXPECT_DOUBLE_EQ(r.boundaryOpenness.z, -0.2);
    EXPECT_EQ(r.patches.at(0).topology, SurfaceTopology::open);
}

// Two cubes that touch at a corner are two regions joined by one point, and their common boundary is pinched
// there.
TEST(MeasureQuality, CubesAtACorner) {
    const QualityReport r = measureQuality(cubesAtCorner());
    ASSERT_EQ(r.regions.size(), 2U);
    EXPECT_TRUE(r.regions[0].pointConnected);
    EXPECT_THAT(idsOf(r, "multiRegionPoints"), ElementsAre(6));
    EXPECT_THAT(idsOf(r, "nonManifoldPoints"), ElementsAre(6));
    EXPECT_EQ(r.patches.at(0).topology, SurfaceTopology::sharedPoint);
}

// Two cubes that share an edge only: that edge has four boundary faces.
TEST(MeasureQuality, CubesAtAnEdge) {
    const QualityReport r = measureQuality(cubesAtEdge());
    EXPECT_EQ(r.patches.at(0).topology, SurfaceTopology::sharedEdge);
    EXPECT_THAT(idsOf(r, "nonManifoldPoints"), ElementsAre(2, 6));
}

// Two separate cubes with coincident faces on shared points: the pair is a baffle, and the edge check says
// which.
TEST(MeasureQuality, BaffleFaces) {
    const PolyMesh mesh = cubesWithBaffle();
    const QualityReport r = measureQuality(mesh);
    EXPECT_EQ(r.baffleFaces, 1);
    EXPECT_EQ(r.duplicateFaces, 0);
    EXPECT_THAT(idsOf(r, "edgeFaces"), ElementsAre(0, mesh.faces() - 1));
    EXPECT_EQ(r.regions.size(), 2U);
}

// A face that turns in on itself at one corner, by the angle given there.
TEST(MeasureQuality, ConcaveFace) {
    std::array<Vec3, 4> dented = square(0), above = square(1);
    dented[2] = above[2] = {0.25, 0.25, 0};
    above[2].z = 1;
    const QualityReport r = measureQuality(columnOf({dented, above}));
    EXPECT_EQ(r.concaveFaces, 2);
    // The edges at the dent run (-0.75, 0.25) and (-0.25, 0.75): their cross product over their lengths.
    EXPECT_NEAR(r.maxConcaveAngle, std::asin(0.5 / 0.625) * 180 / std::numbers::pi, 1e-9);
    EXPECT_FALSE(findCheck(r, "concaveFaces")->fails);
}

// Points no face uses, and points so close that they are as good as one.
TEST(MeasureQuality, UnusedAndNearPoints) {
    PolyMesh mesh = columnOf({square(0), square(1)});
    mesh.points.push_back(mesh.points[0] + Vec3{0, 1e-9, 0});
    const QualityReport r = measureQuality(mesh);
    EXPECT_EQ(r.unusedPoints, 1);
    EXPECT_THAT(idsOf(r, "unusedPoints"), ElementsAre(8));
    EXPECT_THAT(idsOf(r, "nearPoints"), ElementsAre(0, 8));
    EXPECT_EQ(r.shortEdgePoints, 0);
}

// Two faces between the same two cells, and faces out of order, are told apart: only the latter fails.
TEST(MeasureQuality, FaceOrder) {
    PolyMesh mesh = columnOf({square(0), square(1), square(2), square(3)});
    std::swap(mesh.owner[0], mesh.owner[1]);
    std::swap(mesh.neighbour[0], mesh.neighbour[1]);
    std::swap_ranges(mesh.faceVertices.begin(), mesh.faceVertices.begin() + 4, mesh.faceVertices.begin() + 4);
    EXPECT_TRUE(measureQuality(mesh).upperTriangular); // one face per cell: cells see no disorder
    mesh = levelJump();
    EXPECT_TRUE(measureQuality(mesh).upperTriangular);
    std::swap(mesh.neighbour[0], mesh.neighbour[1]);
    std::swap_ranges(mesh.faceVertices.begin(), mesh.faceVertices.begin() + 4, mesh.faceVertices.begin() + 4);
    const QualityReport r = measureQuality(mesh);
    EXPECT_FALSE(r.upperTriangular);
    EXPECT_TRUE(findCheck(r, "upperTriangularFace")->fails);
}

// The text: one line per check with figure, limit, number, verdict and place, and the verdict in the last
// line.
TEST(MeasureQuality, Text) {
    QualityLimits limits;
    limits.determinant = 0; // cells with a single inner face have none
    const PolyMesh sheared = columnOf({square(0), square(1, {4, 0, 0}), square(2, {8, 0, 0})});
    const QualityReport r = measureQuality(sheared, limits);
    const std::string text = formatQuality(r);
    EXPECT_THAT(text, testing::ContainsRegex(
                          "non-orthogonality .degrees. +75.9638 +75.9638 +70 +1 faces +warns +.4.5 0.5 1."));
    EXPECT_THAT(text, testing::ContainsRegex("skewness +[0-9.]+ +4 +[-] +ok\n"));
    EXPECT_THAT(text, HasSubstr("2 hexahedra"));
    EXPECT_THAT(text, testing::EndsWith("\nall checks pass\n"));
    EXPECT_THAT(text, testing::Not(HasSubstr("FAILS")));
    const std::string failed = formatQuality(measureQuality(columnOf({square(0), square(1)})));
    EXPECT_THAT(failed, testing::ContainsRegex("determinant +0 +0 +0.001 +1 cells +FAILS +.0.5 0.5 0.5."));
    EXPECT_THAT(failed, testing::EndsWith("\n1 of 36 checks fail\n"));
}

// The report, to the last bit of text, does not depend on the number of threads; and the mesh is large enough
// for several blocks of every loop.
TEST(MeasureQuality, SameOnAnyNumberOfThreads) {
    std::vector<std::array<Vec3, 4>> levels;
    std::mt19937 random(7);
    std::uniform_real_distribution<double> jitter(-0.3, 0.3);
    for (int i = 0; i < 60000; ++i) {
        levels.push_back(square(i));
        for (Vec3& p : levels.back()) p += Vec3{jitter(random), jitter(random), jitter(random)};
    }
    const PolyMesh mesh = columnOf(levels);
    std::string first;
    for (const std::size_t threads : {1, 2, 3, 8}) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        const std::string text = formatQuality(measureQuality(mesh));
        if (first.empty()) first = text;
        EXPECT_EQ(text, first) << threads << " threads";
    }
    EXPECT_THAT(first, HasSubstr("59999 hexahedra"));
}

} // namespace
} // namespace i2b::test
