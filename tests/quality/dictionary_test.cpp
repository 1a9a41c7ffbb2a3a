// Proves: each limit of the mesh quality dictionary on a mesh of one to three cells whose figure follows by hand, with a
// limit just short of it and one just beyond; and that what is measured eight at a time is the same, to the last bit, as
// what is measured one by one.
#include "cell_mesh.h"
#include "i2b/quality/quality_report.h"
#include <cmath>
#include <gtest/gtest.h>
#include <random>

namespace i2b::test {
namespace {

constexpr DictionaryLimits off{180, -1e30, -1e30, 180, -1, -1, -1, -1, -1, -1, -1, -1, -1};

DictionaryCheck checkOf(const PolyMesh& mesh, const DictionaryLimits& limits, const char* key) {
    const QualityReport report = measureQuality(mesh, {}, limits);
    for (const DictionaryCheck& check : report.dictionary)
        if (check.key == key) return check;
    ADD_FAILURE() << key;
    return {};
}

// Faces beyond the limit where it is all that is asked for.
std::int64_t beyond(const PolyMesh& mesh, double DictionaryLimits::*limit, double value, const char* key) {
    DictionaryLimits limits = off;
    limits.*limit = value;
    const DictionaryCheck check = checkOf(mesh, limits, key);
    EXPECT_TRUE(check.asked) << key;
    EXPECT_EQ(check.faces, check.newFaces) << key;
    EXPECT_EQ(measureQuality(mesh, {}, limits).dictionaryFaces, check.faces) << key;
    return check.faces;
}

PolyMesh cube() { return columnOf({square(0), square(1)}); }
PolyMesh sheared() { return columnOf({square(0), square(1, {1, 0, 0}), square(2, {2, 0, 0})}); } // leans by 45 degrees

TEST(Dictionary, NothingAskedNothingFound) {
    const QualityReport report = measureQuality(columnOf({square(0), square(1), square(-1)}), {}, off);
    EXPECT_EQ(report.dictionaryFaces, 0);
    for (const DictionaryCheck& check : report.dictionary) EXPECT_FALSE(check.asked) << check.key;
}

TEST(Dictionary, NonOrthogonality) {
    EXPECT_EQ(beyond(sheared(), &DictionaryLimits::nonOrthogonality, 46, "maxNonOrtho"), 0);
    EXPECT_EQ(beyond(sheared(), &DictionaryLimits::nonOrthogonality, 44, "maxNonOrtho"), 1);
}

// The pyramids from a cube's centre to its faces are a sixth of it each.
TEST(Dictionary, PyramidVolume) {
    EXPECT_EQ(beyond(cube(), &DictionaryLimits::pyramidVolume, 0.166, "minVol"), 0);
    EXPECT_EQ(beyond(cube(), &DictionaryLimits::pyramidVolume, 0.167, "minVol"), 6);
}

// Half a side of the cube with its centre: volume 1/12 in a sphere of radius 3/4, where a regular tetrahedron has
// 8/(9 sqrt 3) radius^3. The quarter sides with the centre are better.
TEST(Dictionary, TetQuality) {
    const double quality = 1.0 / 12 / (8 / (9 * std::sqrt(3.0)) * 27 / 64);
    EXPECT_EQ(beyond(cube(), &DictionaryLimits::tetQuality, quality - 1e-9, "minTetQuality"), 0);
    EXPECT_EQ(beyond(cube(), &DictionaryLimits::tetQuality, quality + 1e-9, "minTetQuality"), 6);
    const PolyMesh flat = columnOf({square(0), square(1), square(1)}); // a cell of no height: none is over 0
    EXPECT_GT(beyond(flat, &DictionaryLimits::tetQuality, 1e-30, "minTetQuality"), 0);
    EXPECT_EQ(beyond(columnOf({square(0), square(-1)}), &DictionaryLimits::tetQuality, -1, "minTetQuality"), 0);
    EXPECT_EQ(beyond(columnOf({square(0), square(-1)}), &DictionaryLimits::tetQuality, -0.1, "minTetQuality"), 6);
}

// The edges at the dent run (-0.75, 0.25) and (-0.25, 0.75): 53.13 degrees between them.
TEST(Dictionary, Concavity) {
    std::array<Vec3, 4> dented = square(0), above = square(1);
    dented[2] = {0.25, 0.25, 0}, above[2] = {0.25, 0.25, 1};
    EXPECT_EQ(beyond(columnOf({dented, above}), &DictionaryLimits::concavity, 53, "maxConcave"), 2);
    EXPECT_EQ(beyond(columnOf({dented, above}), &DictionaryLimits::concavity, 53.2, "maxConcave"), 0);
}

TEST(Dictionary, FaceArea) {
    const PolyMesh column = columnOf({square(0), square(1), square(4)}); // three faces of 1, four each of 1 and 3
    EXPECT_EQ(beyond(column, &DictionaryLimits::faceArea, 0.99, "minArea"), 0);
    EXPECT_EQ(beyond(column, &DictionaryLimits::faceArea, 1.01, "minArea"), 7);
    EXPECT_EQ(beyond(column, &DictionaryLimits::faceArea, 3.01, "minArea"), 11);
}

// Inside, the line between the centres misses the face's by 0.5 of its 0.5; on the lid the normal misses by twice it.
TEST(Dictionary, Skewness) {
    const PolyMesh leaning = columnOf({square(0), square(1), square(2, {2, 0, 0})});
    DictionaryLimits limits = off;
    limits.internalSkewness = 0.99, limits.boundarySkewness = 2.01;
    EXPECT_EQ(checkOf(leaning, limits, "maxInternalSkewness").faces, 1);
    EXPECT_EQ(checkOf(leaning, limits, "maxBoundarySkewness").faces, 0);
    limits.internalSkewness = 1.01, limits.boundarySkewness = 1.99;
    EXPECT_EQ(checkOf(leaning, limits, "maxInternalSkewness").faces, 0);
    EXPECT_EQ(checkOf(leaning, limits, "maxBoundarySkewness").faces, 1);
}

TEST(Dictionary, WeightAndVolumeRatio) {
    const PolyMesh column = columnOf({square(0), square(1), square(4)});
    EXPECT_EQ(beyond(column, &DictionaryLimits::faceWeight, 0.249, "minFaceWeight"), 0);
    EXPECT_EQ(beyond(column, &DictionaryLimits::faceWeight, 0.251, "minFaceWeight"), 1);
    EXPECT_EQ(beyond(column, &DictionaryLimits::volumeRatio, 0.333, "minVolRatio"), 0);
    EXPECT_EQ(beyond(column, &DictionaryLimits::volumeRatio, 0.334, "minVolRatio"), 1);
}

// In the leaning column, lines from centre to centre and to the middles of all faces but the four upright ones are 45
// degrees off their normals.
TEST(Dictionary, Twist) {
    EXPECT_EQ(beyond(sheared(), &DictionaryLimits::twist, 0.707, "minTwist"), 0);
    EXPECT_EQ(beyond(sheared(), &DictionaryLimits::twist, 0.708, "minTwist"), 7);
}

// A lid with its corners up and down by turns, by the width of the cube: the normals of neighbouring triangles have
// (-1, 0, 1) and (0, 1, 1) for directions. No surface of triangles is smaller than the one they span.
TEST(Dictionary, TriangleTwistAndFlatness) {
    std::array<Vec3, 4> lid = square(3);
    lid[1].z = lid[3].z = 4;
    const PolyMesh mesh = columnOf({square(0), lid});
    EXPECT_EQ(beyond(mesh, &DictionaryLimits::triangleTwist, 0.499, "minTriangleTwist"), 0);
    EXPECT_EQ(beyond(mesh, &DictionaryLimits::triangleTwist, 0.501, "minTriangleTwist"), 1);
    EXPECT_EQ(beyond(mesh, &DictionaryLimits::flatness, 0.999, "minFaceFlatness"), 0);
}

// A box of 1 x 1 x 3: areas 6, 6 and 2 along the axes, 14 in all; a cube has a third of its areas along each.
TEST(Dictionary, Determinant) {
    const double value = 6.0 * 6 * 2 / (14.0 * 14 * 14) * 27;
    const PolyMesh column = columnOf({square(0), square(1), square(4)});
    EXPECT_EQ(beyond(column, &DictionaryLimits::determinant, value - 1e-6, "minDeterminant"), 0);
    EXPECT_EQ(beyond(column, &DictionaryLimits::determinant, value + 1e-6, "minDeterminant"), 6);
    DictionaryLimits limits = off;
    limits.determinant = value + 1e-6;
    EXPECT_EQ(checkOf(column, limits, "minDeterminant").cells, 1);
    EXPECT_EQ(checkOf(column, limits, "minDeterminant").worst, (Vec3{0.5, 0.5, 2.5}));
}

// A face beyond two limits is new to the first alone.
TEST(Dictionary, EachFaceIsNewOnce) {
    DictionaryLimits limits = off;
    limits.nonOrthogonality = 44, limits.twist = 0.708;
    EXPECT_EQ(checkOf(sheared(), limits, "maxNonOrtho").newFaces, 1);
    EXPECT_EQ(checkOf(sheared(), limits, "minTwist").faces, 7);
    EXPECT_EQ(checkOf(sheared(), limits, "minTwist").newFaces, 6);
    const QualityReport report = measureQuality(sheared(), {}, limits);
    EXPECT_EQ(report.dictionaryFaces, 7);
    EXPECT_EQ(report.dictionaryIds.size(), 7u);
    EXPECT_TRUE(std::ranges::is_sorted(report.dictionaryIds));
}

// Limits that every face and cell is beyond send all of them the long way.
TEST(Glance, SameAsOneByOne) {
    std::vector<std::array<Vec3, 4>> levels;
    std::mt19937 random(5);
    std::uniform_real_distribution<double> jitter(-0.1, 0.1);
    for (int i = 0; i < 5003; ++i) {
        levels.push_back(square(i));
        for (Vec3& p : levels.back()) p += Vec3{jitter(random), jitter(random), jitter(random)};
    }
    const PolyMesh mesh = columnOf(levels);
    QualityLimits nothingPasses;
    nothingPasses.flatness = 2, nothingPasses.determinant = 1e9;
    const QualityReport a = measureQuality(mesh), b = measureQuality(mesh, nothingPasses);
    EXPECT_EQ(a.warpedFaces, 0);
    EXPECT_EQ(b.warpedFaces, mesh.faces());
    EXPECT_EQ(b.smallDeterminantCells, mesh.cells);
    using Report = QualityReport;
    for (double Report::*value :
         {&Report::maxNonOrthogonality, &Report::meanNonOrthogonality, &Report::maxSkewness, &Report::maxAspectRatio,
          &Report::maxOpenness, &Report::minVolume, &Report::maxVolume, &Report::totalVolume, &Report::minFaceArea,
          &Report::maxFaceArea, &Report::minFaceWeight, &Report::meanFaceWeight, &Report::minVolumeRatio,
          &Report::meanVolumeRatio, &Report::minDeterminant, &Report::meanDeterminant, &Report::minFaceFlatness,
          &Report::meanFaceFlatness, &Report::minEdgeLength, &Report::maxEdgeLength, &Report::minFullness})
        EXPECT_EQ(a.*value, b.*value);
    EXPECT_EQ(a.flatnessFaces, b.flatnessFaces);
    EXPECT_EQ(a.concaveCells, b.concaveCells);
    EXPECT_EQ(a.dictionaryFaces, b.dictionaryFaces);
}

} // namespace
} // namespace i2b::test
