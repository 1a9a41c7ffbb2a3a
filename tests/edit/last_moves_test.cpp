// Proves: a point inside that makes faces poor beyond what merging and dividing help is moved back until none is, and nothing else moves.
#include "i2b/edit/last_moves.h"
#include "i2b/quality/quality_report.h"
#include "quality/shaken_block.h"
#include <gtest/gtest.h>

namespace i2b::test {
namespace {

TEST(LastMoves, BringBackSinglePoints) {
    std::mt19937 random;
    PolyMesh mesh = shakenBlock(6, 0, random);
    const PolyMesh whole = mesh;
    const auto stray = static_cast<std::size_t>((3 * 7 + 3) * 7 + 3);
    mesh.points[stray] = mesh.points[stray] + Vec3{1.6, 0.9, 0.8}; // through the cells beside it
    ASSERT_GT(measureQuality(mesh).dictionaryFaces, 2);
    std::vector<std::int32_t> poor;
    for (std::int32_t f = 0; f < mesh.internalFaces(); ++f)
        if (std::ranges::find(mesh.face(f), static_cast<std::int32_t>(stray)) != mesh.face(f).end()) poor.push_back(f);
    EXPECT_GT(moveLastPoints(mesh, buildCellFaces(mesh), poor, {}), 0);
    const QualityReport report = measureQuality(mesh);
    EXPECT_EQ(report.dictionaryFaces, 0);
    EXPECT_EQ(report.negativeVolumeCells + report.wrongOrientedFaces, 0);
    const int n = 7;
    for (std::size_t p = 0; p < mesh.points.size(); ++p) { // on the block's sides none moves
        const int x = int(p) / (n * n), y = int(p) / n % n, z = int(p) % n;
        if (x % 6 == 0 || y % 6 == 0 || z % 6 == 0) { EXPECT_EQ(mesh.points[p], whole.points[p]) << p; }
    }
}

TEST(LastMoves, LeaveAGoodMeshAsItIs) {
    std::mt19937 random;
    PolyMesh mesh = shakenBlock(4, 0.1, random);
    const std::uint64_t before = mesh.checksum();
    EXPECT_EQ(moveLastPoints(mesh, buildCellFaces(mesh), {}, {}), 0);
    EXPECT_EQ(moveLastPoints(mesh, buildCellFaces(mesh), {1, 2, 3}, {}), 0);
    EXPECT_EQ(mesh.checksum(), before);
}

} // namespace
} // namespace i2b::test
