// Proves: cells' faces are the owned ones and then the others, each ascending, whether the internal faces follow each other
// owner by owner or not, with cells that own none, and on any number of threads.
#include "i2b/assemble/mesh_topology.h"
#include <algorithm>
#include <gtest/gtest.h>
#include <random>
#include <tbb/global_control.h>

namespace i2b::test {
namespace {

// Owners and neighbours alone: cells that face each other at random, boundary faces at the end.
PolyMesh randomFaces(unsigned seed, std::int32_t cells, bool inOrder) {
    std::mt19937 random(seed);
    std::uniform_int_distribution<std::int32_t> any(0, cells - 1);
    std::vector<std::pair<std::int32_t, std::int32_t>> faces;
    for (std::int32_t i = 0; i < 3 * cells; ++i) {
        const std::int32_t a = any(random), b = any(random);
        if (a != b) faces.emplace_back(std::min(a, b), std::max(a, b));
    }
    if (inOrder) std::sort(faces.begin(), faces.end());
    PolyMesh mesh;
    mesh.cells = cells;
    for (const auto& [a, b] : faces) mesh.owner.push_back(a), mesh.neighbour.push_back(b);
    for (std::int32_t i = 0; i < cells / 2; ++i) mesh.owner.push_back(any(random));
    return mesh;
}

void expectFacesOfCells(const PolyMesh& mesh) {
    const Rows rows = buildCellFaces(mesh);
    std::vector<std::vector<std::int32_t>> plain(static_cast<std::size_t>(mesh.cells));
    for (std::size_t f = 0; f < mesh.owner.size(); ++f) plain[static_cast<std::size_t>(mesh.owner[f])].push_back(static_cast<std::int32_t>(f));
    for (std::size_t f = 0; f < mesh.neighbour.size(); ++f) plain[static_cast<std::size_t>(mesh.neighbour[f])].push_back(static_cast<std::int32_t>(f));
    ASSERT_EQ(rows.offsets.size(), plain.size() + 1);
    ASSERT_EQ(rows.items.size(), mesh.owner.size() + mesh.neighbour.size());
    for (std::int32_t c = 0; c < mesh.cells; ++c) ASSERT_TRUE(std::ranges::equal(rows[c], plain[static_cast<std::size_t>(c)])) << "cell " << c;
}

TEST(CellFaces, AreOwnedOnesThenOthers) {
    for (const int threads : {1, 3}) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
        for (const bool inOrder : {true, false}) {
            for (unsigned seed = 0; seed < 6; ++seed) expectFacesOfCells(randomFaces(seed, 7, inOrder));
            expectFacesOfCells(randomFaces(9, 20000, inOrder));
        }
    }
}

// One break in the order, where two of the looks at it meet.
TEST(CellFaces, ABreakInTheOrderIsSeenWhereverItIs) {
    for (const std::size_t at : {std::size_t(4095), std::size_t(4096), std::size_t(8191)}) {
        PolyMesh mesh = randomFaces(3, 5000, true);
        ASSERT_GT(mesh.neighbour.size(), at + 1);
        mesh.owner[at] = mesh.owner[at + 1] + 1;
        expectFacesOfCells(mesh);
    }
}

TEST(CellFaces, ASingleCellHasItsBoundaryAlone) {
    PolyMesh mesh;
    mesh.cells = 2;
    mesh.owner = {1, 0, 1};
    expectFacesOfCells(mesh);
}

} // namespace
} // namespace i2b::test
