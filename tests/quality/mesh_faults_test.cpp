#include "i2b/quality/mesh_faults.h"
#include "quality/cell_mesh.h"
#include "quality/shaken_block.h"
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <random>
#include <set>

namespace i2b {
namespace {

PolyMesh block(std::mt19937& random) { return test::shakenBlock(5, 0.25, random); }

QualityLimits strict() { // so that every kind of fault turns up
    QualityLimits limits;
    limits.nonOrthogonality = 15;
    limits.skewness = 0.3;
    limits.faceWeight = 0.45;
    limits.volumeRatio = 0.7;
    limits.determinant = 0.9;
    return limits;
}

// The same faults as the report names under the same limits.
TEST(MeshFaults, AgreeWithTheReport) {
    std::mt19937 random(1);
    const PolyMesh mesh = block(random);
    const Rows cellFaces = buildCellFaces(mesh);
    FaultCount faults;
    std::int64_t expected = 0, severe = 0;
    const std::vector<std::int32_t> poor = MeshFaults(mesh, cellFaces, strict()).poorCells(faults);
    std::set<std::int32_t> cells;
    const QualityReport report = measureQuality(mesh, strict());
    for (const char* name : {"nonOrthoFaces", "skewFaces", "lowWeightFaces", "lowVolRatioFaces"}) {
        const QualityCheck* check = findCheck(report, name);
        ASSERT_NE(check, nullptr) << name;
        expected += check->count;
        if (std::string(name) == "nonOrthoFaces" || std::string(name) == "skewFaces") severe += check->count;
        for (const std::int32_t f : check->ids) {
            cells.insert(mesh.owner[static_cast<std::size_t>(f)]);
            if (f < mesh.internalFaces()) cells.insert(mesh.neighbour[static_cast<std::size_t>(f)]);
        }
    }
    const QualityCheck* low = findCheck(report, "underdeterminedCells");
    ASSERT_NE(low, nullptr);
    cells.insert(low->ids.begin(), low->ids.end());
    EXPECT_EQ(faults.all, expected + low->count);
    EXPECT_EQ(faults.severe, severe);
    EXPECT_EQ(poor, std::vector<std::int32_t>(cells.begin(), cells.end()));
}

// Of cells that may be thin the determinants do not count, nor weights and volume ratios among them; all else does.
TEST(MeshFaults, ThinCellsMayBeThin) {
    std::mt19937 random(1);
    const PolyMesh mesh = block(random);
    const std::int32_t thinFrom = mesh.cells / 2;
    const QualityReport report = measureQuality(mesh, strict());
    std::int64_t expected = 0, spared = 0;
    for (const char* name : {"nonOrthoFaces", "skewFaces"}) expected += findCheck(report, name)->count;
    const auto count = [&](bool thin) { thin ? ++spared : ++expected; };
    for (const char* name : {"lowWeightFaces", "lowVolRatioFaces"})
        for (const std::int32_t f : findCheck(report, name)->ids) count(mesh.owner[static_cast<std::size_t>(f)] >= thinFrom);
    for (const std::int32_t c : findCheck(report, "underdeterminedCells")->ids) count(c >= thinFrom);
    ASSERT_GT(spared, 10);
    FaultCount faults;
    const Rows cellFaces = buildCellFaces(mesh);
    MeshFaults(mesh, cellFaces, strict(), thinFrom).poorCells(faults);
    EXPECT_EQ(faults.all, expected);
}

// What only a few thin cells have does count; what many have does not.
TEST(MeshFaults, FewFaultsOfThinCellsCount) {
    std::mt19937 random(3);
    PolyMesh few = test::shakenBlock(8, 0.05, random);
    few.points[364] += Vec3{0.97, 0.2, 0.1}; // amid the block: 9 by 9 by 9 points
    const PolyMesh many = test::shakenBlock(8, 0.55, random);
    QualityLimits limits;
    limits.faceWeight = 0.3;
    for (const bool isFew : {true, false}) {
        const PolyMesh& mesh = isFew ? few : many;
        const Rows cellFaces = buildCellFaces(mesh);
        const MeshFaults all(mesh, cellFaces, limits), thin(mesh, cellFaces, limits, 0);
        ASSERT_FALSE(all.undividedFaces().empty());
        EXPECT_EQ(thin.countsThinWeights(), isFew);
        EXPECT_EQ(thin.undividedFaces(), isFew ? all.undividedFaces() : std::vector<std::int32_t>());
    }
}

// Where cells are so thin that their determinants are under the limit anyway, fewer faces that do not divide are few; weights as ever.
TEST(MeshFaults, FlatCellsNeedNotDivide) {
    std::mt19937 random(3);
    PolyMesh mesh = test::shakenBlock(8, 0.05, random);
    mesh.points[364] += Vec3{0.97, 0.2, 0.1};
    const Rows cellFaces = buildCellFaces(mesh);
    QualityLimits limits;
    limits.faceWeight = 0.3;
    const MeshFaults upright(mesh, cellFaces, limits, 0);
    limits.determinant = 2; // more than that of a cube
    const std::vector<std::int32_t> undivided = upright.undividedFaces();
    ASSERT_GT(undivided.size(), std::size_t(2)); // of 512 cells
    const MeshFaults flat(mesh, cellFaces, limits, 0);
    EXPECT_TRUE(flat.undividedFaces().empty());
    EXPECT_TRUE(flat.countsThinWeights());
    const std::int32_t thinFrom = mesh.owner[static_cast<std::size_t>(undivided.front())] + 1; // those of other cells count
    const MeshFaults some(mesh, cellFaces, limits, thinFrom);
    const std::vector<std::int32_t> left = some.undividedFaces();
    EXPECT_TRUE(std::ranges::binary_search(left, undivided.front()));
}

std::vector<std::int32_t> cellsThatUse(const PolyMesh& mesh, const std::vector<std::int32_t>& points) {
    std::set<std::int32_t> cells;
    for (std::int32_t f = 0; f < mesh.faces(); ++f) {
        const auto face = mesh.face(f);
        if (std::ranges::find_first_of(face, points) == face.end()) continue;
        cells.insert(mesh.owner[static_cast<std::size_t>(f)]);
        if (f < mesh.internalFaces()) cells.insert(mesh.neighbour[static_cast<std::size_t>(f)]);
    }
    return {cells.begin(), cells.end()};
}

// Measured again where points moved, or all anew: the same, whichever cells of the moved points are named, or all of them.
TEST(MeshFaults, UpdateIsAsGoodAsAFreshLook) {
    std::size_t bad = 0;
    for (unsigned seed = 0; seed < 20; ++seed) {
        std::mt19937 random(seed);
        PolyMesh mesh = block(random);
        const Rows cellFaces = buildCellFaces(mesh);
        MeshFaults faults(mesh, cellFaces, strict());
        std::uniform_real_distribution<double> off(-1.2, 1.2);
        for (int round = 0; round < 5; ++round) {
            std::vector<std::int32_t> moved, seeds;
            for (int i = 0; i < 4; ++i) {
                const auto cell = static_cast<std::int32_t>(random() % static_cast<unsigned>(mesh.cells));
                const auto face = mesh.face(cellFaces[cell][random() % cellFaces[cell].size()]);
                moved.push_back(face[random() % face.size()]);
                seeds.push_back(cell);
                mesh.points[static_cast<std::size_t>(moved.back())] += Vec3{off(random), off(random), off(random)};
            }
            if (round % 2 == 0) faults.update(moved, seeds);
            else faults.update(cellsThatUse(mesh, moved));
            const MeshFaults fresh(mesh, cellFaces, strict());
            FaultCount count, freshCount;
            EXPECT_EQ(faults.badCells(), fresh.badCells());
            EXPECT_EQ(faults.poorCells(count), fresh.poorCells(freshCount));
            EXPECT_EQ(count.all, freshCount.all);
            EXPECT_EQ(count.severe, freshCount.severe);
            EXPECT_EQ(faults.undividedFaces(), fresh.undividedFaces());
        }
        bad += faults.badCells().size();
    }
    EXPECT_GT(bad, 0u);
}

// Faces that do not divide: those whose tetrahedra or whose twist the report names, each once.
TEST(MeshFaults, UndividedFacesAreTheReports) {
    std::int64_t tets = 0, twisted = 0;
    for (unsigned seed = 0; seed < 10; ++seed) {
        std::mt19937 random(seed);
        const PolyMesh mesh = test::shakenBlock(5, 0.2 + 0.05 * seed, random);
        const Rows cellFaces = buildCellFaces(mesh);
        const std::vector<std::int32_t> undivided = MeshFaults(mesh, cellFaces, {}).undividedFaces();
        const QualityReport report = measureQuality(mesh);
        const QualityCheck* low = findCheck(report, "lowQualityTetFaces");
        std::int64_t named = 0;
        if (low) {
            EXPECT_TRUE(std::ranges::includes(undivided, low->ids)) << "seed " << seed;
            named = static_cast<std::int64_t>(low->ids.size());
        }
        const auto twist = std::ranges::find(report.dictionary, "minTwist", &DictionaryCheck::key);
        ASSERT_NE(twist, report.dictionary.end());
        const auto found = static_cast<std::int64_t>(undivided.size());
        EXPECT_GE(found, std::max(named, twist->faces)) << "seed " << seed;
        EXPECT_LE(found, named + twist->faces) << "seed " << seed;
        tets += named, twisted += twist->faces;
    }
    EXPECT_GT(tets, 50);
    EXPECT_GT(twisted, 50);
}

// A prism that leans far over from a narrow triangle, which is wide enough by itself: the report names it, so it is to be mended.
TEST(MeshFaults, NarrowTrianglesOfLeaningCellsAreNamed) {
    const std::vector<Vec3> points{{0, 0, 0}, {1e-2, 0, 0}, {5e-3, 8e-5, 0}, {0, 0.04, 1e-4}, {1e-2, 0.04, 1e-4}, {5e-3, 0.04 + 8e-5, 1e-4}};
    const PolyMesh mesh = test::meshOfCells(points, {{{0, 2, 1}, {3, 4, 5}, {0, 1, 4, 3}, {1, 2, 5, 4}, {2, 0, 3, 5}}});
    const QualityReport report = measureQuality(mesh);
    const auto tets = std::ranges::find(report.dictionary, "minTetQuality", &DictionaryCheck::key);
    ASSERT_NE(tets, report.dictionary.end());
    ASSERT_GE(tets->faces, 2); // both triangles
    QualityLimits asked;
    asked.tetQuality = 1.5e-15;
    const Rows cellFaces = buildCellFaces(mesh);
    const std::vector<std::int32_t> named = MeshFaults(mesh, cellFaces, asked).undividedFaces();
    EXPECT_EQ(std::ranges::count_if(named, [&](std::int32_t f) { return mesh.face(f).size() == 3; }), 2);
}

// Where only some points may move the cells at these are looked at as ever, and no others; what changes later is followed as well.
TEST(MeshFaults, OnlyWherePointsMayMove) {
    std::size_t spared = 0;
    for (unsigned seed = 0; seed < 10; ++seed) {
        std::mt19937 random(seed);
        PolyMesh mesh = block(random);
        const Rows cellFaces = buildCellFaces(mesh);
        std::vector<std::uint8_t> mayMove(mesh.points.size(), 0);
        std::vector<std::int32_t> movable;
        for (int i = 0; i < 3; ++i) movable.push_back(static_cast<std::int32_t>(random() % mesh.points.size()));
        for (const std::int32_t p : movable) mayMove[static_cast<std::size_t>(p)] = 1;
        const std::vector<std::int32_t> cells = cellsThatUse(mesh, movable);
        const auto isThere = [&](std::int32_t c) { return std::ranges::binary_search(cells, c); };
        MeshFaults near(mesh, cellFaces, strict(), mesh.cells, mayMove);
        for (int round = 0; round < 2; ++round) {
            const MeshFaults all(mesh, cellFaces, strict());
            std::vector<std::int32_t> expected; // faces of these cells; others are of no account
            for (const std::int32_t f : all.poorFaces()) {
                const auto i = static_cast<std::size_t>(f);
                const bool isIn = isThere(mesh.owner[i]) || (f < mesh.internalFaces() && isThere(mesh.neighbour[i]));
                isIn ? expected.push_back(f) : void(++spared);
            }
            EXPECT_TRUE(std::ranges::includes(near.poorFaces(), expected)) << "seed " << seed;
            EXPECT_LT(near.poorFaces().size(), all.poorFaces().size()) << "seed " << seed;
            std::vector<std::int32_t> bad = all.badCells();
            std::erase_if(bad, [&](std::int32_t c) { return !isThere(c); });
            EXPECT_TRUE(std::ranges::includes(near.badCells(), bad));
            for (const std::int32_t p : movable) mesh.points[static_cast<std::size_t>(p)] += Vec3{0.7, -0.6, 0.4};
            near.update(cells);
        }
    }
    EXPECT_GT(spared, 100u);
}

// Columns of two cells, thin and narrow, where two shares that are each well enough leave tetrahedra of no quality: such faces
// are named where that quality is asked for, and few others.
TEST(MeshFaults, TetrahedraOfNoQualityAreNamed) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> off(-0.4, 0.4), power(-3, 0);
    QualityLimits asked;
    asked.tetQuality = 1e-15;
    int poor = 0, onlyIfAsked = 0;
    for (int i = 0; i < 20000; ++i) {
        std::vector<std::array<Vec3, 4>> levels{test::square(0), test::square(1), test::square(2)};
        const Vec3 scale{1, 0.03 * std::pow(10, power(random)), 0.03 * std::pow(10, power(random))};
        for (auto& level : levels)
            for (Vec3& p : level) p = {p.x + off(random), (p.y + off(random)) * scale.y, (p.z + off(random)) * scale.z};
        const PolyMesh mesh = test::columnOf(levels);
        const Rows cellFaces = buildCellFaces(mesh);
        const std::vector<std::int32_t> named = MeshFaults(mesh, cellFaces, asked).undividedFaces(), others = MeshFaults(mesh, cellFaces, {}).undividedFaces();
        EXPECT_TRUE(std::ranges::includes(named, others)) << "column " << i;
        const QualityReport report = measureQuality(mesh);
        const auto tets = std::ranges::find(report.dictionary, "minTetQuality", &DictionaryCheck::key);
        ASSERT_NE(tets, report.dictionary.end());
        EXPECT_GE(static_cast<std::int64_t>(named.size()), tets->faces) << "column " << i;
        poor += tets->faces > 0, onlyIfAsked += named.size() > others.size();
        if (named.size() > others.size()) { EXPECT_GT(tets->faces, 0) << "column " << i; }
    }
    EXPECT_GT(poor, 500);
    EXPECT_GT(onlyIfAsked, 10);
}

} // namespace
} // namespace i2b
