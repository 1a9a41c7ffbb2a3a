// Proves: where a round wall is given in facets wider than a cell, the mesh follows the creases between them and lies nearer to it,
// and sharp edges keep their nodes; the angle from which it does is asked for.
#include "i2b/samples/sample.h"
#include "pipeline/stages_run.h"
#include <gtest/gtest.h>
#include <numbers>

namespace i2b::test {
namespace {

constexpr double radius = 1, half = 0.7; // m: facets of 0.35 m, cells of 0.1 m

// A drum of 18 facets, which fold by 20 degrees, turned by odd angles.
Surface drum() {
    samples::Loop2 outline;
    for (int i = 0; i < 18; ++i) {
        const double angle = 2 * std::numbers::pi * (i + 0.3) / 18;
        outline.push_back({radius * std::cos(angle), radius * std::sin(angle)});
    }
    Surface s;
    const samples::Frame frame{{0.02, 0.01, -half}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    addPart(s, samples::extrude(frame, outline, {}, {0, 2 * half}), "drum");
    const double a = 0.37, b = 0.21;
    for (Vec3& p : s.points) {
        p = {p.x * std::cos(a) - p.y * std::sin(a), p.x * std::sin(a) + p.y * std::cos(a), p.z};
        p = {p.x, p.y * std::cos(b) - p.z * std::sin(b), p.y * std::sin(b) + p.z * std::cos(b)};
    }
    return s;
}

struct Fitted : ToFront {
    Fitted(const Surface& soup, double creaseAngle) : ToFront(soup, stagesOptions()) {
        fitFront(front, lattice, *painted.index, buildFeatureGraph(soup, {.crease = creaseAngle}), FitOptions{}, Context());
    }
    double meanOff() const { // of the middles of faces, in h
        double sum = 0;
        for (auto f : front.mesh.faces()) {
            Vec3 middle;
            double n = 0;
            for (auto v : front.mesh.fv_range(f)) middle += wallPoint(front, static_cast<std::size_t>(v.idx())), ++n;
            sum += painted.index->closest(middle / n).distance;
        }
        return sum / (stagesSize * static_cast<double>(front.mesh.n_faces()));
    }
    // Share of places along edges of some kinds that an edge of the wall runs along, within 0.1 h.
    double followed(std::uint8_t kinds) const {
        Surface edges;
        edges.parts = {{"edges", "", 0}};
        for (auto e : front.mesh.edges()) {
            const auto h = front.mesh.halfedge_handle(e, 0);
            const auto n = static_cast<std::uint32_t>(edges.points.size());
            edges.points.push_back(wallPoint(front, std::size_t(front.mesh.from_vertex_handle(h).idx())));
            edges.points.push_back(wallPoint(front, std::size_t(front.mesh.to_vertex_handle(h).idx())));
            edges.triangles.push_back({n, n + 1, n + 1}), edges.partOf.push_back(0);
        }
        const SurfaceIndex near(edges);
        double all = 0, captured = 0;
        for (const FeatureEdge& e : graph.edges) {
            if (!(e.kinds & kinds)) continue;
            const Vec3 &a = graph.points[e.a], &b = graph.points[e.b], way = normalized(b - a);
            const auto runsAlong = [&](std::uint32_t i) { return std::abs(dot(normalized(edges.points[2 * i + 1] - edges.points[2 * i]), way)) > 0.87; };
            for (double t = 0.1; t < 0.9; t += 0.01, ++all) captured += bool(near.closest(a + (b - a) * t, 0.1 * stagesSize, runsAlong));
        }
        return captured / all;
    }
};

TEST(Creases, AreFollowed) {
    const Fitted with(drum(), 6), without(drum(), 180);
    EXPECT_EQ(with.front.validate(), "");
    EXPECT_LT(with.meanOff(), 0.4 * without.meanOff());
    EXPECT_GT(with.followed(bitOf(EdgeKind::crease)), 0.9);
    EXPECT_LT(without.followed(bitOf(EdgeKind::crease)), 0.7);
    EXPECT_GE(with.followed(bitOf(EdgeKind::sharp)), 0.99);
}

// Of a ball of fine facets, which fold by 4 degrees, faces stay whole quadrilaterals, until one asks for less.
TEST(Creases, FromTheAngleAskedFor) {
    const Surface ball = makeSample("sphere");
    const Fitted smooth(ball, 6), near(ball, 2);
    EXPECT_EQ(near.front.validate(), "");
    EXPECT_TRUE(smooth.front.inserted.empty());
    EXPECT_FALSE(near.front.inserted.empty());
    EXPECT_LT(near.meanOff(), 0.7 * smooth.meanOff());
}

} // namespace
} // namespace i2b::test
