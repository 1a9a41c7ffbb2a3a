// Proves: a line that ends inside another part draws no node, nor does a border there; the line in which the two parts meet does;
// a sharp edge whose sides bend back to each other within a cell is folded on the wall as on the geometry; the rim of a thin sheet is found from its two sides.
#include "i2b/fit/between.h"
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

Vec3 areaOf(const Front& front, FrontMesh::FaceHandle f) {
    Positions x;
    for (auto v : front.mesh.fv_range(f)) x.push_back(wallPoint(front, static_cast<std::size_t>(v.idx())));
    Vec3 area;
    for (std::size_t i = 1; i + 1 < x.size(); ++i) area += cross(x[i] - x[0], x[i + 1] - x[0]);
    return area;
}

// The share of a line, away from its ends, that has an edge of the wall within 0.1 h that folds by more than 25 degrees.
double captured(const Front& front, const Vec3& from, const Vec3& to) {
    std::vector<std::array<Vec3, 2>> creases;
    for (auto e : front.mesh.edges()) {
        const auto he = front.mesh.halfedge_handle(e, 0);
        const auto f = front.mesh.face_handle(he), g = front.mesh.opposite_face_handle(he);
        if (!f.is_valid() || !g.is_valid()) continue;
        const Vec3 a = areaOf(front, f), b = areaOf(front, g);
        if (dot(a, b) < std::cos(25 * 3.14159265358979323846 / 180) * norm(a) * norm(b))
            creases.push_back({wallPoint(front, static_cast<std::size_t>(front.mesh.from_vertex_handle(he).idx())), wallPoint(front, static_cast<std::size_t>(front.mesh.to_vertex_handle(he).idx()))});
    }
    int samples = 0, found = 0;
    const double length = norm(to - from);
    for (double along = 1.5 * stagesSize; along < length - 1.5 * stagesSize; along += stagesSize / 4) {
        const Vec3 p = from + (to - from) * (along / length);
        ++samples;
        found += std::any_of(creases.begin(), creases.end(), [&](const auto& c) { return distanceToSegment(p, c[0], c[1]) <= 0.1 * stagesSize; });
    }
    return double(found) / samples;
}

void expectSound(const ToMesh& run) {
    EXPECT_EQ(run.front.validate(), "");
    const QualityReport q = measureQuality(run.mesh);
    EXPECT_EQ(q.openCells + q.openCellsByEdges + q.unusedPoints + q.duplicateFaces + q.faultyFaceVertices, 0);
}

class HiddenLine : public testing::TestWithParam<double> {}; // depth, in cells

// A plate that stands on a block and ends inside it, not far below its top.
TEST_P(HiddenLine, WhereThePartsMeetIsCaptured) {
    const ToMesh run(plateInTop(4 * stagesSize, GetParam() * stagesSize), stagesOptions());
    for (std::size_t i = 0; i < 4; ++i) EXPECT_GT(captured(run.front, plateFoot()[i], plateFoot()[(i + 1) % 4]), 0.9) << "side " << i;
    expectSound(run);
}

INSTANTIATE_TEST_SUITE_P(Depths, HiddenLine, testing::Values(0.1, 0.2, 0.35, 0.5, 1.0, 2.0));

class BentBack : public testing::TestWithParam<double> {}; // width of the strip, in cells

TEST_P(BentBack, SharpEdgeStaysSharp) {
    const ToMesh run(bentBack(GetParam() * stagesSize), stagesOptions());
    const auto [from, to] = bentBackLine();
    EXPECT_GT(captured(run.front, from, to), 0.95);
    expectSound(run);
}

INSTANTIATE_TEST_SUITE_P(Strips, BentBack, testing::Values(0.3, 0.45));

TEST(BentBackThreads, SameOnAnyNumber) {
    std::uint64_t sum = 0;
    for (const std::size_t threads : {1u, 3u}) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        const ToMesh run(bentBack(0.3 * stagesSize), stagesOptions());
        if (threads == 1) sum = run.front.checksum();
        EXPECT_EQ(run.front.checksum(), sum);
    }
}

