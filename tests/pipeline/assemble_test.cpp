// Proves: assembled from random kept cells at the start of the fit, with one layer and with several, in
// several zones, and with counts that differ from part to part, the mesh is valid to the last face and every cell right way out.
#include "carve/kept_checks.h"
#include "i2b/assemble/assemble.h"
#include "i2b/carve/carve.h"
#include "i2b/fit/fit.h"
#include "i2b/quality/quality_report.h"
#include <gtest/gtest.h>
#include <tbb/global_control.h>

namespace i2b::test {
namespace {

struct Assembled {
    Assembled(const CellGrid& grid, const KeptCells& kept, const std::vector<Part>& parts, int layers)
        : lattice(grid, kept), front(buildFront(lattice, startThickness)) {
        LayerOptions options;
        options.count = layers;
        stack = makeLayers(front, options);
        for (std::size_t f = 0; f < front.part.size(); ++f)
            front.part[f] = static_cast<std::int32_t>(f % parts.size());
        mesh = assemble({lattice, kept, front, stack, parts});
    }
    LatticeMesh lattice;
    Front front;
    LayerStack stack;
    PolyMesh mesh;
};

void expectSound(const PolyMesh& mesh, const std::string& what) {
    EXPECT_EQ(mesh.validate(), "") << what;
    const QualityReport q = measureQuality(mesh);
    EXPECT_EQ(q.negativeVolumeCells, 0) << what;
    EXPECT_EQ(q.wrongOrientedFaces, 0) << what;
    EXPECT_EQ(q.openCells, 0) << what;
    EXPECT_EQ(q.openCellsByEdges, 0) << what;
    EXPECT_EQ(q.unusedPoints + q.duplicateFaces, 0) << what;
    EXPECT_TRUE(q.upperTriangular) << what;
}

class RandomAssembly : public testing::TestWithParam<unsigned> {};

TEST_P(RandomAssembly, IsValid) {
    const std::vector<Part> parts{{"left", "", 1}, {"right", "", 1}, {"unused", "", 0}};
    for (unsigned seed = 10 * GetParam(); seed < 10 * GetParam() + 10; ++seed) {
        const CarvedAtRandom c(seed, {5, 6, 4}, 1 + static_cast<int>(seed % 3),
                               1 + static_cast<int>(seed / 3 % 2), 0.05 + 0.05 * (seed % 7), seed % 2 == 1);
        for (int layers : {1, 3}) {
            const Assembled a(c.grid, c.kept, parts, layers);
            expectSound(a.mesh, "seed " + std::to_string(seed) + ", layers " + std::to_string(layers));
            EXPECT_EQ(a.mesh.cells, static_cast<std::int64_t>(c.kept.cellCount()) +
                                        layers * static_cast<std::int64_t>(a.front.ownerCell.size()));
            std::int64_t wall = 0;
            for (const Patch& p : a.mesh.patches) wall += p.type == "wall" ? p.count : 0;
            EXPECT_EQ(wall, static_cast<std::int64_t>(
                                a.front.ownerCell.size())); // every front face has its wall face
            const auto core = static_cast<std::size_t>(a.lattice.pointCount()), n = static_cast<std::size_t>(layers);
            for (std::size_t v = 0; v < a.front.front.size(); ++v) { // stacks run from the front to the wall
                const auto& wall = a.front.mesh.point(FrontMesh::VertexHandle(static_cast<int>(v)));
                EXPECT_EQ(a.mesh.points[static_cast<std::size_t>(a.front.corePoint[v])], a.front.front[v]);
                EXPECT_EQ(a.mesh.points[core + v * n + n - 1], (Vec3{wall[0], wall[1], wall[2]}));
            }
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Many, RandomAssembly, testing::Range(0u, 4u));

// A quarter of the wall each for four parts, by the halves of the box in x and y.
void assignQuarters(Front& front) {
    Box box;
    for (const Vec3& p : front.front) box.add(p);
    for (std::size_t f = 0; f < front.part.size(); ++f) {
        const auto v = static_cast<std::size_t>(front.mesh.fv_begin(FrontMesh::FaceHandle(static_cast<int>(f)))->idx());
        const Vec3 d = front.front[v] - box.centre();
        front.part[f] = (d.x > 0) + 2 * (d.y > 0);
    }
}

// Stacks of different counts side by side: all cells are closed, cells of a stack lie one on the other from its front face
// to its wall face, and the mesh is the same on any number of threads.
TEST_P(RandomAssembly, OfMixedCountsIsValid) {
    const std::vector<Part> parts{{"a", "", 1}, {"b", "", 1}, {"c", "", 1}, {"d", "", 1}};
    for (unsigned seed = 10 * GetParam(); seed < 10 * GetParam() + 5; ++seed) {
        const CarvedAtRandom c(seed, {5, 6, 4}, 1 + static_cast<int>(seed % 3), 1, 0.05 + 0.05 * (seed % 7), seed % 2 == 1);
        const LatticeMesh lattice(c.grid, c.kept);
        Front front = buildFront(lattice, startThickness);
        assignQuarters(front);
        LayerOptions options;
        options.count = 4;
        if (seed % 2 == 0) options.first = 0.012, options.unit = LayerUnit::cell; // five cells, four where there is no room
        options.parts = {{"b", 0}, {"c", 1}, {"d", 7, 0, 0, 1.4}};
        const LayerStack stack = makeLayers(front, plansOf(options, parts));
        ASSERT_EQ(stack.validate(front), "");
        const PolyMesh mesh = assemble({lattice, c.kept, front, stack, parts});
        const std::string what = "seed " + std::to_string(seed);
        expectSound(mesh, what);
        EXPECT_EQ(mesh.cells, static_cast<std::int64_t>(c.kept.cellCount() + stack.cells())) << what;
        EXPECT_EQ(mesh.points.size(), static_cast<std::size_t>(lattice.pointCount()) + stack.points()) << what;
        std::vector<int> wallFaces(static_cast<std::size_t>(mesh.cells), 0);
        for (const Patch& p : mesh.patches) {
            for (std::int32_t f = p.start; p.type == "wall" && f < p.start + p.count; ++f) ++wallFaces[static_cast<std::size_t>(mesh.owner[static_cast<std::size_t>(f)])];
        }
        for (std::size_t f = 0; f < stack.faces; ++f) {
            const std::size_t first = c.kept.cellCount() + stack.cellOffset(f);
            const auto cells = static_cast<std::size_t>(stack.cellsOf(f));
            for (std::size_t k = 0; k < cells; ++k) {
                ASSERT_EQ(wallFaces[first + k], k + 1 == cells ? 1 : 0) << what;
                ASSERT_EQ(mesh.cellLayer[first + k], cells - k) << what;
            }
        }
        for (std::size_t threads : {1, 2, 3}) {
            const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
            EXPECT_EQ(assemble({lattice, c.kept, front, makeLayers(front, plansOf(options, parts)), parts}).checksum(), mesh.checksum()) << what;
        }
    }
}

// Kept cells, prisms and zones add up; the sum of the cells' volumes is that of the kept cells and the
// prisms.
TEST(Assembly, ZonesHoldTheirCells) {
    int zoned = 0;
    for (unsigned seed = 4; seed < 104; seed += caseKinds) {
        const RandomCase c = randomCase(seed);
        try {
            const Painted p(c);
            const KeptCells kept = carve(p.grid, p.cut, p.regions, *p.index, c.options.fit);
            const Assembled a(p.grid, kept, p.soup.parts, c.options.layers.count);
            expectSound(a.mesh, "seed " + std::to_string(seed));
            if (kept.zones.empty()) {
                EXPECT_TRUE(a.mesh.zones.empty());
                continue;
            }
            ++zoned;
            ASSERT_EQ(a.mesh.zones.size(), kept.zones.size());
            std::vector<int> zoneOf(static_cast<std::size_t>(a.mesh.cells), -1);
            for (std::size_t z = 0; z < a.mesh.zones.size(); ++z) {
                EXPECT_EQ(a.mesh.zones[z].name, kept.zoneNames[z]);
                for (std::int32_t cell : a.mesh.zones[z].cells)
                    zoneOf[static_cast<std::size_t>(cell)] = static_cast<int>(z);
            }
            EXPECT_EQ(std::count(zoneOf.begin(), zoneOf.end(), -1), 0); // all cells belong somewhere
            for (std::size_t f = 0; f < a.mesh.neighbour.size();
                 ++f) { // and no face leads from one zone to another
                ASSERT_EQ(zoneOf[static_cast<std::size_t>(a.mesh.owner[f])],
                          zoneOf[static_cast<std::size_t>(a.mesh.neighbour[f])]);
            }
            for (std::size_t threads : {1, 3}) {
                const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
                EXPECT_EQ(Assembled(p.grid, kept, p.soup.parts, c.options.layers.count).mesh.checksum(),
                          a.mesh.checksum());
            }
        } catch (const Error& e) {
            EXPECT_EQ(e.kind(), ErrorKind::input) << e.problem();
        }
    }
    EXPECT_GE(zoned, 3);
}

} // namespace
} // namespace i2b::test
