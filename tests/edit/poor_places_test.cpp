// Proves: flat cells are named by their faces where they are few, up to one in a thousand of all, and not where their height asks for it.
#include "i2b/edit/poor_places.h"
#include "quality/shaken_block.h"
#include <algorithm>
#include <gtest/gtest.h>
#include <optional>

namespace i2b::test {
namespace {

constexpr double limit = 0.001; // of the determinant

// n x n x n cubes, of which those at one side in a patch of a x b are flat.
PolyMesh blockWithFlat(int n, int a, int b) {
    std::mt19937 random(1);
    PolyMesh mesh = shakenBlock(n, 0, random);
    double top = 0, side = 0;
    for (const Vec3& p : mesh.points) top = std::max(top, p.z);
    side = top / n;
    for (Vec3& p : mesh.points)
        if (p.z > top - side / 2 && p.x < (a + 0.5) * side && p.y < (b + 0.5) * side) p.z = top - 0.9999 * side;
    return mesh;
}

std::optional<std::vector<std::int32_t>> flatFaces(const PolyMesh& mesh, std::int32_t thinFrom = 0) {
    return facesOfFlatCells(mesh, buildCellFaces(mesh), thinFrom, limit);
}

TEST(FlatCells, AreNamedByTheirFacesWhereTheyAreFew) {
    const PolyMesh mesh = blockWithFlat(8, 3, 2);
    const std::vector<std::int32_t> faces = flatFaces(mesh).value();
    EXPECT_EQ(faces.size(), 6u * 2 + 4 * 2 + 3 * 3); // tops and bottoms, sides along both axes
    EXPECT_TRUE(std::ranges::is_sorted(faces));
    EXPECT_TRUE(flatFaces(mesh, mesh.cells).value().empty()); // none of them thin
}

TEST(FlatCells, AreNotNamedWhereTheirHeightAsksForIt) {
    EXPECT_TRUE(flatFaces(blockWithFlat(16, 14, 14)));  // 196
    EXPECT_FALSE(flatFaces(blockWithFlat(16, 15, 14))); // 210
}

TEST(FlatCells, CountUpToOneInAThousand) {
    EXPECT_TRUE(flatFaces(blockWithFlat(60, 15, 14)));  // 210 of 216,000
    EXPECT_FALSE(flatFaces(blockWithFlat(60, 15, 15))); // 225
}

} // namespace
} // namespace i2b::test
