// Proves: points of a wall are made one where that leaves a surface, and refused where it would not; cells around them are judged as
// they would be; and the mesh written is closed, without the faces and points that are gone.
#include "i2b/edit/zip_star.h"
#include "i2b/assemble/edit_mesh.h"
#include "i2b/edit/shape_zip.h"
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
PointMove across(int x) { return {at(x, 1, 4), at(x, 2, 4), {double(x), 1.5, 4}}; }

struct Joined {
    PolyMesh mesh = blockWithWall();
    Rows cellFaces = buildCellFaces(mesh);
    ZipStar star{mesh, cellFaces};

    std::int32_t cellBelow(std::int32_t point) const {
        std::int32_t f = mesh.patches[1].start;
        while (std::ranges::find(mesh.face(f), point) == mesh.face(f).end()) ++f;
        return mesh.owner[std::size_t(f)];
    }
    std::vector<std::int32_t> cells(const PointMove& move) const { return star.cellsAt(move.keep, move.gone, cellBelow(move.keep)); }
};

// The block with so many points, its cells closed and outside in nowhere.
void expectWhole(const PolyMesh& mesh, std::size_t points) {
    EXPECT_EQ(mesh.validate(), "");
    EXPECT_EQ(mesh.points.size(), points);
    const QualityReport quality = measureQuality(mesh);
    EXPECT_EQ(quality.negativeVolumeCells + quality.openCells + quality.wrongOrientedFaces, 0);
    EXPECT_NEAR(quality.totalVolume, 64, 1e-12);
}

TEST(ZipStar, TakesTheCellsOfBothPoints) {
    Joined j;
    EXPECT_EQ(j.mesh.validate(), "");
    EXPECT_EQ(j.cells(across(2)).size(), 6u);
    EXPECT_EQ(j.star.wallFaces(j.cells(across(2))).size(), 6u);
}

