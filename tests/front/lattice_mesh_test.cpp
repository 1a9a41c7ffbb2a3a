// Proves: on random kept cells with jumps in level every internal face is seen alike from both of its cells,
// every cell is closed, point by point, and has its lattice volume; points are used and lie on the right
// places.
#include "carve/kept_checks.h"
#include "i2b/front/lattice_mesh.h"
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <map>
#include <random>
#include <set>

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

// visit(rank, level, cell, face) for every face of every kept cell.
template <class Visit>
void forFaces(const LatticeMesh& mesh, const Visit& visit) {
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

// Every internal face is seen alike from both sides, every cell is closed, edge by edge, and has its volume.
class Conformity {
  public:
    explicit Conformity(const LatticeMesh& mesh)
        : mesh_(mesh), points_(mesh.latticePoints()), edges_(static_cast<std::size_t>(mesh.cellCount())),
          volume_(edges_.size(), 0), expected_(edges_.size(), 0), area_(edges_.size()), used_(points_.size()) {
        forFaces(mesh, [&](std::int64_t rank, int level, const Index3& cell, const CellFace& face) { add(rank, level, cell, face); });
        compare();
    }
    const std::string& fault() const { return fault_; }

  private:
    void note(bool good, const char* what, std::int64_t cell) {
        if (!good && fault_.empty()) fault_ = fmt::format("{} (cell {})", what, cell);
    }
    void add(std::int64_t rank, int level, const Index3& cell, const CellFace& face) {
        std::vector<std::int32_t> p = polygonOf(face);
        note(p.size() >= 4, "a polygon of less than four points", rank);
        const auto r = static_cast<std::size_t>(rank);
        const Box box = mesh_.lattice().cellBox(mesh_.levelOf(level), cell);
        expected_[r] = box.extent().x * box.extent().y * box.extent().z;
        Vec3 sum;
        for (std::size_t i = 0; i < p.size(); ++i) {
            const std::int32_t a = p[i], b = p[(i + 1) % p.size()];
            if (a < 0 || static_cast<std::size_t>(a) >= points_.size()) return note(false, "no such point", rank);
            note(box.contains(points_[std::size_t(a)]), "a point outside its cell", rank);
            used_[std::size_t(a)] = true;
            ++edges_[r][{a, b}];
            sum += cross(points_[std::size_t(a)] - box.lo, points_[std::size_t(b)] - box.lo) * 0.5;
        }
        area_[r] += sum;
        const double part = dot(sum, points_[std::size_t(p[0])] - box.centre());
        volume_[r] += part / 3;
        note(part > 0, "a normal points inwards", rank);
        if (face.kind == FaceKind::internal) {
            if (face.other < 0 || face.other >= mesh_.cellCount() || face.other == rank) return note(false, "no such neighbour", rank);
            if (face.other < rank) std::reverse(p.begin(), p.end());
            shared_[std::minmax(rank, face.other)].push_back(rotated(p));
        } else if (face.kind == FaceKind::side) {
            const Box domain = mesh_.lattice().domain();
            const double plane = face.side % 2 ? domain.hi[face.side / 2] : domain.lo[face.side / 2];
            for (std::int32_t a : p) note(points_[std::size_t(a)][face.side / 2] == plane, "a side off its plane", rank);
        }
    }
    void compare() {
        for (auto& [pair, seen] : shared_) { // two cells may share several faces
            std::sort(seen.begin(), seen.end());
            bool alike = seen.size() % 2 == 0;
            for (std::size_t i = 0; alike && i < seen.size(); i += 2) alike = seen[i] == seen[i + 1];
            note(alike && seen.size() == 2, "a face that its two cells see in different ways", pair.first);
        }
        for (std::size_t i = 0; i < edges_.size(); ++i) {
            note(std::abs(volume_[i] - expected_[i]) < 1e-12 && norm(area_[i]) < 1e-12, "a volume that is wrong", std::int64_t(i));
            for (const auto& [edge, n] : edges_[i]) {
                note(n == 1, "an edge that runs twice the same way", std::int64_t(i));
                note(edges_[i].count({edge.second, edge.first}) == 1, "an open cell", std::int64_t(i));
            }
        }
        note(std::count(used_.begin(), used_.end(), false) == 0, "points without a face", -1);
    }

    const LatticeMesh& mesh_;
    RawVector<Vec3> points_;
    std::map<std::pair<std::int64_t, std::int64_t>, std::vector<std::vector<std::int32_t>>> shared_;
    std::vector<std::map<std::pair<std::int32_t, std::int32_t>, int>> edges_;
    std::vector<double> volume_, expected_;
    std::vector<Vec3> area_;
    std::vector<bool> used_;
    std::string fault_;
};

class RandomMesh : public testing::TestWithParam<unsigned> {
  protected:
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
        ASSERT_EQ(mesh.cellCount(), static_cast<std::int64_t>(c.kept.cellCount()));
        EXPECT_EQ(Conformity(mesh).fault(), "") << "seed " << seed;
    }
}

