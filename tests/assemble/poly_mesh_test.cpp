#include "i2b/assemble/poly_mesh.h"
#include "quality/cell_mesh.h"
#include <gmock/gmock.h>
#include <tbb/global_control.h>

namespace i2b::test {
namespace {

using testing::HasSubstr;

// Sound meshes have nothing to report, polyhedra with hanging nodes included.
TEST(PolyMeshValidate, AcceptsSoundMeshes) {
    EXPECT_EQ(columnOf({square(0), square(1), square(2)}).validate(), "");
    EXPECT_EQ(levelJump().validate(), "");
}

// Each fault is found and named; the checks go from array sizes to closed cells.
TEST(PolyMeshValidate, NamesTheFault) {
    const PolyMesh sound = levelJump();
    const auto faultAfter = [&](const auto& change) {
        PolyMesh mesh = sound;
        change(mesh);
        return mesh.validate();
    };
    EXPECT_THAT(faultAfter([](PolyMesh& m) { m.faceOffsets.pop_back(); }), HasSubstr("face offsets"));
    EXPECT_THAT(faultAfter([](PolyMesh& m) { m.cellLevel.resize(1); }), HasSubstr("cell level"));
    EXPECT_THAT(faultAfter([](PolyMesh& m) { m.faceVertices[3] = 99; }), HasSubstr("point 99"));
    EXPECT_THAT(faultAfter([](PolyMesh& m) { m.owner.back() = m.cells; }), HasSubstr("owned by cell"));
    EXPECT_THAT(faultAfter([](PolyMesh& m) { m.points[2].x = NAN; }), HasSubstr("not finite"));
    EXPECT_THAT(faultAfter([](PolyMesh& m) { std::swap(m.owner[0], m.neighbour[0]); }),
                HasSubstr("not lower"));
    EXPECT_THAT(faultAfter([](PolyMesh& m) { std::swap(m.neighbour[0], m.neighbour[1]); }),
                HasSubstr("upper triangular"));
    EXPECT_THAT(faultAfter([](PolyMesh& m) { ++m.patches[0].start; }), HasSubstr("patch wall"));
    EXPECT_THAT(faultAfter([](PolyMesh& m) { --m.patches[0].count; }), HasSubstr("patches end"));
    EXPECT_THAT(faultAfter([](PolyMesh& m) { m.zones.push_back({"z", {1, 1}}); }), HasSubstr("zone z"));
    EXPECT_THAT(faultAfter([](PolyMesh& m) { m.faceVertices[0] = m.faceVertices[1]; }), HasSubstr("twice"));
    EXPECT_THAT(faultAfter([](PolyMesh& m) { m.points.push_back({}); }), HasSubstr("used by no face"));
    // The last boundary face turned over: same points, but its edges no longer pair up.
    EXPECT_THAT(faultAfter([](PolyMesh& m) { std::reverse(m.faceVertices.end() - 4, m.faceVertices.end()); }),
                HasSubstr("not closed"));
}

// The checksum sees every array that counts, and no optional data.
TEST(PolyMeshChecksum, CoversTheMesh) {
    const PolyMesh mesh = levelJump();
    PolyMesh other = mesh;
    other.cellLevel.assign(static_cast<std::size_t>(mesh.cells), 3);
    EXPECT_EQ(other.checksum(), mesh.checksum());
    other.points[0].x = 1e-300;
    EXPECT_NE(other.checksum(), mesh.checksum());
    other = mesh;
    std::swap(other.faceVertices[0], other.faceVertices[1]);
    EXPECT_NE(other.checksum(), mesh.checksum());
    other = mesh;
    other.patches[0].name = "inlet";
    EXPECT_NE(other.checksum(), mesh.checksum());
    other = mesh;
    other.zones.push_back({"fluid", {0}});
    EXPECT_NE(other.checksum(), mesh.checksum());
}

// Of several faults the first is reported, whatever the number of threads.
TEST(PolyMeshValidate, SameOnAnyNumberOfThreads) {
    std::vector<std::array<Vec3, 4>> levels;
    for (int i = 0; i < 30000; ++i) levels.push_back(square(i));
    PolyMesh mesh = columnOf(levels);
    for (const std::size_t p : {100000U, 50000U, 70000U}) mesh.points[p].y = INFINITY;
    for (const std::size_t threads : {1, 2, 8}) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        EXPECT_EQ(mesh.validate(), "point 50000 is not finite");
    }
}

} // namespace
} // namespace i2b::test
