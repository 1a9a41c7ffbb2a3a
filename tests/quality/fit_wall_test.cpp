// The size of the local wall cell, h, in which everything about the fit is measured: that of the cells behind the
// layers, whatever became of the wall's own faces.
#include "i2b/quality/fit_wall.h"
#include "quality/cell_mesh.h"
#include <algorithm>
#include <cmath>
#include <functional>
#include <gtest/gtest.h>

namespace i2b {
namespace {

constexpr int edge = 5; // columns along x and along y, of width 1

// Columns of hexahedra on these levels, their points moved; only what is at z = 0 after that is wall.
PolyMesh columns(const std::vector<double>& levels, const std::function<Vec3(Vec3)>& move) {
    const auto high = static_cast<int>(levels.size());
    std::vector<Vec3> points;
    for (int x = 0; x <= edge; ++x)
        for (int y = 0; y <= edge; ++y)
            for (const double z : levels) points.push_back(move({double(x), double(y), z}));
    const auto at = [&](int x, int y, int z) { return (x * (edge + 1) + y) * high + z; };
    std::vector<test::CellLoops> cells;
    for (int x = 0; x < edge; ++x)
        for (int y = 0; y < edge; ++y)
            for (int z = 0; z + 1 < high; ++z)
                cells.push_back(test::hexLoops({at(x, y, z), at(x + 1, y, z), at(x + 1, y + 1, z), at(x, y + 1, z), at(x, y, z + 1),
                                                at(x + 1, y, z + 1), at(x + 1, y + 1, z + 1), at(x, y + 1, z + 1)}));
    PolyMesh mesh = test::meshOfCells(std::move(points), cells);
    const std::int32_t first = mesh.internalFaces();
    std::vector<std::vector<std::int32_t>> faces[2]; // elsewhere, on the wall
    std::vector<std::int32_t> owners[2];
    for (std::int32_t f = first; f < mesh.faces(); ++f) {
        const auto face = mesh.face(f);
        const bool isWall = std::ranges::all_of(face, [&](std::int32_t v) { return v % high == 0; });
        faces[isWall].emplace_back(face.begin(), face.end());
        owners[isWall].push_back(mesh.owner[static_cast<std::size_t>(f)]);
    }
    std::size_t next = mesh.faceOffsets[static_cast<std::size_t>(first)], f = static_cast<std::size_t>(first);
    for (const int side : {0, 1})
        for (std::size_t i = 0; i < faces[side].size(); ++i) {
            mesh.owner[f++] = owners[side][i];
            for (const std::int32_t v : faces[side][i]) mesh.faceVertices[next++] = v;
        }
    const auto others = static_cast<std::int32_t>(faces[0].size()), walls = static_cast<std::int32_t>(faces[1].size());
    mesh.patches = {{"sides", "patch", first, others}, {"wall", "wall", first + others, walls}};
    return mesh;
}

void expectAllSizes(const PolyMesh& mesh, double size, double within) {
    ASSERT_EQ(mesh.validate(), "");
    const Wall wall = collectWall(mesh, buildCellFaces(mesh), {});
    ASSERT_EQ(wall.faces.size(), edge * edge);
    ASSERT_EQ(wall.nodes.size(), (edge + 1) * (edge + 1));
    for (const double h : wall.nodeH) EXPECT_NEAR(h, size, within);
    for (const double h : wall.faceH) EXPECT_NEAR(h, size, within);
}

const auto asItIs = [](Vec3 p) { return p; };

// Without layers the cells at the wall are as large as those behind them.
TEST(FitWall, CubesHaveTheirEdge) { expectAllSizes(columns({0, 1, 2, 3, 4}, asItIs), 1, 1e-12); }

// Twelve layers, from thin ones to one of half a cell, do not change it.
TEST(FitWall, LayersAreLookedThrough) {
    std::vector<double> levels{0};
    for (double height = 0.004; levels.size() <= 12; height *= 1.5) levels.push_back(levels.back() + height);
    const double front = levels.back();
    for (int i = 1; i <= 4; ++i) levels.push_back(front + i);
    expectAllSizes(columns(levels, asItIs), 1, 1e-12);
}

// Where the wall lies across the lattice its faces are shorter than the cells that they belong to.
TEST(FitWall, FacesOfASlopeDoNotMakeItSmaller) {
    const auto narrowed = [](Vec3 p) { return Vec3{p.z < 0.5 ? 0.6 * p.x + 1 : p.x, p.y, p.z}; };
    expectAllSizes(columns({0, 0.7, 1.7, 2.7, 3.7}, narrowed), 1, 1e-12);
}

// One cell across a gap of 0.3: squeezed along one axis, it has the size of the other two.
TEST(FitWall, GapsDoNotMakeItSmaller) { expectAllSizes(columns({0, 0.1, 0.2, 0.3}, asItIs), 1, 1e-12); }

// A face without area, all of whose points are on one line, does not lead anywhere: its cell's own edges count.
TEST(FitWall, CollapsedFacesHaveTheSizeOfTheirCell) {
    const PolyMesh mesh = test::columnOf({{Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{1, 0, 0}, Vec3{0, 0, 0}}, test::square(1), test::square(3)});
    const Wall wall = collectWall(mesh, buildCellFaces(mesh), {});
    const auto collapsed = std::ranges::find_if(wall.shapes, [](const FaceShape& s) { return norm2(s.area) == 0; });
    ASSERT_NE(collapsed, wall.shapes.end());
    for (const double h : wall.faceH) EXPECT_TRUE(h >= 1 && h <= 2) << h;
}

// A cell of four faces has no other side to go on to: its own edges count.
TEST(FitWall, TetrahedraHaveTheirOwnSize) {
    const PolyMesh mesh = test::meshOfCells({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}});
    const Wall wall = collectWall(mesh, buildCellFaces(mesh), {});
    for (const double h : wall.nodeH) EXPECT_NEAR(h, std::sqrt(2), 1e-12);
}

} // namespace
} // namespace i2b
