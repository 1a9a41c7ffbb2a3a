// Proves: the foot of a step lower than a cell has mesh edges along it, and so has the edge at its top: nodes go to it and vertices
// are put on it, each face beside it lies on one part, and no two nodes of an edge are drawn to one place.
#include "i2b/quality/quality_report.h"
#include "pipeline/stages_run.h"
#include <gtest/gtest.h>
#include <tbb/global_control.h>

namespace i2b::test {
namespace {

double distanceToSegment(const Vec3& p, const Vec3& a, const Vec3& b) {
    const Vec3 d = b - a;
    return norm(p - a - d * std::clamp(dot(p - a, d) / norm2(d), 0.0, 1.0));
}

Vec3 faceNormal(const Front& front, FrontMesh::FaceHandle f) {
    Positions x;
    for (auto v : front.mesh.fv_range(f)) x.push_back(wallPoint(front, static_cast<std::size_t>(v.idx())));
    Vec3 area;
    for (std::size_t i = 1; i + 1 < x.size(); ++i) area += cross(x[i] - x[0], x[i + 1] - x[0]);
    return normalized(area);
}

// Of an outline, away from its corners: the share that has an edge between faces that isBorder() takes within 0.1 h.
template <class IsBorder>
double captured(const Front& front, const std::array<Vec3, 4>& foot, const IsBorder& isBorder) {
    int samples = 0, found = 0;
    for (std::size_t i = 0; i < 4; ++i) {
        const Vec3 a = foot[i], way = foot[(i + 1) % 4] - a;
        const double length = norm(way);
        for (double along = 1.5 * stagesSize; along < length - 1.5 * stagesSize; along += stagesSize / 4) {
            const Vec3 p = a + way * (along / length);
            ++samples;
            found += std::any_of(front.mesh.edges_begin(), front.mesh.edges_end(), [&](FrontMesh::EdgeHandle e) {
                const auto he = front.mesh.halfedge_handle(e, 0);
                const FrontMesh::FaceHandle f = front.mesh.face_handle(he), g = front.mesh.opposite_face_handle(he);
                if (!f.is_valid() || !g.is_valid() || !isBorder(f, g)) return false;
                return distanceToSegment(p, wallPoint(front, static_cast<std::size_t>(front.mesh.from_vertex_handle(he).idx())),
                                         wallPoint(front, static_cast<std::size_t>(front.mesh.to_vertex_handle(he).idx()))) <= 0.1 * stagesSize;
            });
        }
    }
    return double(found) / samples;
}

// By edges between the two parts.
double captured(const Front& front, const std::array<Vec3, 4>& foot) {
    return captured(front, foot, [&](auto f, auto g) { return front.part[static_cast<std::size_t>(f.idx())] != front.part[static_cast<std::size_t>(g.idx())]; });
}

// By edges that fold by over 25 degrees.
double folded(const Front& front, const std::array<Vec3, 4>& outline) {
    return captured(front, outline, [&](auto f, auto g) { return dot(faceNormal(front, f), faceNormal(front, g)) < 0.906; });
}

void expectSound(const ToMesh& run) {
    EXPECT_EQ(run.front.validate(), "");
    const QualityReport q = measureQuality(run.mesh);
    EXPECT_EQ(q.openCells + q.openCellsByEdges + q.unusedPoints + q.duplicateFaces + q.faultyFaceVertices, 0);
    for (auto e : run.front.mesh.edges()) {
        const auto he = run.front.mesh.halfedge_handle(e, 0);
        const auto a = static_cast<std::size_t>(run.front.mesh.from_vertex_handle(he).idx()), b = static_cast<std::size_t>(run.front.mesh.to_vertex_handle(he).idx());
        EXPECT_GT(norm(wallPoint(run.front, a) - wallPoint(run.front, b)), 0.02 * stagesSize);
    }
}

class LowStep : public testing::TestWithParam<double> {}; // height, in cells

TEST_P(LowStep, FootIsCaptured) {
    // Where the lattice happens to lie decides over some samples of each height: less is asked of those beside it.
    for (const double height : {0.97 * GetParam(), GetParam(), 1.03 * GetParam()}) {
        SCOPED_TRACE(testing::Message() << height << " h");
        const ToMesh run(plateInTop(height * stagesSize), stagesOptions());
        std::array<Vec3, 4> top = plateFoot();
        for (Vec3& p : top) p.z += height * stagesSize;
        const double bar = height == GetParam() ? 0.8 : 0.7;
        EXPECT_GT(captured(run.front, plateFoot()), bar);
        EXPECT_GT(folded(run.front, top), bar);
        expectSound(run);
    }
}

INSTANTIATE_TEST_SUITE_P(Heights, LowStep, testing::Values(0.4, 0.6, 0.8));

class NarrowLedge : public testing::TestWithParam<double> {}; // width, in cells

TEST_P(NarrowLedge, FootIsCaptured) {
    const ToMesh run(lidOnTop(GetParam() * stagesSize), stagesOptions());
    EXPECT_GT(captured(run.front, lidFoot()), 0.95);
    expectSound(run);
}

INSTANTIATE_TEST_SUITE_P(Widths, NarrowLedge, testing::Values(0.4, 0.45, 0.5, 0.6));

TEST(LowStepThreads, SameOnAnyNumber) {
    std::uint64_t sum = 0;
    for (const std::size_t threads : {1u, 3u}) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        const ToMesh run(plateInTop(0.4 * stagesSize), stagesOptions());
        if (threads == 1) sum = run.front.checksum();
        EXPECT_EQ(run.front.checksum(), sum);
    }
}

} // namespace
} // namespace i2b::test
