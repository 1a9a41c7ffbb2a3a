// Proves: uniting cells and dividing faces leaves a valid mesh of the same volume with the same points, in which cells, faces,
// patches, zones and data are what they should be; the same on any number of threads.
#include "i2b/assemble/edit_mesh.h"
#include "i2b/assemble/mesh_topology.h"
#include "quality/shaken_block.h"
#include <algorithm>
#include <gtest/gtest.h>
#include <numeric>
#include <random>
#include <tbb/global_control.h>

namespace i2b::test {
namespace {

using Index = std::size_t;

PolyMesh block() {
    std::mt19937 random(3);
    PolyMesh mesh = shakenBlock(4, 0.1, random);
    for (std::int32_t c = 0; c < mesh.cells; ++c) {
        mesh.cellLevel.push_back(static_cast<std::uint8_t>(c % 5));
        mesh.cellLayer.push_back(static_cast<std::uint8_t>(c % 4));
        mesh.cellRegion.push_back(c % 3);
    }
    return mesh;
}

MeshEdits nothing(const PolyMesh& mesh) {
    MeshEdits edits;
    edits.groups.resize(Index(mesh.cells));
    std::iota(edits.groups.begin(), edits.groups.end(), 0);
    return edits;
}

// By the divergence theorem, of each cell.
std::vector<double> volumes(const PolyMesh& mesh) {
    std::vector<double> sum(Index(mesh.cells), 0);
    for (std::int32_t f = 0; f < mesh.faces(); ++f) {
        const auto v = mesh.face(f);
        Vec3 mean;
        for (const std::int32_t p : v) mean += mesh.points[Index(p)] / static_cast<double>(v.size());
        double flow = 0;
        for (Index i = 0; i < v.size(); ++i)
            flow += dot(mean, cross(mesh.points[Index(v[i])] - mean, mesh.points[Index(v[(i + 1) % v.size()])] - mean)) / 6;
        sum[Index(mesh.owner[Index(f)])] += flow;
        if (f < mesh.internalFaces()) sum[Index(mesh.neighbour[Index(f)])] -= flow;
    }
    return sum;
}

TEST(EditMesh, NothingChangesNothing) {
    const PolyMesh before = block();
    PolyMesh mesh = before;
    const std::vector<std::int32_t> numbers = editMesh(mesh, nothing(mesh));
    EXPECT_EQ(mesh.checksum(), before.checksum());
    EXPECT_EQ(numbers, nothing(before).groups);
    EXPECT_EQ(mesh.cellLayer, before.cellLayer);
}

TEST(EditMesh, UnitesTwoCells) {
    const PolyMesh before = block();
    for (std::int32_t f = 0; f < before.internalFaces(); f += 7) {
        PolyMesh mesh = before;
        mesh.zones = {{"zone", {before.owner[Index(f)], before.neighbour[Index(f)]}}};
        const std::int32_t a = before.owner[Index(f)], b = before.neighbour[Index(f)];
        MeshEdits edits = nothing(mesh);
        edits.groups[Index(b)] = a;
        const std::vector<std::int32_t> numbers = editMesh(mesh, edits);
        ASSERT_EQ(mesh.validate(), "") << f;
        EXPECT_EQ(mesh.cells, before.cells - 1);
        EXPECT_EQ(mesh.faces(), before.faces() - 1);
        EXPECT_EQ(mesh.points.size(), before.points.size());
        EXPECT_EQ(numbers[Index(a)], a);
        EXPECT_EQ(numbers[Index(b)], a);
        for (std::int32_t c = 0; c < before.cells; ++c)
            EXPECT_EQ(numbers[Index(c)], c == b ? a : c < b ? c : c - 1);
        const std::vector<double> old = volumes(before), now = volumes(mesh);
        for (std::int32_t c = 0; c < before.cells; ++c) {
            if (c == a || c == b) continue;
            EXPECT_DOUBLE_EQ(now[Index(numbers[Index(c)])], old[Index(c)]);
        }
        EXPECT_NEAR(now[Index(a)], old[Index(a)] + old[Index(b)], 1e-14);
        EXPECT_EQ(mesh.zones.front().cells, RawVector<std::int32_t>{a});
        EXPECT_EQ(mesh.cellLevel[Index(a)], before.cellLevel[Index(a)]);
        EXPECT_EQ(mesh.cellRegion[Index(a)], before.cellRegion[Index(a)]);
        const std::uint8_t x = before.cellLayer[Index(a)], y = before.cellLayer[Index(b)]; // 0: none
        EXPECT_EQ(mesh.cellLayer[Index(a)], x == 0 ? y : y == 0 ? x : std::min(x, y));
    }
}

// Of any face, from any of its vertices.
TEST(EditMesh, DividesAFace) {
    const PolyMesh before = block();
    const std::vector<double> old = volumes(before);
    for (std::int32_t f = 0; f < before.faces(); f += 5) {
        for (std::uint32_t from = 0; from < 4; ++from) {
            PolyMesh mesh = before;
            MeshEdits edits = nothing(mesh);
            edits.divided = {{f, from}};
            editMesh(mesh, edits);
            ASSERT_EQ(mesh.validate(), "") << f;
            EXPECT_EQ(mesh.faces(), before.faces() + 1);
            EXPECT_EQ(mesh.internalFaces(), before.internalFaces() + (f < before.internalFaces() ? 1 : 0));
            for (const std::int32_t piece : {f, f + 1}) {
                const auto v = mesh.face(piece);
                ASSERT_EQ(v.size(), 3u);
                EXPECT_EQ(v[0], before.face(f)[from]);
                EXPECT_EQ(mesh.owner[Index(piece)], before.owner[Index(f)]);
            }
            if (f >= before.internalFaces()) continue; // the block itself is another then
            const std::vector<double> now = volumes(mesh);
            EXPECT_NEAR(std::accumulate(now.begin(), now.end(), 0.0), std::accumulate(old.begin(), old.end(), 0.0), 1e-12);
        }
    }
}

// Many changes at once: every third cell takes in a neighbour, faces around divided.
TEST(EditMesh, SameOnAnyNumberOfThreads) {
    const PolyMesh before = block();
    const Rows cellFaces = buildCellFaces(before);
    MeshEdits edits = nothing(before);
    std::vector<std::uint8_t> taken(Index(before.cells), 0);
    std::mt19937 random(11);
    std::int64_t merged = 0, divided = 0;
    for (std::int32_t f = 0; f < before.faces(); ++f) {
        const Index a = Index(before.owner[Index(f)]), b = f < before.internalFaces() ? Index(before.neighbour[Index(f)]) : a;
        if (a != b && !taken[a] && !taken[b] && random() % 6 == 0) {
            taken[a] = taken[b] = 1, edits.groups[b] = static_cast<std::int32_t>(a), ++merged;
        } else if (random() % 3 == 0) {
            edits.divided.emplace_back(f, static_cast<std::uint32_t>(random() % 4));
        }
    }
    ASSERT_GT(merged, 5);
    for (const auto& [f, from] : edits.divided)
        divided += f >= before.internalFaces() || edits.groups[Index(before.owner[Index(f)])] != edits.groups[Index(before.neighbour[Index(f)])];
    std::uint64_t sum = 0;
    for (const std::size_t threads : {1u, 2u, 3u}) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        PolyMesh mesh = before;
        editMesh(mesh, edits);
        ASSERT_EQ(mesh.validate(), "");
        EXPECT_EQ(mesh.cells, before.cells - merged);
        EXPECT_EQ(mesh.faces(), before.faces() - merged + divided);
        if (threads == 1) sum = mesh.checksum();
        EXPECT_EQ(mesh.checksum(), sum) << threads << " threads";
    }
}

// In a mesh of which most faces stay side by side, more of them than threads share at once: what is far from the changes is as it was,
// but for its numbers.
TEST(EditMesh, LeavesLongRunsAsTheyWere) {
    std::mt19937 random(5);
    const PolyMesh before = shakenBlock(24, 0.1, random);
    MeshEdits edits = nothing(before);
    const Index f = before.neighbour.size() / 2;
    const std::int32_t low = before.owner[f], high = before.neighbour[f];
    edits.groups[Index(high)] = low;
    edits.divided = {{static_cast<std::int32_t>(f / 2), 1u}, {before.internalFaces() + 7, 2u}};
    PolyMesh mesh = before;
    const std::vector<std::int32_t> numbers = editMesh(mesh, edits);
    ASSERT_EQ(mesh.validate(), "");
    EXPECT_EQ(mesh.faces(), before.faces() + 1);
    std::int32_t now = 0;
    for (std::int32_t was = 0; was < before.faces(); ++was) {
        const auto touches = [&](std::int32_t cell) { return cell == low || cell == high; };
        if (touches(before.owner[Index(was)]) || (was < before.internalFaces() && touches(before.neighbour[Index(was)]))) continue;
        if (was == edits.divided[0].first || was == edits.divided[1].first) continue;
        while (now < mesh.faces() && !std::ranges::equal(mesh.face(now), before.face(was))) ++now; // in the order of before
        ASSERT_LT(now, mesh.faces()) << was;
        EXPECT_EQ(mesh.owner[Index(now)], numbers[Index(before.owner[Index(was)])]);
        if (was < before.internalFaces()) {
            EXPECT_EQ(mesh.neighbour[Index(now)], numbers[Index(before.neighbour[Index(was)])]);
        }
    }
}

} // namespace
} // namespace i2b::test
