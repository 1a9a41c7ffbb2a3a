// Proves: the vertex of a divided edge comes into every polygon along that edge and into no other; a mesh whose front has
// divided edges and cut faces is closed, each edge of a cell lies in two of its faces, and every cell is right way out.
#include "i2b/assemble/divided_edges.h"
#include "i2b/quality/quality_report.h"
#include "pipeline/shape_run.h"
#include "pipeline/stages_run.h"
#include <gtest/gtest.h>
#include <map>

namespace i2b::test {
namespace {

Front frontWith(const std::vector<std::array<std::int32_t, 2>>& ends) {
    Front front;
    front.corePoints = 10;
    for (std::int32_t p = 0; p < 10; ++p) front.corePoint.push_back(9 - p); // vertex numbers are not core points
    front.front.resize(10);
    for (const auto& e : ends) {
        front.corePoint.push_back(front.corePoints + static_cast<std::int32_t>(front.inserted.size()));
        front.inserted.push_back({e, 0.5});
        front.front.emplace_back();
    }
    return front;
}

std::vector<std::int32_t> divided(const DividedEdges& edges, const std::vector<std::int32_t>& polygon) {
    std::array<std::int32_t, 16> room{};
    std::copy(polygon.begin(), polygon.end(), room.begin());
    const std::size_t n = edges.addTo(room, polygon.size());
    return {room.begin(), room.begin() + static_cast<std::ptrdiff_t>(n)};
}

using Points = std::vector<std::int32_t>;

TEST(DividedEdges, AddTheirVertices) {
    const DividedEdges edges(frontWith({{0, 1}, {3, 1}, {9, 7}})); // core points 9-8, 6-8, 0-2
    EXPECT_EQ(divided(edges, {9, 8, 3, 4}), (Points{9, 10, 8, 3, 4}));
    EXPECT_EQ(divided(edges, {4, 8, 9, 3}), (Points{4, 8, 10, 9, 3}));     // the other way round
    EXPECT_EQ(divided(edges, {8, 3, 4, 9}), (Points{8, 3, 4, 9, 10}));     // from the last to the first
    EXPECT_EQ(divided(edges, {9, 8, 6, 2, 0}), (Points{9, 10, 8, 11, 6, 2, 12, 0}));
    EXPECT_EQ(divided(edges, {9, 6, 0, 1, 3}), (Points{9, 6, 0, 1, 3}));   // ends, but not of one edge
    EXPECT_EQ(divided(edges, {9, 3, 8, 6}), (Points{9, 3, 8, 11, 6}));     // across a corner is no edge
    EXPECT_EQ(divided(DividedEdges(frontWith({})), {9, 8, 6, 2}), (Points{9, 8, 6, 2}));
}

// Cells with an edge that is not in exactly two of their faces, once each way.
std::size_t openByEdges(const PolyMesh& mesh) {
    std::vector<std::map<std::pair<std::int32_t, std::int32_t>, int>> ways(static_cast<std::size_t>(mesh.cells));
    for (std::int32_t f = 0; f < mesh.faces(); ++f) {
        const auto v = mesh.face(f);
        for (std::size_t i = 0; i < v.size(); ++i) {
            const std::int32_t a = v[i], b = v[(i + 1) % v.size()];
            ++ways[static_cast<std::size_t>(mesh.owner[static_cast<std::size_t>(f)])][{a, b}];
            if (f < mesh.internalFaces()) ++ways[static_cast<std::size_t>(mesh.neighbour[static_cast<std::size_t>(f)])][{b, a}];
        }
    }
    std::size_t open = 0;
    for (const auto& cell : ways) {
        open += !std::all_of(cell.begin(), cell.end(), [&](const auto& way) {
            const auto back = cell.find({way.first.second, way.first.first});
            return way.second == 1 && back != cell.end() && back->second == 1;
        });
    }
    return open;
}

void expectSound(const PolyMesh& mesh, const std::string& what) {
    EXPECT_EQ(mesh.validate(), "") << what;
    EXPECT_EQ(openByEdges(mesh), 0u) << what;
    const QualityReport q = measureQuality(mesh);
    EXPECT_EQ(q.negativeVolumeCells + q.wrongOrientedFaces, 0) << what;
    EXPECT_EQ(q.openCells + q.openCellsByEdges, 0) << what;
    EXPECT_EQ(q.unusedPoints + q.duplicateFaces + q.faultyFaceVertices + q.baffleFaces, 0) << what;
    EXPECT_TRUE(q.upperTriangular) << what;
}

class DividedFront : public testing::TestWithParam<unsigned> {};

// Random kept cells of several levels, one edge in five divided, layers of one count or of several.
TEST_P(DividedFront, GivesAClosedMesh) {
    const std::vector<Part> parts{{"a", "", 1}, {"b", "", 1}};
    std::size_t inserted = 0, cut = 0;
    for (unsigned seed = 6 * GetParam(); seed < 6 * GetParam() + 6; ++seed) {
        const CarvedAtRandom c(seed, {5, 6, 4}, 1 + static_cast<int>(seed % 3), 1, 0.05 + 0.05 * (seed % 7), seed % 2 == 1);
        const LatticeMesh lattice(c.grid, c.kept);
        Front front = buildFront(lattice, startThickness);
        const std::size_t faces = front.part.size();
        divideAtRandom(front, seed, 0.2);
        ASSERT_EQ(front.validate(), "") << "seed " << seed;
        inserted += front.inserted.size(), cut += front.part.size() - faces;
        for (std::size_t f = 0; f < front.part.size(); ++f) front.part[f] = front.ownerCell[f] % 2;
        for (const bool mixed : {false, true}) {
            LayerOptions options;
            options.count = 3;
            if (mixed) options.parts = {{"b", 1}};
            const LayerStack layers = makeLayers(front, plansOf(options, parts));
            ASSERT_EQ(layers.validate(front), "") << "seed " << seed;
            const PolyMesh mesh = assemble({lattice, c.kept, front, layers, parts});
            expectSound(mesh, "seed " + std::to_string(seed));
            EXPECT_EQ(mesh.points.size(), static_cast<std::size_t>(lattice.pointCount()) + front.inserted.size() + layers.points());
            for (std::size_t v = front.firstInserted(); v < front.front.size(); ++v)
                EXPECT_EQ(mesh.points[static_cast<std::size_t>(front.corePoint[v])], front.front[v]);
        }
    }
    EXPECT_GT(inserted, 50u);
    EXPECT_GT(cut, 10u);
}

INSTANTIATE_TEST_SUITE_P(Many, DividedFront, testing::Range(0u, 4u));

// Where the fit itself puts vertices in, which it seldom does: the same.
TEST(DividedFront, OfTheFitGivesAClosedMesh) {
    std::size_t inserted = 0;
    for (const Shape& shape : shapes()) {
        if (std::string(shape.name) != "crossed-boxes" && std::string(shape.name) != "gear") continue;
        for (unsigned pose = 0; pose < 2; ++pose) {
            const ToMesh run(posed(shape, stagesSize, pose).soup, stagesOptions());
            inserted += run.front.inserted.size();
            EXPECT_EQ(run.front.inserted.size(), run.fitted.inserted);
            EXPECT_EQ(run.mesh.validate(), "");
            EXPECT_EQ(openByEdges(run.mesh), 0u);
            const QualityReport q = measureQuality(run.mesh);
            EXPECT_EQ(q.openCells + q.openCellsByEdges + q.unusedPoints + q.duplicateFaces + q.faultyFaceVertices, 0);
            EXPECT_TRUE(q.upperTriangular);
        }
    }
    EXPECT_GT(inserted, 0u);
}

} // namespace
} // namespace i2b::test
