// Proves: where faces are beyond the limits, dividing and uniting leaves a valid mesh with fewer of them, nothing worse and the
// same points; those that nothing would help are told without a change; two changes help where none does alone; a mesh without any stays as it is; layers of asked heights are united
// within their column only, many cells only where flat ones lie on each other; the same on any number of threads.
#include "i2b/edit/last_resort.h"
#include "i2b/edit/changer.h"
#include "i2b/quality/mesh_faults.h"
#include "i2b/quality/quality_report.h"
#include "quality/shaken_block.h"
#include <gtest/gtest.h>
#include <numeric>
#include <tbb/global_control.h>

namespace i2b::test {
namespace {

using Index = std::size_t;

PolyMesh shaken(unsigned seed, double shake = 0.55) {
    std::mt19937 random(seed);
    return shakenBlock(8, shake, random);
}

std::vector<std::int32_t> poorFaces(const PolyMesh& mesh) {
    const Rows cellFaces = buildCellFaces(mesh);
    return MeshFaults(mesh, cellFaces, {}).poorFaces();
}

class ShakenBlocks : public testing::TestWithParam<unsigned> {};

TEST_P(ShakenBlocks, HaveFewerFacesBeyondTheLimits) {
    const PolyMesh before = shaken(GetParam());
    const QualityReport old = measureQuality(before);
    ASSERT_GT(old.dictionaryFaces, 10);
    PolyMesh mesh = before;
    const LastResort done = changePoorPlaces(mesh, buildCellFaces(mesh), poorFaces(mesh), {});
    EXPECT_EQ(mesh.validate(), "");
    EXPECT_EQ(mesh.points, before.points);
    EXPECT_EQ(mesh.cells, before.cells - done.changes.merged);
    EXPECT_GT(done.changes.merged, 0);
    EXPECT_GT(done.changes.divided, 0);
    const QualityReport now = measureQuality(mesh);
    EXPECT_LT(now.dictionaryFaces, 0.8 * static_cast<double>(old.dictionaryFaces));
    for (Index i = 0; i < now.dictionary.size(); ++i) EXPECT_LE(now.dictionary[i].faces, old.dictionary[i].faces) << now.dictionary[i].key;
    EXPECT_LE(now.negativeVolumeCells, old.negativeVolumeCells);
    EXPECT_LE(now.wrongOrientedFaces, old.wrongOrientedFaces);
    EXPECT_LE(now.smallDeterminantCells, old.smallDeterminantCells);
    EXPECT_LE(now.tetErrors, old.tetErrors);
    EXPECT_NEAR(now.totalVolume, old.totalVolume, 0.01 * old.totalVolume); // divided faces of the boundary
    EXPECT_EQ(done.changes.places.size(), std::size_t(done.changes.merged + done.changes.divided));
    ASSERT_EQ(done.cellOf.size(), Index(before.cells));
    for (Index c = 0; c < done.cellOf.size(); ++c) EXPECT_LE(done.cellOf[c], static_cast<std::int32_t>(c));
}

INSTANTIATE_TEST_SUITE_P(Seeds, ShakenBlocks, testing::Range(1u, 9u));

TEST_P(ShakenBlocks, FacesBeyondHelpAreThoseThatStayPoor) {
    PolyMesh mesh = shaken(GetParam());
    const Rows cellFaces = buildCellFaces(mesh);
    const std::vector<std::int32_t> poor = MeshFaults(mesh, cellFaces, {}).undividedFaces();
    const std::uint64_t sum = mesh.checksum();
    const std::vector<std::int32_t> left = facesBeyondHelp(mesh, cellFaces, poor, {});
    EXPECT_EQ(mesh.checksum(), sum);
    EXPECT_TRUE(std::ranges::includes(poor, left));
    EXPECT_LT(left.size(), poor.size());
}

// Limits that nothing breaks leave none but those that checkMesh finds too skew; here are none.
TEST(LastResort, LimitsThatNothingBreaksLeaveNone) {
    const PolyMesh mesh = shaken(1, 0.4);
    ASSERT_EQ(measureQuality(mesh).highlySkewFaces, 0);
    const std::vector<std::int32_t> poor = poorFaces(mesh);
    const Rows cellFaces = buildCellFaces(mesh);
    ASSERT_FALSE(facesBeyondHelp(mesh, cellFaces, poor, {}).empty());
    DictionaryLimits none;
    none.nonOrthogonality = 180, none.pyramidVolume = none.tetQuality = -1e30, none.concavity = 180, none.internalSkewness = none.boundarySkewness = -1;
    none.faceWeight = none.volumeRatio = none.twist = none.determinant = -1;
    EXPECT_TRUE(facesBeyondHelp(mesh, cellFaces, poor, none).empty());
}

// A pair is found only for a face that no change helps alone, and leaves fewer faces beyond the limits in the whole mesh, nothing worse.
TEST(LastResort, PairsHelpWhereNoChangeHelpsAlone) {
    int found = 0;
    for (unsigned seed = 1; seed < 5; ++seed) {
        const PolyMesh before = shaken(seed, 0.45);
        const Verdict old = judge({before, {}, {}}, {});
        const Rows cellFaces = buildCellFaces(before);
        for (const std::int32_t face : poorFaces(before)) {
            LocalEdits edits(before, cellFaces);
            if (Changer(before, edits, {}, before.cells).find(face)) continue;
            const auto pair = findPair(before, face, {}, before.cells, edits);
            if (!pair) continue;
            ++found;
            for (const LocalEdits::Trial& change : *pair) apply(change, edits);
            PolyMesh mesh = before;
            editMesh(mesh, edits.edits());
            ASSERT_EQ(mesh.validate(), "");
            EXPECT_TRUE(isBetter(judge({mesh, {}, {}}, {}), old)) << "seed " << seed << " face " << face;
        }
    }
    EXPECT_GT(found, 3);
}

TEST(LastResort, LeavesGoodMeshesAlone) {
    const PolyMesh before = shaken(1, 0.05);
    PolyMesh mesh = before;
    std::vector<std::int32_t> all(Index(mesh.faces()));
    std::iota(all.begin(), all.end(), 0);
    const LastResort done = changePoorPlaces(mesh, buildCellFaces(mesh), all, {});
    EXPECT_EQ(done.changes.merged + done.changes.divided, 0);
    EXPECT_TRUE(done.cellOf.empty());
    EXPECT_EQ(mesh.checksum(), before.checksum());
}

// 180 degrees: not asked. No face is looked at for its corners then.
TEST(LastResort, LooksForNoConcaveFacesUnasked) {
    PolyMesh mesh = shaken(5);
    DictionaryLimits limits;
    limits.concavity = 180;
    const LastResort done = changePoorPlaces(mesh, buildCellFaces(mesh), {}, limits);
    EXPECT_EQ(done.changes.merged + done.changes.divided, 0);
    EXPECT_EQ(mesh.checksum(), shaken(5).checksum());
}

// A block of layers a 25th as high as wide: little room between two faces much larger than the others, one over the other.
PolyMesh shakenLayers(unsigned seed) {
    PolyMesh mesh = shaken(seed);
    for (Vec3& p : mesh.points) p.z *= 0.04;
    return mesh;
}

// Per cell the lowest of those under and over it.
std::vector<std::int32_t> columnsOf(const PolyMesh& mesh) {
    std::vector<std::int32_t> column(Index(mesh.cells));
    std::iota(column.begin(), column.end(), 0);
    for (std::int32_t f = 0; f < mesh.internalFaces(); ++f) { // owners ascend, and come before neighbours
        const Vec3 area = measureFace(mesh, f).area;
        if (std::abs(area.z) > 0.5 * norm(area)) column[Index(mesh.neighbour[Index(f)])] = column[Index(mesh.owner[Index(f)])];
    }
    return column;
}

// The cells that have become one, for each that has.
std::vector<std::vector<std::int32_t>> unitedCells(const LastResort& done, const PolyMesh& mesh) {
    std::vector<std::vector<std::int32_t>> cells(Index(mesh.cells));
    for (Index c = 0; c < done.cellOf.size(); ++c) cells[Index(done.cellOf[c])].push_back(static_cast<std::int32_t>(c));
    std::erase_if(cells, [](const auto& of) { return of.size() < 2; });
    return cells;
}

bool areOfOneColumn(const std::vector<std::int32_t>& cells, const std::vector<std::int32_t>& column) {
    return std::ranges::all_of(cells, [&](std::int32_t c) { return column[Index(c)] == column[Index(cells.front())]; });
}

TEST(LastResort, UnitesLayersOfOneColumnOnly) {
    PolyMesh mesh = shakenLayers(2);
    const std::vector<std::int32_t> column = columnsOf(mesh);
    const LastResort done = changePoorPlaces(mesh, buildCellFaces(mesh), poorFaces(mesh), {}, 0);
    ASSERT_GT(done.changes.merged, 0);
    EXPECT_EQ(mesh.validate(), "");
    for (const auto& cells : unitedCells(done, mesh)) EXPECT_TRUE(areOfOneColumn(cells, column)) << cells.front();
}

// The most cells of a column of eight that may be united one after the other, cells that high and one wide; -1 where a stack
// of more than four may be united with one beside it.
int mostOfColumn(double height) {
    PolyMesh mesh = shaken(1, 0);
    for (Vec3& p : mesh.points) p.z *= height;
    const Rows cellFaces = buildCellFaces(mesh);
    LocalEdits edits(mesh, cellFaces);
    const Changer changer(mesh, edits, {}, mesh.cells);
    int most = 1;
    for (std::int32_t next = 1; next < 8; ++next, ++most) { // cells 0 to 7 lie on each other
        const auto between = std::ranges::find_if(cellFaces[next], [&](std::int32_t f) { return edits.across(f, next) == 0; });
        bool mayOn = false;
        for (const LocalEdits::Trial& trial : changer.all(*between)) {
            const bool isBeside = trial.united && trial.groups.front() == 0 && trial.groups.back() >= 8;
            if (most > 4 && isBeside) return -1;
            mayOn = mayOn || (trial.united && trial.groups == std::vector<std::int32_t>{0, next});
        }
        if (!mayOn) break;
        edits.unite(0, next);
    }
    return most;
}

// More than four cells become one only where flat ones lie on each other, no higher together than wide.
TEST(LastResort, UnitesManyCellsOnlyOfFlatStacks) {
    EXPECT_EQ(mostOfColumn(1), 4);
    EXPECT_EQ(mostOfColumn(0.23), 4);
    EXPECT_EQ(mostOfColumn(0.19), 5);
    EXPECT_EQ(mostOfColumn(0.15), 6);
    EXPECT_EQ(mostOfColumn(0.1), 8);
}

TEST(LastResort, UnitesNoRegions) {
    PolyMesh mesh = shaken(2);
    for (std::int32_t c = 0; c < mesh.cells; ++c) mesh.cellRegion.push_back(c);
    EXPECT_EQ(changePoorPlaces(mesh, buildCellFaces(mesh), poorFaces(mesh), {}).changes.merged, 0);
}

TEST(LastResort, SameOnAnyNumberOfThreads) {
    std::uint64_t sum = 0;
    for (const std::size_t threads : {1u, 2u, 3u}) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        PolyMesh mesh = shaken(5);
        EXPECT_GT(changePoorPlaces(mesh, buildCellFaces(mesh), poorFaces(mesh), {}).changes.merged, 0);
        if (threads == 1) sum = mesh.checksum();
        EXPECT_EQ(mesh.checksum(), sum) << threads << " threads";
    }
}

} // namespace
} // namespace i2b::test
