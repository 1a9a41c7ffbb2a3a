// Proves: nodes taken off the sharp edges of a box come back to them, beside other nodes and at a corner, and the wall captures as much of the
// edges as before; no cell is poor for it, the front is the mesh's, and nothing happens where all is captured or nothing may be sought; the
// same on any number of threads. Parts of what has moved are apart, and each goes back by itself.
#include "i2b/repair/moved_parts.h"
#include "i2b/repair/recapture.h"
#include "i2b/quality/sharp_samples.h"
#include "repair/boxed.h"
#include <gtest/gtest.h>
#include <set>
#include <tbb/global_control.h>

namespace i2b::test {
namespace {

// Limits as in the repair, so that there is room for nodes to move.
struct Edged : Boxed {
    Edged() : Boxed(limitsOf(64.5)) {}
    WallGuide guide() { return {*run.painted.index, run.features, run.fitted.snaps, wishes, &run.graph}; }
    double captured() const { return measureFit(run.mesh, cellFaces, *run.painted.index, run.graph).featureCaptureFraction; }
    std::int64_t seek() { return recapture(run.mesh, cellFaces, faults, run.front, guide(), optimiser); }
    // Every so many-th node held to a kind of feature is let go and comes off it, so far, h, towards its front node, where that leaves its cells good.
    std::size_t takeOff(SnapKind kind, std::size_t step, double way) {
        std::size_t taken = 0, seen = 0;
        for (std::size_t v = 0; v < run.front.firstInserted(); ++v) {
            if (run.fitted.snaps[v].kind != kind || seen++ % step != 0) continue;
            const Vec3 from = wallOf(v);
            put(v, from + normalized(run.front.front[v] - from) * (way * stagesSize));
            if (poor() > 0 || !faults.badCells().empty()) {
                put(v, from);
                continue;
            }
            run.fitted.snaps[v] = {};
            ++taken;
        }
        return taken;
    }
    std::uint64_t assembled() { return assemble({run.lattice, run.kept, run.front, run.layers, run.painted.soup.parts}).checksum(); }
};

TEST(Recapture, BringsNodesBackToEdges) {
    Edged e;
    ASSERT_EQ(e.poor(), 0);
    const double before = e.captured();
    const std::size_t taken = e.takeOff(SnapKind::line, 5, 0.3);
    ASSERT_GT(taken, 10u);
    ASSERT_LT(e.captured(), before - 0.05);
    const std::size_t undivided = e.faults.undividedFaces().size();
    EXPECT_GT(e.seek(), 0);
    EXPECT_GE(e.captured(), before - 0.002);
    EXPECT_EQ(e.poor(), 0);
    EXPECT_TRUE(e.faults.badCells().empty());
    EXPECT_LE(e.faults.undividedFaces().size(), undivided);
    EXPECT_EQ(e.assembled(), e.run.mesh.checksum());
}

// Without corners the edges beside them are lost, too: nodes at both are taken off.
TEST(Recapture, BringsNodesBackToCorners) {
    Edged e;
    const double before = e.captured();
    ASSERT_GT(e.takeOff(SnapKind::corner, 1, 0.4), 2u);
    ASSERT_GT(e.takeOff(SnapKind::line, 2, 0.3), 20u);
    const auto heldToCorners = [&] { return std::ranges::count(e.run.fitted.snaps, SnapKind::corner, &Snap::kind); };
    const auto left = heldToCorners();
    ASSERT_LT(e.captured(), before - 0.1);
    EXPECT_GT(e.seek(), 0);
    EXPECT_GE(e.captured(), before - 0.01);
    EXPECT_GT(heldToCorners(), left);
    EXPECT_EQ(e.poor(), 0);
    EXPECT_EQ(e.assembled(), e.run.mesh.checksum());
}

TEST(Recapture, LeavesAWallThatHasItsEdgesAsItIs) {
    Edged e;
    while (e.seek() > 0) {}
    const std::uint64_t checksum = e.run.mesh.checksum();
    EXPECT_EQ(e.seek(), 0);
    EXPECT_EQ(e.run.mesh.checksum(), checksum);
}

TEST(Recapture, SameOnAnyNumberOfThreads) {
    std::uint64_t sum = 0;
    for (const std::size_t threads : {1u, 2u, 3u}) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        Edged e;
        e.takeOff(SnapKind::line, 4, 0.3);
        e.seek();
        if (threads == 1) sum = e.run.mesh.checksum();
        EXPECT_EQ(e.run.mesh.checksum(), sum) << threads << " threads";
    }
}

TEST(MovedParts, GoBackEachByItself) {
    Edged e;
    const std::uint64_t checksum = e.run.mesh.checksum();
    e.optimiser.track();
    std::vector<Optimiser::NodeMove> moves;
    for (const Vec3& place : {Vec3{0.6, 0.2, 0.6}, Vec3{-0.5, -0.3, 0.6}, Vec3{1, 0.1, 0.1}}) {
        const auto v = static_cast<std::int32_t>(e.nodeAt(place));
        std::int32_t cell = -1;
        MeshNodes::Moved points;
        e.optimiser.nodes().follow({MeshNode::wall, v}, e.wallOf(static_cast<std::size_t>(v)), points);
        for (std::int32_t f = 0; f < e.run.mesh.faces() && cell < 0; ++f) {
            const auto face = e.run.mesh.face(f);
            if (std::ranges::find(face, points.back().first) != face.end()) cell = e.run.mesh.owner[static_cast<std::size_t>(f)];
        }
        moves.push_back({{MeshNode::wall, v}, cell, e.wallOf(static_cast<std::size_t>(v)) + Vec3{0.02, 0.01, 0}});
    }
    e.optimiser.moveTogether(moves);
    const MovedParts parts(e.optimiser);
    ASSERT_EQ(parts.nodes.size(), 3u);
    EXPECT_EQ(std::set<std::int32_t>(parts.partOf.begin(), parts.partOf.end()).size(), 3u);
    for (const auto& [cell, part] : parts.changed) { // read by its part, and by no other
        std::vector<std::int32_t> readers;
        MovedParts::forPartsOf(parts.read, cell, [&](std::int32_t p) { readers.push_back(p); });
        EXPECT_EQ(readers, std::vector<std::int32_t>{part});
    }
    e.optimiser.moveBack({parts.nodes[1]});
    EXPECT_EQ(e.optimiser.tracked().size(), 2u);
    EXPECT_NE(e.run.mesh.checksum(), checksum);
    e.optimiser.moveBack({parts.nodes[0], parts.nodes[2]});
    EXPECT_EQ(e.run.mesh.checksum(), checksum);
}

} // namespace
} // namespace i2b::test
