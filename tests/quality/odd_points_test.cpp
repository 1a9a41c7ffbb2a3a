#include "i2b/quality/odd_points.h"
#include "i2b/quality/quality_report.h"
#include "quality/shaken_block.h"
#include <algorithm>
#include <gtest/gtest.h>
#include <random>

namespace i2b {
namespace {

using Index = std::size_t;

// Some faces with their vertices in disorder, others made triangles or the doubles of others.
PolyMesh disordered(unsigned seed) {
    std::mt19937 random(seed);
    PolyMesh mesh = test::shakenBlock(4, 0.1, random);
    std::vector<std::vector<std::int32_t>> loops;
    for (std::int32_t f = 0; f < mesh.faces(); ++f) loops.emplace_back(mesh.face(f).begin(), mesh.face(f).end());
    for (auto& loop : loops) {
        const unsigned what = static_cast<unsigned>(random() % 40);
        if (what == 0) std::shuffle(loop.begin(), loop.end(), random);
        if (what < 6) loop.pop_back();
        if (what == 6) loop = loops[random() % loops.size()];
        if (what == 7) {
            const auto& other = loops[random() % loops.size()];
            for (const std::int32_t p : other)
                if (std::ranges::find(loop, p) == loop.end() && loop.size() < 7) loop.push_back(p);
        }
    }
    mesh.faceVertices.clear(), mesh.faceOffsets.assign(1, 0);
    for (const auto& loop : loops) {
        mesh.faceVertices.insert(mesh.faceVertices.end(), loop.begin(), loop.end());
        mesh.faceOffsets.push_back(static_cast<std::uint32_t>(mesh.faceVertices.size()));
    }
    return mesh;
}

bool followEachOther(std::span<const std::int32_t> v, std::int32_t a, std::int32_t b) {
    for (Index i = 0; i < v.size(); ++i) {
        const std::int32_t here = v[i], next = v[(i + 1) % v.size()];
        if ((here == a && next == b) || (here == b && next == a)) return true;
    }
    return false;
}

// Every pair of points that two faces share and that is a diagonal of one of them has its lower point marked, and so has the lowest point of
// two triangles that are the same; of a mesh in order no point is.
TEST(OddPoints, AreAllFound) {
    int diagonals = 0, triangles = 0, unmarked = 0;
    for (unsigned seed = 0; seed < 30; ++seed) {
        const PolyMesh mesh = disordered(seed);
        const OddPoints odd = oddPoints(mesh);
        EXPECT_FALSE(odd.isAnyTwice);
        unmarked += static_cast<int>(std::ranges::count(odd.marks, 0));
        for (std::int32_t f = 0; f < mesh.faces(); ++f)
            for (std::int32_t g = 0; g < f; ++g) {
                std::vector<std::int32_t> shared;
                for (const std::int32_t p : mesh.face(f))
                    if (std::ranges::find(mesh.face(g), p) != mesh.face(g).end()) shared.push_back(p);
                std::ranges::sort(shared);
                for (Index i = 0; i < shared.size(); ++i)
                    for (Index k = i + 1; k < shared.size(); ++k) {
                        if (followEachOther(mesh.face(f), shared[i], shared[k]) && followEachOther(mesh.face(g), shared[i], shared[k])) continue;
                        ++diagonals;
                        EXPECT_TRUE(odd.marks[Index(shared[i])]) << "seed " << seed << ", faces " << f << ", " << g;
                    }
                if (shared.size() != 3 || mesh.face(f).size() != 3 || mesh.face(g).size() != 3) continue;
                ++triangles;
                EXPECT_TRUE(odd.marks[Index(shared[0])]) << "seed " << seed << ", triangles " << f << ", " << g;
            }
    }
    EXPECT_GT(diagonals, 500);
    EXPECT_GT(triangles, 5);
    EXPECT_GT(unmarked, 1000);
    std::mt19937 random(1);
    const OddPoints none = oddPoints(test::shakenBlock(6, 0.2, random));
    EXPECT_EQ(std::ranges::count(none.marks, 0), 343);
}

// Where more diagonals meet at a point than there is room for they are looked for at their other ends: a fan of squares around one point.
TEST(OddPoints, ManyDiagonalsAtAPoint) {
    PolyMesh mesh;
    constexpr std::int32_t squares = 40;
    mesh.faceOffsets.push_back(0);
    for (std::int32_t i = 0; i < squares; ++i) {
        for (const std::int32_t p : {0, 2 * i + 1, 2 * i + 2, 2 * ((i + 1) % squares) + 1}) mesh.faceVertices.push_back(p);
        mesh.faceOffsets.push_back(static_cast<std::uint32_t>(mesh.faceVertices.size()));
    }
    mesh.points.resize(2 * squares + 1);
    mesh.owner.assign(squares, 0);
    mesh.cells = 1;
    EXPECT_EQ(std::ranges::count(oddPoints(mesh).marks, 1), 0);
    for (const std::int32_t p : {0, 2 * 30 + 2, 2 * 5 + 1}) mesh.faceVertices.push_back(p); // an edge where a late square has its diagonal
    mesh.faceOffsets.push_back(static_cast<std::uint32_t>(mesh.faceVertices.size()));
    mesh.owner.push_back(0);
    EXPECT_TRUE(oddPoints(mesh).marks[0]);
    mesh.faceVertices[1] = 0;
    EXPECT_TRUE(oddPoints(mesh).isAnyTwice);
}

} // namespace
} // namespace i2b
