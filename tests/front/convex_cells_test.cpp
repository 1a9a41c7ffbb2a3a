// Proves: on random kept cells with jumps in level no cell away from the front has two faces in one plane or is concave
// once the middles are raised, though all beside a jump had before; nothing moves but by the little said, and points of
// the front not at all, with levels of each axis' own too.
#include "carve/kept_checks.h"
#include "i2b/front/convex_cells.h"
#include "i2b/quality/mesh_geometry.h"
#include <gtest/gtest.h>

namespace i2b::test {
namespace {

struct Faces { // of one cell
    std::vector<FaceShape> shapes;
    int jumps = 0;        // internal faces smaller than the cell's
    bool onFront = false; // has a point there
};

// OpenFOAM's test, with its limit.
bool isConvex(const std::vector<FaceShape>& faces) {
    for (const FaceShape& i : faces) {
        for (const FaceShape& j : faces) {
            if (&i == &j) continue;
            const Vec3 to = j.centre - i.centre;
            if (dot(to, i.area) > -1e-6 * norm(to) * norm(i.area)) return false;
        }
    }
    return true;
}

std::vector<Faces> facesOf(const LatticeMesh& mesh, const RawVector<Vec3>& points) {
    std::vector<Faces> all;
    std::vector<std::uint8_t> isFront(points.size());
    for (std::int64_t s = 0; s < mesh.frontPointCount(); ++s) isFront[static_cast<std::size_t>(mesh.frontPoint(s).point)] = 1;
    LatticeMesh::Reader reader(mesh);
    for (int l = 0; l < mesh.levels(); ++l) {
        for (std::size_t n = 0; n < mesh.cells(l).leafCount(); ++n) {
            for (auto it = mesh.cells(l).leaf(n).cbeginValueOn(); it; ++it) {
                Faces cell;
                reader.faces(l, toIndex(it.getCoord()), [&](const CellFace& face) {
                    std::vector<Vec3> polygon;
                    for (std::size_t i = 0; i < face.vertices; ++i) {
                        const auto p = static_cast<std::size_t>(face.points[i]);
                        polygon.push_back(points[p]);
                        cell.onFront = cell.onFront || p >= isFront.size() || isFront[p] || face.kind == FaceKind::front;
                    }
                    cell.shapes.push_back(shapeOfPolygon(polygon.data(), polygon.size()));
                });
                cell.jumps = static_cast<int>(cell.shapes.size()) - 6;
                all.push_back(std::move(cell));
            }
        }
    }
    return all;
}

TEST(RandomCells, AreConvexOnceMiddlesAreRaised) {
    std::int64_t before = 0, cells = 0;
    for (unsigned seed = 0; seed < 12; ++seed) {
        const CarvedAtRandom c(seed, {6, 5, 7}, 3, 1 + static_cast<int>(seed % 2), 0.08);
        const LatticeMesh mesh(c.grid, c.kept);
        const RawVector<Vec3> lattice = mesh.latticePoints();
        RawVector<Vec3> points = lattice;
        raiseMiddles(mesh, points);
        const std::vector<Faces> flat = facesOf(mesh, lattice), raised = facesOf(mesh, points);
        for (std::size_t i = 0; i < flat.size(); ++i) {
            if (flat[i].onFront) continue;
            before += !isConvex(flat[i].shapes);
            cells += flat[i].jumps > 0;
            EXPECT_TRUE(isConvex(raised[i].shapes)) << "seed " << seed << ", cell " << i;
        }
    }
    EXPECT_GT(cells, 50);
    EXPECT_EQ(before, cells);
}

class RandomLevels : public testing::TestWithParam<bool> {}; // one level per axis

TEST_P(RandomLevels, MoveMiddlesLittleAndNoneOnTheFront) {
    std::int64_t moved = 0;
    for (unsigned seed = 20; seed < 24; ++seed) {
        const CarvedAtRandom c(seed, {6, 5, 7}, 3, 1, 0.08, GetParam());
        const LatticeMesh mesh(c.grid, c.kept);
        const RawVector<Vec3> lattice = mesh.latticePoints();
        RawVector<Vec3> points = lattice;
        raiseMiddles(mesh, points);
        const Vec3 base = mesh.lattice().base;
        for (std::size_t p = 0; p < points.size(); ++p) {
            const double by = norm(points[p] - lattice[p]);
            moved += by > 0;
            EXPECT_LE(by, middleOut * std::max({base.x, base.y, base.z}));
        }
        for (std::int64_t s = 0; s < mesh.frontPointCount(); ++s) {
            const auto p = static_cast<std::size_t>(mesh.frontPoint(s).point);
            EXPECT_EQ(norm(points[p] - lattice[p]), 0);
        }
    }
    EXPECT_GT(moved, 10);
}

INSTANTIATE_TEST_SUITE_P(Levels, RandomLevels, testing::Values(false, true),
                         [](const auto& info) { return info.param ? "PerAxis" : "Cubes"; });

} // namespace
} // namespace i2b::test