TEST(ZipStar, JoinsAcrossFacesUntilTheyAreGone) {
    Joined j;
    const std::int32_t cell = [&] { // over the face between x = 1 and 2, y = 1 and 2
        const std::vector<std::int32_t> a = j.cells({at(1, 1, 4), -1, {}}), b = j.cells({at(2, 2, 4), -1, {}});
        std::vector<std::int32_t> both;
        std::ranges::set_intersection(a, b, std::back_inserter(both));
        return both.at(0);
    }();
    const std::int32_t faces = j.mesh.faces(), walls = j.mesh.patches[1].count;
    for (const int x : {1, 2}) {
        const PointMove move = across(x);
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
    expectWhole(j.mesh, 123);
}

TEST(ZipStar, RefusesWhatLeavesNoSurface) {
    Joined j;
    const auto mayJoin = [&](std::int32_t a, std::int32_t b) {
        const PointMove move{a, b, {}};
        return j.star.mayJoin(move, j.cells(move));
    };
    EXPECT_FALSE(mayJoin(at(1, 1, 4), at(2, 2, 4))); // across a face, not along an edge
    EXPECT_FALSE(mayJoin(at(0, 1, 4), at(1, 1, 4))); // one is in a side of the domain
    EXPECT_TRUE(mayJoin(at(1, 1, 4), at(1, 2, 4)));
    j.star.apply({at(1, 1, 4), at(2, 1, 4), {1.5, 1, 4}});
    EXPECT_TRUE(mayJoin(at(1, 1, 4), at(2, 2, 4))); // along an edge now
}

TEST(ZipStar, NoticesWhatIsWorse) {
    Joined j;
    const PointMove through{at(2, 1, 4), at(2, 2, 4), {2, 1.5, 2.5}}; // below the next layer of points: cells turn inside out
    EXPECT_TRUE(j.star.mayJoin(through, j.cells(through)));
    EXPECT_FALSE(j.star.isNoWorse(through, j.cells(through), {}));
}

// The two faces between x = 1 and 3, y = 1 and 2, onto the line y = 1.5: their ends meet, the nodes between stay two, and the cells below
// become one.
Zip zipOfTwo(const Joined& j) {
    Zip zip;
    zip.moves = {across(1), across(3), {at(2, 1, 4), -1, {1.8, 1.5, 4}}, {at(2, 2, 4), -1, {2.2, 1.5, 4}}};
    const auto uses = [&](std::int32_t f, std::int32_t p) { return std::ranges::find(j.mesh.face(f), p) != j.mesh.face(f).end(); };
    std::vector<std::int32_t> cells;
    for (std::int32_t f = j.mesh.patches[1].start; f < j.mesh.faces(); ++f) {
        if (!uses(f, at(2, 1, 4)) || !uses(f, at(2, 2, 4))) continue;
        zip.gone.push_back(f);
        cells.push_back(j.mesh.owner[std::size_t(f)]);
    }
    for (const std::int32_t c : cells) zip.cells.emplace_back(c, std::ranges::min(cells));
    zip.through = {{edgeKey(at(2, 1, 4), at(3, 1, 4)), {at(2, 2, 4)}}, {edgeKey(at(1, 2, 4), at(2, 2, 4)), {at(2, 1, 4)}}};
    for (const PointMove& move : zip.moves) {
        const auto around = j.cells(move);
        zip.star.insert(zip.star.end(), around.begin(), around.end());
    }
    std::ranges::sort(zip.star);
    zip.star.erase(std::ranges::unique(zip.star).begin(), zip.star.end());
    return zip;
}

TEST(ZipStar, ZipsTwoFacesToOneWedge) {
    Joined j;
    const Zip zip = zipOfTwo(j);
    ASSERT_EQ(zip.gone.size(), 2u);
    const Verdict before = j.star.before(zip, {});
    j.star.use({zip}, {});
    EXPECT_TRUE(j.star.isSound(zip));
    EXPECT_TRUE(j.star.isNoWorse(zip, before, {}));
    std::vector<std::int32_t> loop; // of the face beside the strip: led through the other row's node
    for (std::int32_t f = j.mesh.patches[1].start; f < j.mesh.faces(); ++f) {
        const auto v = j.mesh.face(f);
        if (std::ranges::find(v, at(2, 0, 4)) == v.end() || std::ranges::find(v, at(3, 0, 4)) == v.end()) continue;
        j.star.loopOf(f, {}, loop);
        EXPECT_EQ(loop.size(), 5u);
    }
    const std::int32_t walls = j.mesh.patches[1].count, cells = j.mesh.cells;
    EXPECT_EQ(j.star.rewrite().size(), 2u);
    MeshEdits edits;
    for (std::int32_t c = 0; c < cells; ++c) edits.groups.push_back(j.star.united().contains(c) ? j.star.united().at(c) : c);
    editMesh(j.mesh, edits);
    EXPECT_EQ(j.mesh.validate(), "");
    EXPECT_EQ(j.mesh.cells, cells - 1);
    EXPECT_EQ(j.mesh.patches[1].count, walls - 2);
    expectWhole(j.mesh, 123);
}

TEST(ZipStar, RefusesZipsWhoseRowsDoNotMeet) {
    Joined j;
    Zip zip = zipOfTwo(j);
    zip.through.pop_back(); // one row is led through the other's node, the other is not
    j.star.use({zip}, {});
    EXPECT_FALSE(j.star.isSound(zip));
}

TEST(ZipStar, RefusesZipsThatTakeASideOfACell) {
    Joined j;
    Zip zip = zipOfTwo(j);
    zip.cells.clear(); // the face between the two would have its upper edge to and fro
    zip.moves.push_back({at(2, 1, 4), at(2, 2, 4), {2, 1.5, 4}});
    zip.moves.push_back({at(2, 1, 3), at(2, 2, 3), {2, 1.5, 3}});
    j.star.use({zip}, {});
    EXPECT_FALSE(j.star.isSound(zip));
}

TEST(ZipStar, OpensZipsToTheBit) {
    Joined j;
    const std::uint64_t before = j.mesh.checksum();
    j.star.use({zipOfTwo(j)}, {{at(2, 1, 3), {2, 1.25, 3.25}}});
    EXPECT_NE(j.mesh.checksum(), before);
    j.star.use({}, {});
    EXPECT_TRUE(j.star.rewrite().empty());
    EXPECT_EQ(j.mesh.checksum(), before);
}

// A point of the block is moved so far that cells beside the zip do not divide: moving columns mends them.
TEST(RimShape, MovesColumnsUntilFacesDivide) {
    Joined j;
    Zip zip = zipOfTwo(j);
    zip.h = 1;
    for (const int y : {1, 2}) zip.columns.push_back({{at(2, y, 3)}, {1}});
    const Verdict before = j.star.before(zip, {});
    j.star.use({zip}, {{at(2, 1, 3), {2.1, 1.9, 3.9}}});
    ASSERT_FALSE(j.star.isNoWorse(zip, before, {}));
    for (const auto& [point, place] : shapeZip(j.star, zip, {})) j.star.apply({point, -1, place});
    EXPECT_TRUE(j.star.isNoWorse(zip, before, {}));
}

} // namespace
} // namespace i2b::test
