// Proves: on a box whose wall nodes were put in bad places, mend() makes the poor faces vanish and never raises the worst;
// mendKeepingTets() does so without a face that ceases to divide; mendTets() makes all faces divide into tetrahedra within
// the limits, mendTetsOffWall() those that cannot on the wall; mendFlatAt() raises the determinants of thin cells at the
// cost of nothing else; pullIn() brings nodes back onto the geometry; snapWished() brings them to a line that they should
// be on, or leaves them be; no cell turns bad; the same on any number of threads.
#include "i2b/quality/measures.h"
#include "i2b/quality/mesh_geometry.h"
#include "i2b/quality/quality_report.h"
#include "repair/boxed.h"
#include <gtest/gtest.h>
#include <numbers>
#include <tbb/global_control.h>

namespace i2b::test {
namespace {

// The worst share of a limit over the whole mesh, as the report has it.
double worstShare(const PolyMesh& mesh) {
    constexpr double degree = std::numbers::pi / 180;
    const QualityLimits l = limitsOf();
    const QualityReport q = measureQuality(mesh);
    const double ortho = (1 - std::cos(q.maxNonOrthogonality * degree)) / (1 - std::cos(l.nonOrthogonality * degree));
    return std::max({ortho, q.maxSkewness / l.skewness, l.faceWeight / q.minFaceWeight, l.volumeRatio / q.minVolumeRatio,
                     l.determinant / q.minDeterminant});
}

// Places amid the sides of the box, away from edges and border, each with a way along its side.
struct Spot { Vec3 place, along; };
const std::vector<Spot> spots{{{0.6, 0.2, 0.6}, {1, 0.3, 0}}, {{-0.5, -0.3, 0.6}, {0.2, 1, 0}}, {{1, 0.1, 0.1}, {0, 1, 0.4}},
                              {{-1, -0.2, 0}, {0, 0.5, -1}}, {{-0.6, 0.8, 0.1}, {-1, 0, 0.1}}, {{0.5, 0.4, -0.6}, {1, -1, 0}}};

std::vector<std::size_t> displaceAlong(Boxed& b) {
    std::vector<std::size_t> moved;
    for (const Spot& s : spots) {
        const std::size_t v = b.nodeAt(s.place);
        b.put(v, b.wallOf(v) + normalized(s.along) * (1.1 * stagesSize));
        moved.push_back(v);
    }
    return moved;
}

// Of the cells from one on, ascending, those whose determinant is under a limit.
std::vector<std::int32_t> flatCells(const Boxed& b, std::int32_t from, double limit) {
    std::vector<std::int32_t> cells;
    CellFaceShapes shapes(b.run.mesh);
    for (std::int32_t c = from; c < b.run.mesh.cells; ++c)
        if (cellFullness(shapes.of(b.cellFaces[c])) < limit) cells.push_back(c);
    return cells;
}

TEST(Optimise, MendFlatRaisesDeterminantsOfThinCells) {
    QualityLimits limits = limitsOf(60);
    limits.determinant = 0.7; // a layer with cells as high as wide, most of which have more
    Boxed b(limits, true);
    const std::vector<std::int32_t> before = flatCells(b, b.thinFrom, limits.determinant);
    displaceAlong(b);
    std::vector<std::int32_t> flat;
    std::ranges::set_difference(flatCells(b, b.thinFrom, limits.determinant), before, std::back_inserter(flat));
    ASSERT_GT(flat.size(), 5u);
    const std::int64_t poor = b.poor();
    const std::size_t undivided = b.faults.undividedFaces().size();
    ASSERT_TRUE(b.faults.badCells().empty());
    b.optimiser.mendFlatAt(flat, 12);
    EXPECT_LE(flatCells(b, b.thinFrom, limits.determinant).size(), before.size() + flat.size() / 4);
    EXPECT_TRUE(b.faults.badCells().empty());
    EXPECT_LE(b.poor(), poor);
    EXPECT_LE(b.faults.undividedFaces().size(), undivided);
}

TEST(Optimise, MendMakesPoorFacesVanish) {
    Boxed b;
    ASSERT_EQ(b.poor(), 0);
    const std::vector<std::size_t> moved = displaceAlong(b);
    ASSERT_TRUE(b.faults.badCells().empty());
    const std::int64_t poor = b.poor();
    ASSERT_GT(poor, 5);
    double worst = worstShare(b.run.mesh);
    EXPECT_GT(worst, 1);
    std::int64_t moves = 0;
    for (int sweep = 0; sweep < 12; ++sweep) {
        moves += b.optimiser.mend(1);
        const double now = worstShare(b.run.mesh);
        EXPECT_LE(now, worst * (1 + 1e-12)) << "sweep " << sweep;
        worst = now;
    }
    EXPECT_GT(moves, 0);
    EXPECT_EQ(b.poor(), 0);
    EXPECT_LE(worst, 1);
    EXPECT_EQ(b.optimiser.mend(1), 0); // nothing left to do
    EXPECT_TRUE(b.faults.badCells().empty());
    EXPECT_EQ(b.run.mesh.validate(), "");
    for (const std::size_t v : moved) EXPECT_LT(b.offWall(v), 1e-9); // wall nodes glide on the wall
    // What was kept up to date is what a fresh look says, and the front is the mesh's.
    EXPECT_TRUE(MeshFaults(b.run.mesh, b.cellFaces, limitsOf()).badCells().empty());
    EXPECT_EQ(assemble({b.run.lattice, b.run.kept, b.run.front, b.run.layers, b.run.painted.soup.parts}).checksum(), b.run.mesh.checksum());
}

// Wall nodes beyond the diagonals of their faces: these divide again, and no other measure gets worse.
TEST(Optimise, MendTetsMakesFacesDivide) {
    Boxed b(limitsOf(64.5));
    ASSERT_TRUE(b.faults.undividedFaces().empty());
    const std::vector<std::size_t> moved = displaceAlong(b);
    const std::size_t undivided = b.faults.undividedFaces().size();
    ASSERT_GT(undivided, 5u);
    const double worst = worstShare(b.run.mesh);
    b.optimiser.mendTets(12);
    EXPECT_TRUE(b.faults.undividedFaces().empty());
    EXPECT_LE(worstShare(b.run.mesh), worst * (1 + 1e-12));
    EXPECT_TRUE(b.faults.badCells().empty());
    for (const std::size_t v : moved) EXPECT_LT(b.offWall(v), 1e-9);
    EXPECT_TRUE(MeshFaults(b.run.mesh, b.cellFaces, limitsOf()).undividedFaces().empty());
    EXPECT_EQ(assemble({b.run.lattice, b.run.kept, b.run.front, b.run.layers, b.run.painted.soup.parts}).checksum(), b.run.mesh.checksum());
}

// Under a limit that many faces are over, mend() trades faces that divide for lower angles; mendKeepingTets() does not.
TEST(Optimise, MendKeepingTetsLeavesFacesThatDivide) {
    std::size_t lost = 0;
    for (const bool keeps : {false, true}) {
        Boxed b(limitsOf(30));
        displaceAlong(b);
        const std::vector<std::int32_t> undivided = b.faults.undividedFaces();
        const std::int64_t poor = b.poor();
        for (int sweep = 0; sweep < 6; ++sweep) {
            keeps ? b.optimiser.mendKeepingTets(1) : b.optimiser.mend(1);
            std::vector<std::int32_t> fresh;
            std::ranges::set_difference(b.faults.undividedFaces(), undivided, std::back_inserter(fresh));
            if (keeps) EXPECT_TRUE(fresh.empty()) << "sweep " << sweep;
            else lost += fresh.size();
        }
        ASSERT_GT(poor, 100);
        EXPECT_EQ(b.poor(), 0);
        EXPECT_LT(b.faults.undividedFaces().size(), undivided.size());
        EXPECT_TRUE(b.faults.badCells().empty());
    }
    EXPECT_GT(lost, 0u); // of mend()
}

// A face of the wall folded shut between two nodes held to one corner: no move on the wall opens it.
TEST(Optimise, MendTetsOffWallOpensFoldedFaces) {
    Boxed b(limitsOf(64.5));
    const std::size_t a = b.nodeAt({0.6, 0.2, 0.6});
    std::size_t c = a; // across a face
    for (auto f : b.run.front.mesh.vf_range(FrontMesh::VertexHandle(static_cast<int>(a)))) {
        std::vector<std::size_t> face;
        for (auto v : b.run.front.mesh.fv_range(f)) face.push_back(static_cast<std::size_t>(v.idx()));
        if (face.size() == 4) c = face[static_cast<std::size_t>(std::ranges::find(face, a) - face.begin() + 2) % 4];
    }
    ASSERT_NE(c, a);
    const Vec3 middle = (b.wallOf(a) + b.wallOf(c)) * 0.5;
    for (const std::size_t v : {a, c}) {
        const Vec3 place = middle + (b.wallOf(v) - middle) * 1e-5;
        b.put(v, place), b.run.fitted.snaps[v] = {SnapKind::corner, place, {}};
    }
    const std::vector<std::int32_t> undivided = b.faults.undividedFaces();
    ASSERT_FALSE(undivided.empty());
    ASSERT_TRUE(b.faults.badCells().empty());
    const double worst = worstShare(b.run.mesh);
    b.optimiser.mendTetsOffWall(undivided, 16);
    EXPECT_TRUE(b.faults.undividedFaces().empty());
    EXPECT_TRUE(b.faults.badCells().empty());
    EXPECT_LE(worstShare(b.run.mesh), std::max(1.0, worst) * (1 + 1e-12));
    std::size_t left = 0;
    for (std::size_t v = 0; v < b.run.front.firstInserted(); ++v) {
        EXPECT_LT(b.offWall(v), 0.2 * stagesSize);
        left += b.offWall(v) > 0.01 * stagesSize;
    }
    EXPECT_LE(left, 4u);
    EXPECT_EQ(assemble({b.run.lattice, b.run.kept, b.run.front, b.run.layers, b.run.painted.soup.parts}).checksum(), b.run.mesh.checksum());
}

TEST(Optimise, PullInBringsNodesBack) {
    Boxed b;
    std::vector<std::size_t> moved;
    for (const Spot& s : spots) {
        moved.push_back(b.nodeAt(s.place));
        const std::size_t v = moved.back();
        b.put(v, b.wallOf(v) + (b.run.front.front[v] - b.wallOf(v)) * 0.4);
        EXPECT_GT(b.offWall(v), 0.02 * stagesSize);
    }
    EXPECT_GE(b.optimiser.pullIn(3), static_cast<std::int64_t>(spots.size()));
    for (const std::size_t v : moved) EXPECT_LT(b.offWall(v), 1e-9);
    EXPECT_EQ(b.poor(), 0);
    EXPECT_TRUE(b.faults.badCells().empty());
    EXPECT_EQ(b.run.mesh.validate(), "");
    EXPECT_EQ(assemble({b.run.lattice, b.run.kept, b.run.front, b.run.layers, b.run.painted.soup.parts}).checksum(), b.run.mesh.checksum());
}

// A line beside a node takes it; one that no valid cell could reach does not; a node that is held already stays.
TEST(Optimise, SnapWishedMovesNodesToTheirLine) {
    Boxed b;
    const std::size_t near = b.nodeAt({0.6, 0.2, 0.6}), far = b.nodeAt({-0.5, -0.3, 0.6}), held = b.nodeAt({1, 0.1, 0.1});
    const Vec3 heldAt = b.wallOf(held), farAt = b.wallOf(far);
    const Vec3 along{0, 1, 0}, through = b.wallOf(near) + Vec3{0.15 * stagesSize, 0.1 * stagesSize, 0};
    b.wishes[near] = {SnapKind::implicitLine, through, along};
    b.wishes[far] = {SnapKind::implicitLine, farAt + Vec3{3 * stagesSize, 0, 0}, along};
    b.wishes[held] = {SnapKind::implicitLine, heldAt + Vec3{0, 0.1 * stagesSize, 0}, {0, 0, 1}};
    b.run.fitted.snaps[held] = {SnapKind::corner, heldAt, {}};
    EXPECT_EQ(b.optimiser.snapWished(2), 1);
    const Vec3 way = b.wallOf(near) - through;
    EXPECT_LT(norm(way - along * dot(way, along)), 1e-12);
    EXPECT_LT(b.offWall(near), 1e-12);
    EXPECT_EQ(b.run.fitted.snaps[near].kind, SnapKind::implicitLine);
    EXPECT_EQ(b.wallOf(far), farAt);
    EXPECT_EQ(b.run.fitted.snaps[far].kind, SnapKind::none);
    EXPECT_EQ(b.wallOf(held), heldAt);
    EXPECT_EQ(b.run.fitted.snaps[held].kind, SnapKind::corner);
    EXPECT_EQ(b.poor(), 0);
    EXPECT_TRUE(b.faults.badCells().empty());
}

TEST(Optimise, SameOnAnyNumberOfThreads) {
    std::uint64_t sum = 0;
    for (const std::size_t threads : {1u, 2u, 3u}) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        Boxed b;
        displaceAlong(b);
        EXPECT_GT(b.optimiser.mend(12), 0);
        const std::size_t v = b.nodeAt({0.1, -0.4, -0.6});
        b.put(v, b.wallOf(v) + (b.run.front.front[v] - b.wallOf(v)) * 0.4);
        EXPECT_GT(b.optimiser.pullIn(3), 0);
        if (threads == 1) sum = b.run.mesh.checksum();
        EXPECT_EQ(b.run.mesh.checksum(), sum) << threads << " threads";
    }
}

} // namespace
} // namespace i2b::test
