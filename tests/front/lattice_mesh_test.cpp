// Proves: on random kept cells with jumps in level every internal face is seen alike from both of its cells,
// every cell is closed, point by point, and has its lattice volume; points are used and lie on the right
// places.
#include "carve/kept_checks.h"
#include "i2b/front/lattice_mesh.h"
#include <gtest/gtest.h>
#include <map>

namespace i2b::test {
namespace {

std::vector<std::int32_t> polygonOf(const CellFace& face) {
    return {face.points.begin(), face.points.begin() + face.vertices};
}

// From the lowest point on.
std::vector<std::int32_t> rotated(std::vector<std::int32_t> polygon) {
    std::rotate(polygon.begin(), std::min_element(polygon.begin(), polygon.end()), polygon.end());
    return polygon;
}

class RandomMesh : public testing::TestWithParam<unsigned> {
  protected:
    // visit(rank, level, cell, face) for every face of every kept cell.
    template <class Visit>
    static void forFaces(const LatticeMesh& mesh, const Visit& visit) {
        LatticeMesh::Reader reader(mesh);
        for (int l = 0; l < mesh.levels(); ++l) {
            for (std::size_t n = 0; n < mesh.cells(l).leafCount(); ++n) {
                std::int64_t rank = mesh.cells(l).leafFirst(n);
                const MaskLeaf& leaf = mesh.cells(l).leaf(n);
                for (auto it = leaf.cbeginValueOn(); it; ++it, ++rank) {
                    const Index3 c = toIndex(it.getCoord());
                    reader.faces(l, c, [&](const CellFace& face) { visit(rank, l, c, face); });
                }
            }
        }
    }
    static CarvedAtRandom make(unsigned seed) {
        return {seed,
                {5, 6, 4},
                1 + static_cast<int>(seed % 3),
                1 + static_cast<int>(seed / 3 % 2),
                0.05 + 0.05 * (seed % 7),
                seed % 2 == 1}; // every other with one level per axis
    }
};

TEST_P(RandomMesh, FacesMatchAndCellsClose) {
    for (unsigned seed = 20 * GetParam(); seed < 20 * GetParam() + 20; ++seed) {
        const CarvedAtRandom c = make(seed);
        const LatticeMesh mesh(c.grid, c.kept);
        const std::vector<Vec3> points = mesh.latticePoints();
        ASSERT_EQ(mesh.cellCount(), static_cast<std::int64_t>(c.kept.cellCount()));
        const auto cells = static_cast<std::size_t>(mesh.cellCount());
        std::map<std::pair<std::int64_t, std::int64_t>, std::vector<std::vector<std::int32_t>>> shared;
        std::vector<std::map<std::pair<std::int32_t, std::int32_t>, int>> edges(cells);
        std::vector<double> volume(cells, 0), expected(cells, 0);
        std::vector<Vec3> area(cells);
        std::vector<bool> used(points.size());
        forFaces(mesh, [&](std::int64_t rank, int level, const Index3& cell, const CellFace& face) {
            std::vector<std::int32_t> p = polygonOf(face);
            ASSERT_GE(p.size(), 4u);
            const auto r = static_cast<std::size_t>(rank);
            const Box box = mesh.lattice().cellBox(mesh.levelOf(level), cell);
            expected[r] = box.extent().x * box.extent().y * box.extent().z;
            Vec3 sum;
            for (std::size_t i = 0; i < p.size(); ++i) {
                const std::int32_t a = p[i], b = p[(i + 1) % p.size()];
                ASSERT_TRUE(a >= 0 && static_cast<std::size_t>(a) < points.size());
                const Vec3& x = points[static_cast<std::size_t>(a)];
                ASSERT_TRUE(box.contains(x)) << "seed " << seed;
                used[static_cast<std::size_t>(a)] = true;
                ++edges[r][{a, b}];
                sum += cross(x - box.lo, points[static_cast<std::size_t>(b)] - box.lo) * 0.5;
            }
            area[r] += sum;
            volume[r] += dot(sum, points[static_cast<std::size_t>(p[0])] - box.centre()) / 3;
            EXPECT_GT(dot(sum, points[static_cast<std::size_t>(p[0])] - box.centre()), 0)
                << "a normal points inwards";
            if (face.kind == FaceKind::internal) {
                ASSERT_TRUE(face.other >= 0 && face.other < mesh.cellCount() && face.other != rank);
                if (face.other < rank) std::reverse(p.begin(), p.end());
                shared[std::minmax(rank, face.other)].push_back(rotated(p));
            } else if (face.kind == FaceKind::side) {
                const double plane = face.side % 2 ? mesh.lattice().domain().hi[face.side / 2]
                                                   : mesh.lattice().domain().lo[face.side / 2];
                for (std::int32_t a : p) EXPECT_EQ(points[static_cast<std::size_t>(a)][face.side / 2], plane);
            }
        });
        for (const auto& [pair, seen] : shared) {
            ASSERT_EQ(seen.size(), 2u)
                << "seed " << seed << ": a face of cells " << pair.first << " and " << pair.second;
            ASSERT_EQ(seen[0], seen[1])
                << "seed " << seed << ": a face of cells " << pair.first << " and " << pair.second;
        }
        for (std::size_t i = 0; i < cells; ++i) {
            ASSERT_NEAR(volume[i], expected[i], 1e-12);
            ASSERT_LT(norm(area[i]), 1e-12);
            for (const auto& [edge, n] : edges[i]) {
                ASSERT_EQ(n, 1) << "seed " << seed << " cell " << i << ": an edge runs twice the same way";
                ASSERT_EQ(edges[i].count({edge.second, edge.first}), 1u)
                    << "seed " << seed << " cell " << i << " is open";
            }
        }
        EXPECT_EQ(std::count(used.begin(), used.end(), false), 0)
            << "seed " << seed << ": points without a face";
    }
}

// Kept cells that touch only at a vertex or an edge share no point: within one point's cells any two are
// joined by faces.
TEST_P(RandomMesh, PointsHaveOneFaceConnectedSetOfCells) {
    for (unsigned seed = 1000 + 10 * GetParam(); seed < 1010 + 10 * GetParam(); ++seed) {
        const CarvedAtRandom c = make(seed);
        const LatticeMesh mesh(c.grid, c.kept);
        std::vector<std::map<std::int64_t, std::int64_t>> around(static_cast<std::size_t>(mesh.pointCount()));
        forFaces(mesh, [&](std::int64_t rank, int, const Index3&, const CellFace& face) {
            for (std::int32_t p : polygonOf(face)) around[static_cast<std::size_t>(p)][rank] = rank;
        });
        const auto root = [&](std::map<std::int64_t, std::int64_t>& sets, std::int64_t i) {
            while (sets[i] != i) i = sets[i];
            return i;
        };
        forFaces(mesh, [&](std::int64_t rank, int, const Index3&, const CellFace& face) {
            if (face.kind != FaceKind::internal) return;
            for (std::int32_t p : polygonOf(face)) {
                auto& sets = around[static_cast<std::size_t>(p)];
                ASSERT_EQ(sets.count(face.other), 1u);
                sets[root(sets, rank)] = root(sets, face.other);
            }
        });
        for (auto& sets : around) {
            int roots = 0;
            for (auto& [cell, parent] : sets) roots += cell == parent;
            ASSERT_EQ(roots, 1) << "seed " << seed;
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Many, RandomMesh, testing::Range(0u, 5u));

} // namespace
} // namespace i2b::test
