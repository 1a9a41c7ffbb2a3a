// Proves, on plates without thickness in random poses: the wall around one is a single piece, tips and all; nodes at its rim do not
// stop on the way; and no corner draws two nodes, between which a face would collapse; and the
// reports are of what is left where nodes at the rim have become one.
#include "i2b/program/generate.h"
#include "pipeline/shapes.h"
#include "pipeline/shape_run.h"
#include "pipeline/stages_run.h"
#include "pipeline/temporary_stl.h"
#include <algorithm>
#include <gtest/gtest.h>
#include <numbers>
#include <numeric>

namespace i2b::test {
namespace {

const Shape& plateShape() {
    const auto plate = std::find_if(shapes().begin(), shapes().end(), [](const Shape& s) { return std::string(s.name) == "plate"; });
    return *plate;
}

// Of faces that share vertices.
std::size_t pieces(const FrontMesh& mesh) {
    std::vector<int> root(mesh.n_vertices());
    std::iota(root.begin(), root.end(), 0);
    const auto find = [&](int v) {
        while (root[std::size_t(v)] != v) v = root[std::size_t(v)] = root[std::size_t(root[std::size_t(v)])];
        return v;
    };
    for (auto e : mesh.edges()) {
        const auto he = mesh.halfedge_handle(e, 0);
        root[std::size_t(find(mesh.from_vertex_handle(he).idx()))] = find(mesh.to_vertex_handle(he).idx());
    }
    std::size_t n = 0;
    for (std::size_t v = 0; v < root.size(); ++v) n += root[v] == int(v);
    return n;
}

constexpr unsigned poses = 12;

class ThinPlatePoses : public testing::TestWithParam<unsigned> {}; // seed of the pose

TEST_P(ThinPlatePoses, AreOnePieceWithOneNodeACorner) {
    const ShapeGeometry g = posed(plateShape(), stagesSize, GetParam());
    const ToMesh run(g.soup, stagesOptions());
    EXPECT_EQ(run.front.validate(), "");
    EXPECT_EQ(pieces(run.front.mesh), 1u);

    std::vector<Vec3> corners;
    for (const Snap& s : run.fitted.snaps)
        if (s.kind == SnapKind::corner) corners.push_back(s.point);
    for (std::size_t i = 0; i < corners.size(); ++i)
        for (std::size_t j = 0; j < i; ++j) EXPECT_GT(norm(corners[i] - corners[j]), 0.5 * stagesSize);
}

INSTANTIATE_TEST_SUITE_P(Many, ThinPlatePoses, testing::Range(0u, poses));

// 6 % of them did when all nodes had the same number of sweeps.
TEST(ThinPlates, FewNodesStopOnTheWay) {
    std::size_t nodes = 0, far = 0;
    for (unsigned seed = 0; seed < poses; ++seed) {
        const ShapeGeometry g = posed(plateShape(), stagesSize, seed);
        const ToMesh run(g.soup, stagesOptions());
        for (std::size_t v = 0; v < run.front.front.size(); ++v) far += !run.painted.index->closest(wallPoint(run.front, v), 0.1 * stagesSize);
        nodes += run.front.front.size();
    }
    EXPECT_LT(double(far), 0.04 * double(nodes));
}

// What is said of faces and nodes is of those that are left when pairs of nodes at the rim have become one.
TEST(ThinPlates, ReportsCountWhatIsLeftAtClosedRims) {
    const ShapeGeometry g = posed(plateShape(), 0.065, 7);
    const TemporaryStl file(g.soup);
    Options options;
    options.geometry.files = {file.path()};
    options.size.surface = 0.065, options.size.max = 0.26;
    options.domain.box = Box{{-1.3, -1.3, -1.3}, {1.3, 1.3, 1.3}};
    options.domain.flow = Flow::external;
    options.layers.count = 3;
    Context context;
    const MeshResult result = generate(options, context);
    EXPECT_EQ(result.mesh.validate(), "");
    EXPECT_EQ(result.report.quality->dictionaryFaces, 0);
    const auto stage = std::ranges::find_if(result.report.stages, [](const auto& s) { return s.name == "rims"; });
    ASSERT_NE(stage, result.report.stages.end());
    EXPECT_GT(stage->items, 5u);
    std::int64_t walls = 0, reported = 0;
    for (const Patch& patch : result.mesh.patches) walls += patch.type == "wall" ? patch.count : 0;
    for (const LayerRow& row : result.report.layers->parts) reported += row.faces;
    EXPECT_EQ(result.report.wallFaces, walls);
    EXPECT_EQ(reported, walls);
    std::vector<std::int32_t> cells;
    for (const Patch& patch : result.mesh.patches)
        if (patch.type == "wall") cells.assign(result.mesh.owner.begin() + patch.start, result.mesh.owner.begin() + patch.start + patch.count);
    std::ranges::sort(cells);
    cells.erase(std::ranges::unique(cells).begin(), cells.end());
    EXPECT_EQ(result.walls.wallCell, cells);
    EXPECT_EQ(result.offCauses.size(), result.wallNodes.points.size());
}

// A tube of strips from end to end, open at both; m.
Surface openTube(double radius, double length, int strips) {
    Surface tube;
    for (int i = 0; i < strips; ++i) {
        const double angle = 2 * std::numbers::pi * i / strips;
        for (const double z : {0.0, length}) tube.points.push_back({radius * std::cos(angle), radius * std::sin(angle), z});
    }
    const auto n = static_cast<std::uint32_t>(2 * strips);
    for (std::uint32_t a = 0; a < n; a += 2) {
        const std::uint32_t b = (a + 2) % n;
        tube.triangles.push_back({a, b, b + 1}), tube.triangles.push_back({a, b + 1, a + 1});
    }
    tube.parts = {Part{"tube", "", 0}};
    tube.partOf.assign(tube.triangles.size(), 0);
    return tube;
}

MeshResult meshTube(const Surface& tube, double size) {
    const TemporaryStl file(tube);
    Options options;
    options.geometry.files = {file.path()};
    options.size.surface = size;
    options.domain.flow = Flow::external;
    options.layers.count = 3;
    Context context;
    return generate(options, context);
}

// A valid mesh with more of its wall nodes on the geometry, and less of its wall faces tilted, than that (shares).
void expectSmooth(const MeshResult& result, double onGeometry, double tilted) {
    EXPECT_EQ(result.mesh.validate(), "");
    EXPECT_EQ(result.report.quality->dictionaryFaces, 0);
    EXPECT_GT(result.report.fit->wallNodesOnGeometryFraction, onGeometry);
    EXPECT_LT(result.report.fit->tiltedFaceFraction, tilted);
}

// A ring of sheet metal: both rims are met by nearly every node, and few faces stand across them.
TEST(ThinSheets, BothRimsOfAnOpenTubeAreMet) { expectSmooth(meshTube(openTube(0.06, 0.01, 96), 0.00284), 0.99, 0.02); }

// Where both rims are a third of a cell past planes of the lattice, rows of nodes beside them are as near as those beyond, which have to
// come from farther. Left where they were, 97.7 % of the nodes were on the geometry and 89 % of the rims captured; with straight columns 98.2 and 91.
TEST(ThinSheets, RimsBetweenPlanesOfTheLatticeAreMet) {
    constexpr double length = 0.011;
    double onGeometry = 0, captured = 0;
    for (const double past : {0.2, 0.3, 0.4}) {
        const MeshResult result = meshTube(openTube(0.0264, length, 136), length / 2 / (4 + past));
        expectSmooth(result, 0.96, 0.005);
        EXPECT_GT(result.report.fit->featureSamples, 500);
        onGeometry += result.report.fit->wallNodesOnGeometryFraction / 3;
        captured += result.report.fit->featureCaptureFraction / 3;
    }
    EXPECT_GT(onGeometry, 0.985);
    EXPECT_GT(captured, 0.94);
}

// As CAD programs write extruded walls: strips over a thousand times as long as wide. The wall is as smooth on them as on any triangles.
TEST(ThinSheets, WallsOfLongStripsAreSmooth) { expectSmooth(meshTube(openTube(0.1, 1, 800), 0.02), 0.995, 0.01); }

} // namespace
} // namespace i2b::test