// Two sheets 1 m wide that end in a rim at x = 0, which is a sharp edge.
struct ThinWedge {
    ThinWedge() {
        soup.points = {{0, 0, 0}, {0, 1, 0}, {-1, 0, 0.01}, {-1, 1, 0.01}, {-1, 0, -0.01}, {-1, 1, -0.01}};
        soup.triangles = {{0, 1, 3}, {0, 3, 2}, {0, 5, 1}, {0, 4, 5}};
        soup.partOf = {0, 0, 0, 0};
        soup.parts = {{"wedge", "", 4}};
    }
    Surface soup;
};

TEST(LineBetween, FindsTheRimOfAThinSheet) {
    const ThinWedge wedge;
    const SurfaceIndex index(wedge.soup);
    const FeatureIndex features(buildFeatureGraph(wedge.soup, {}));
    const double h = 0.1;
    for (const double in : {0.01, 0.05, 0.08}) {
        const Vec3 above{0.05, 0.5, 0.05};
        const Foot top = footAt(index, {-in, 0.5, 0.02}, above, h), bottom = footAt(index, {-in, 0.5, -0.02}, {0.05, 0.5, -0.05}, h);
        ASSERT_TRUE(top.found && bottom.found);
        const Between between = lineBetween(index, features, top, bottom, above, h);
        const bool isNear = in < 0.6 * h;
        EXPECT_EQ(between.line.found, isNear) << in;
        if (!isNear) continue;
        EXPECT_EQ(between.kind, SnapKind::line);
        EXPECT_NEAR(between.line.point.x, 0, 1e-12);
    }
}

TEST(BorderBetween, IsNotFoundBehindASurface) {
    Surface soup; // two squares side by side at z = 0, under a third one at 0.1
    soup.points = {{-1, 0, 0}, {-1, 1, 0}, {0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {1, 1, 0}, {-1, 0, 0.1}, {-1, 1, 0.1}, {1, 0, 0.1}, {1, 1, 0.1}};
    soup.triangles = {{0, 2, 1}, {1, 2, 3}, {2, 4, 3}, {3, 4, 5}, {6, 8, 7}, {7, 8, 9}};
    soup.partOf = {0, 0, 1, 1, 2, 2};
    soup.parts = {{"left", "", 2}, {"right", "", 2}, {"roof", "", 2}};
    const SurfaceIndex index(soup);
    const double h = 0.4;
    const auto borderFrom = [&](const Vec3& fluid) {
        return borderBetween(index, footAt(index, {-0.1, 0.5, 0.01}, fluid, h), footAt(index, {0.2, 0.5, 0.01}, fluid, h), fluid, h);
    };
    const Between seen = borderFrom({0, 0.5, 0.05});
    ASSERT_TRUE(seen.line.found);
    EXPECT_NEAR(seen.line.point.x, 0, 0.01);
    EXPECT_GT(std::abs(seen.line.tangent.y), 0.99);
    EXPECT_FALSE(borderFrom({0, 0.5, 0.3}).line.found);
}

TEST(LineOver, NeedsALineAsideOfTheWay) {
    Surface soup; // a ridge
    soup.points = {{-1, 0, 0}, {-1, 1, 0}, {0, 0, 0.3}, {0, 1, 0.3}, {1, 0, 0}, {1, 1, 0}};
    soup.triangles = {{0, 2, 1}, {1, 2, 3}, {2, 4, 3}, {3, 4, 5}};
    soup.partOf = {0, 0, 0, 0};
    soup.parts = {{"ridge", "", 4}};
    FeatureOptions options;
    options.angle = 20;
    const SurfaceIndex index(soup);
    const FeatureIndex features(buildFeatureGraph(soup, options));
    const auto over = [&](const Vec3& a, const Vec3& b) { return lineOver(index, features, a, b, {0, 0.5, 1}, 0.5).line.found; };
    EXPECT_TRUE(over({-0.3, 0.5, 0.21}, {0.3, 0.5, 0.21}));
    EXPECT_FALSE(over({-0.3, 0.5, 0.21}, {-0.05, 0.5, 0.285})); // on one side
    EXPECT_FALSE(over({-0.01, 0.5, 0.297}, {0.01, 0.5, 0.297})); // hardly aside
    EXPECT_FALSE(over({0.01, 0.2, 0.3}, {-0.01, 0.8, 0.3}));     // along it
}

} // namespace
} // namespace i2b::test
