// Proves: points of a wall are made one where that leaves a surface, and refused where it would not; cells around them are judged as
// they would be; and the mesh written is closed, without the faces and points that are gone.
#include "i2b/quality/rim_star.h"
#include "i2b/quality/quality_report.h"
#include "quality/shaken_block.h"
#include <algorithm>
#include <gtest/gtest.h>

namespace i2b::test {
namespace {

// 4 x 4 x 4 cubes, their top (z = 4) a wall, the other sides none.
PolyMesh blockWithWall() {
    std::mt19937 random;
    PolyMesh mesh = shakenBlock(4, 0, random);
    struct Face { std::vector<std::int32_t> loop; std::int32_t owner; bool isTop; };
    std::vector<Face> faces;
    for (std::int32_t f = mesh.internalFaces(); f < mesh.faces(); ++f) {
        const auto v = mesh.face(f);
        faces.push_back({{v.begin(), v.end()}, mesh.owner[std::size_t(f)], std::ranges::all_of(v, [&](std::int32_t p) { return mesh.points[std::size_t(p)].z == 4; })});
    }
    std::ranges::stable_partition(faces, [](const Face& f) { return !f.isTop; });
    auto f = std::size_t(mesh.internalFaces());
    std::size_t at = mesh.faceOffsets[f];
    std::int32_t tops = 0;
    for (const Face& face : faces) {
        std::ranges::copy(face.loop, mesh.faceVertices.begin() + std::ptrdiff_t(at));
        at += face.loop.size(), tops += face.isTop;
        mesh.owner[f] = face.owner;
        mesh.faceOffsets[++f] = std::uint32_t(at);
    }
    mesh.patches = {{"rest", "patch", mesh.internalFaces(), mesh.faces() - mesh.internalFaces() - tops}, {"wall", "wall", mesh.faces() - tops, tops}};
    return mesh;
}

std::int32_t at(int x, int y, int z) { return (x * 5 + y) * 5 + z; }

// The middle of the edge from (x, 1) to (x, 2) on the wall, where its ends are to meet.
RimMove across(int x) { return {at(x, 1, 4), at(x, 2, 4), {double(x), 1.5, 4}}; }

struct Joined {
    PolyMesh mesh = blockWithWall();
    Rows cellFaces = buildCellFaces(mesh);
    RimStar star{mesh, cellFaces};

    std::int32_t cellBelow(std::int32_t point) const {
        std::int32_t f = mesh.patches[1].start;
        while (std::ranges::find(mesh.face(f), point) == mesh.face(f).end()) ++f;
        return mesh.owner[std::size_t(f)];
    }
    std::vector<std::int32_t> cells(const RimMove& move) const { return star.cellsAt(move.keep, move.gone, cellBelow(move.keep)); }
};

TEST(RimStar, TakesTheCellsOfBothPoints) {
    Joined j;
    EXPECT_EQ(j.mesh.validate(), "");
    EXPECT_EQ(j.cells(across(2)).size(), 6u);
    EXPECT_EQ(j.star.wallFaces(j.cells(across(2))).size(), 6u);
}

TEST(RimStar, JoinsAcrossFacesUntilTheyAreGone) {
    Joined j;
    const std::int32_t cell = [&] { // over the face between x = 1 and 2, y = 1 and 2
        const std::vector<std::int32_t> a = j.cells({at(1, 1, 4), -1, {}}), b = j.cells({at(2, 2, 4), -1, {}});
        std::vector<std::int32_t> both;
        std::ranges::set_intersection(a, b, std::back_inserter(both));
        return both.at(0);
    }();
    const std::int32_t faces = j.mesh.faces(), walls = j.mesh.patches[1].count;
    for (const int x : {1, 2}) {
        const RimMove move = across(x);
        ASSERT_TRUE(j.star.mayJoin(move, j.cells(move))) << x;
        EXPECT_TRUE(j.star.isNoWorse(move, j.cells(move), {})) << x;
        j.star.apply(move);
        EXPECT_TRUE(j.star.isGone(move.gone));
    }
    const std::vector<std::int32_t> lost = j.star.rewrite();
    EXPECT_EQ(lost, std::vector<std::int32_t>{cell});
    EXPECT_EQ(j.mesh.validate(), "");
    EXPECT_EQ(j.mesh.faces(), faces - 1);
    EXPECT_EQ(j.mesh.patches[1].count, walls - 1);
    EXPECT_EQ(j.mesh.points.size(), 123u);
    const QualityReport quality = measureQuality(j.mesh);
    EXPECT_EQ(quality.negativeVolumeCells + quality.openCells + quality.wrongOrientedFaces, 0);
    EXPECT_NEAR(quality.totalVolume, 64, 1e-12);
}

TEST(RimStar, RefusesWhatLeavesNoSurface) {
    Joined j;
    const auto mayJoin = [&](std::int32_t a, std::int32_t b) {
        const RimMove move{a, b, {}};
        return j.star.mayJoin(move, j.cells(move));
    };
    EXPECT_FALSE(mayJoin(at(1, 1, 4), at(2, 2, 4))); // across a face, not along an edge
    EXPECT_FALSE(mayJoin(at(0, 1, 4), at(1, 1, 4))); // one is in a side of the domain
    EXPECT_TRUE(mayJoin(at(1, 1, 4), at(1, 2, 4)));
    j.star.apply({at(1, 1, 4), at(2, 1, 4), {1.5, 1, 4}});
    EXPECT_TRUE(mayJoin(at(1, 1, 4), at(2, 2, 4))); // along an edge now
}

TEST(RimStar, NoticesWhatIsWorseAndTakesBack) {
    Joined j;
    const RimMove through{at(2, 1, 4), at(2, 2, 4), {2, 1.5, 2.5}}; // below the next layer of points: cells turn inside out
    EXPECT_TRUE(j.star.mayJoin(through, j.cells(through)));
    EXPECT_FALSE(j.star.isNoWorse(through, j.cells(through), {}));
    const std::uint64_t before = j.mesh.checksum();
    j.star.apply(through);
    j.star.takeBack(through);
    EXPECT_TRUE(j.star.rewrite().empty());
    EXPECT_EQ(j.mesh.checksum(), before);
}

} // namespace
} // namespace i2b::test