// The corners of a cell are the points that its faces name, and its faces name no others, wherever the reader knows them at once:
// for every cell without finer ones around it, and for no cell with a point amid an edge or a face.
TEST_P(RandomMesh, CornersAreThePointsOfTheFaces) {
    int known = 0, hanging = 0;
    for (unsigned seed = 20 * GetParam(); seed < 20 * GetParam() + 20; ++seed) {
        const CarvedAtRandom c = make(seed);
        const LatticeMesh mesh(c.grid, c.kept);
        LatticeMesh::Reader reader(mesh);
        std::map<std::int64_t, std::set<std::int32_t>> named;
        std::map<std::int64_t, std::pair<int, Index3>> cells;
        forFaces(mesh, [&](std::int64_t rank, int level, const Index3& cell, const CellFace& face) {
            named[rank].insert(face.points.begin(), face.points.begin() + face.vertices);
            cells[rank] = {level, cell};
        });
        for (const auto& [rank, points] : named) {
            std::array<std::int32_t, 8> corners;
            if (reader.corners(cells[rank].first, cells[rank].second, corners)) {
                EXPECT_EQ(std::set<std::int32_t>(corners.begin(), corners.end()), points) << "seed " << seed << ", cell " << rank;
                ++known;
            } else {
                EXPECT_GT(mesh.levels(), 1) << "seed " << seed << ", cell " << rank;
                hanging += points.size() > 8;
            }
        }
    }
    EXPECT_GT(known, 1000);
    EXPECT_GT(hanging, 100);
}

// Deep cells are those with 26 kept neighbours of their own level, and what is known of them at once are the faces that any other cell
// has: three to higher numbers, of four points each.
TEST_P(RandomMesh, DeepCellsHaveThreeUpperFaces) {
    int deepOnes = 0, others = 0;
    for (unsigned seed = 4 * GetParam(); seed < 4 * GetParam() + 4; ++seed) {
        const CarvedAtRandom c(seed, {19, 18, 10}, 1 + static_cast<int>(seed % 2), 1, 0.002, seed % 4 > 1);
        const LatticeMesh mesh(c.grid, c.kept);
        LatticeMesh::Reader reader(mesh);
        for (int level = 0; level < mesh.levels(); ++level) {
            const RankedMask& cells = mesh.cells(level);
            for (std::size_t node = 0; node < cells.leafCount(); ++node) {
                const LeafBits deep = reader.deepCells(level, node);
                const Index3 o = toIndex(cells.leaf(node).origin());
                std::int64_t rank = cells.leafFirst(node);
                bits::forEach(leafBits(&cells.leaf(node)), [&](int x, int y, int z) {
                    const Index3 at{o[0] + x, o[1] + y, o[2] + z};
                    int kept = 0;
                    for (int i = 0; i < 27; ++i) kept += reader.cell(level, {at[0] + i % 3 - 1, at[1] + i / 3 % 3 - 1, at[2] + i / 9 - 1}) >= 0;
                    const bool isDeep = bits::test(deep, bits::offset(x, y, z));
                    EXPECT_EQ(isDeep, kept == 27) << "seed " << seed << ", cell " << rank;
                    (isDeep ? deepOnes : others) += 1;
                    if (isDeep) {
                        using Face = std::pair<std::int64_t, std::vector<std::int32_t>>;
                        std::vector<Face> expected, found;
                        reader.faces(level, at, [&](const CellFace& f) {
                            EXPECT_EQ(f.kind, FaceKind::internal) << "seed " << seed << ", cell " << rank;
                            expected.emplace_back(f.other, std::vector<std::int32_t>(f.points.begin(), f.points.begin() + f.vertices));
                        }, rank);
                        std::sort(expected.begin(), expected.end());
                        reader.upperFaces(level, at, [&](std::int32_t other, const std::array<std::int32_t, 4>& points) {
                            found.emplace_back(other, std::vector<std::int32_t>(points.begin(), points.end()));
                        });
                        EXPECT_EQ(found, expected) << "seed " << seed << ", cell " << rank;
                    }
                    ++rank;
                });
            }
        }
    }
    EXPECT_GT(deepOnes, 500);
    EXPECT_GT(others, 500);
}

