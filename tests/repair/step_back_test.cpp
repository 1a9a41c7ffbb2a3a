// Proves: faces that neither single moves nor changes of the mesh make divide do so after the nodes around them went back together,
// and nothing else is worse for it; where that does not help, and wherever moves are undone, all is as it was, to the bit.
#include "i2b/edit/last_resort.h"
#include "i2b/repair/step_back.h"
#include "repair/boxed.h"
#include <gtest/gtest.h>
#include <random>

namespace i2b::test {
namespace {

// All nodes of a wall vertex and those around it to random places: a squeezed wall.
void scramble(Boxed& b, std::size_t vertex, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> by(-0.8 * stagesSize, 0.8 * stagesSize);
    std::vector<std::size_t> ring{vertex};
    for (auto v : b.run.front.mesh.vv_range(FrontMesh::VertexHandle(static_cast<int>(vertex)))) ring.push_back(static_cast<std::size_t>(v.idx()));
    for (const std::size_t v : ring) b.put(v, b.wallOf(v) + Vec3{by(random), by(random), by(random)});
}

std::uint64_t checksumOf(Boxed& b) {
    return assemble({b.run.lattice, b.run.kept, b.run.front, b.run.layers, b.run.painted.soup.parts}).checksum();
}

TEST(StepBack, MendsWhatNothingElseMends) {
    std::int64_t tried = 0, mended = 0;
    for (unsigned seed = 0; seed < 24; ++seed) {
        SCOPED_TRACE(seed);
        Boxed b(limitsOf(64.5));
        const DictionaryLimits limits;
        scramble(b, b.nodeAt({0.6, 0.2, 0.6}), seed);
        if (!b.faults.badCells().empty()) continue;
        const std::vector<std::int32_t> before = facesBeyondHelp(b.run.mesh, b.cellFaces, b.faults.undividedFaces(), limits);
        if (before.empty()) continue;
        const std::int64_t poor = b.poor();
        const std::uint64_t checksum = b.run.mesh.checksum();
        tried += static_cast<std::int64_t>(before.size());
        const std::int64_t now =
            stepBackFrom(before, {b.run.mesh, b.cellFaces, b.faults, b.run.front, b.run.lattice, startThickness, limits}, b.optimiser);
        mended += now;
        EXPECT_TRUE(b.faults.badCells().empty());
        EXPECT_LE(b.poor(), poor);
        EXPECT_LE(facesBeyondHelp(b.run.mesh, b.cellFaces, b.faults.undividedFaces(), limits).size(), before.size() - static_cast<std::size_t>(now));
        EXPECT_EQ(b.run.mesh.checksum() == checksum, now == 0);
        EXPECT_EQ(checksumOf(b), b.run.mesh.checksum()); // the front is the mesh's
        // What was kept up to date is what a fresh look says.
        EXPECT_EQ(MeshFaults(b.run.mesh, b.cellFaces, limitsOf(64.5)).undividedFaces(), b.faults.undividedFaces());
    }
    EXPECT_GT(tried, 30);
    EXPECT_GT(mended, tried / 4);
}

TEST(StepBack, UndoneMovesLeaveNoTrace) {
    Boxed b;
    scramble(b, b.nodeAt({0.6, 0.2, 0.6}), 3);
    ASSERT_GT(b.poor(), 0);
    const std::uint64_t checksum = b.run.mesh.checksum();
    const std::vector<std::int32_t> undivided = b.faults.undividedFaces();
    const std::int64_t poor = b.poor();
    b.optimiser.track();
    EXPECT_GT(b.optimiser.mend(4), 0);
    b.optimiser.mendTetsOffWall(undivided, 4);
    ASSERT_NE(b.run.mesh.checksum(), checksum);
    b.optimiser.undo();
    EXPECT_EQ(b.run.mesh.checksum(), checksum);
    EXPECT_EQ(checksumOf(b), checksum);
    EXPECT_EQ(b.faults.undividedFaces(), undivided);
    EXPECT_EQ(b.poor(), poor);
}

} // namespace
} // namespace i2b::test