// Base cells of 2^n grids, each split along axes of its own choice: bit a of splits[i] splits base cell i along axis a.
CellGrid splitByHand(const Index3& count, const std::vector<unsigned>& splits) {
    CellGrid grid;
    grid.lattice.base = {1, 0.5, 0.75};
    grid.lattice.count = count;
    grid.lattice.maxLevel = 1;
    for (unsigned t = 0; t < 8; ++t) {
        const LevelTriple level{std::uint8_t(t & 1), std::uint8_t(t >> 1 & 1), std::uint8_t(t >> 2)};
        auto base = std::make_shared<Mask>(false);
        for (std::size_t i = 0; i < splits.size(); ++i) {
            const auto n = static_cast<std::int32_t>(i);
            if (splits[i] == t) base->setValueOn({n % count[0], n / count[0] % count[1], n / count[0] / count[1]});
        }
        if (!isEmpty(*base)) grid.levels.push_back({level, overlapping(*base, allAxes(0), level)});
    }
    return grid;
}

// By bits: the point of the lattice at that end of the cell.
TEST(LatticeMesh, CornersLieWhereTheirBitsSay) {
    const CellGrid grid = splitByHand({2, 1, 1}, {0, 0});
    KeptCells all;
    all.levels.push_back(grid.levels[0].cells);
    const LatticeMesh mesh(grid, all);
    const RawVector<Vec3> points = mesh.latticePoints();
    LatticeMesh::Reader reader(mesh);
    std::array<std::int32_t, 8> corners;
    ASSERT_TRUE(reader.corners(0, {1, 0, 0}, corners));
    for (std::size_t k = 0; k < 8; ++k) {
        const Vec3 x = points[static_cast<std::size_t>(corners[k])] - grid.lattice.origin;
        EXPECT_EQ(x, (Vec3{(k & 1) ? 2.0 : 1.0, (k >> 1 & 1) ? 0.5 : 0.0, (k >> 2) ? 0.75 : 0.0})) << k;
    }
}

// One at a time as all at once: also of the further points of vertices that part kept cells.
TEST_P(RandomMesh, SinglePointsLieWhereAllOfThemDo) {
    for (unsigned seed = 20 * GetParam(); seed < 20 * GetParam() + 20; ++seed) {
        const CarvedAtRandom c = make(seed);
        const LatticeMesh mesh(c.grid, c.kept);
        const RawVector<Vec3> points = mesh.latticePoints();
        for (std::size_t p = 0; p < points.size(); ++p) ASSERT_EQ(mesh.latticePoint(static_cast<std::int32_t>(p)), points[p]) << "seed " << seed;
    }
}

std::string faultOf(const CellGrid& grid) {
    if (const std::string fault = grid.validate(); !fault.empty()) return fault;
    KeptCells all;
    for (const CellLevel& level : grid.levels) all.levels.push_back(level.cells);
    return Conformity(LatticeMesh(grid, all)).fault();
}

// All 64 ways for two neighbours to be split, across each axis: each may be the finer one along another axis.
TEST(LatticeMesh, EveryPairOfNeighboursConforms) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
        Index3 count{1, 1, 1};
        count[axis] = 2;
        for (unsigned pair = 0; pair < 64; ++pair) {
            EXPECT_EQ(faultOf(splitByHand(count, {pair & 7, pair >> 3})), "") << "axis " << axis << ", pair " << pair;
        }
    }
}

// Eight cells around a vertex, split at random: edges carry what hangs on them from any side.
TEST(LatticeMesh, RandomSplitsAroundAVertexConform) {
    std::mt19937 random(5);
    for (int i = 0; i < 300; ++i) {
        std::vector<unsigned> splits(8);
        for (unsigned& s : splits) s = random() % 8;
        EXPECT_EQ(faultOf(splitByHand({2, 2, 2}, splits)), "") << "number " << i;
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
