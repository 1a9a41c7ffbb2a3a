// Proves: vertices are put into those wall edges only that cross a border or an edge, they lie on it, and afterwards each
// face of the front lies on one side; with the fit's own snaps and without any; the same on any number of threads.
#include "i2b/fit/insert.h"
#include "pipeline/stages_run.h"
#include <gtest/gtest.h>
#include <map>
#include <tbb/global_control.h>

namespace i2b::test {
namespace {

// A fit without features, and the positions of the band's nodes after it: nothing is snapped to anything.
struct Unsnapped : ToFront {
    explicit Unsnapped(const Surface& soup) : ToFront(soup, stagesOptions()), band(buildBand(lattice, front, 2)), snaps(band.walls) {
        FitOptions options;
        options.features = false;
        fitFront(front, lattice, *painted.index, graph, options, Context());
        x = band.start;
        std::map<std::int32_t, Vec3> moved;
        for (std::size_t i = 0; i < front.movedPoints.size(); ++i) moved[front.movedPoints[i]] = front.movedTo[i];
        for (std::size_t n = band.walls; n < band.nodes(); ++n)
            if (const auto at = moved.find(band.corePoint[n - band.walls]); at != moved.end()) x[n] = at->second;
        for (std::size_t v = 0; v < band.walls; ++v) x[v] = wallPoint(front, v), x[static_cast<std::size_t>(band.frontNode[v])] = front.front[v];
    }
    std::size_t insert() { return insertVertices(front, band, *painted.index, features, x, snaps); }
    Band band;
    std::vector<Vec3> x;
    std::vector<Snap> snaps;
};

// What holds of inserted vertices wherever they come from.
void expectOnTheirEdges(const Front& front, const SurfaceIndex& index) {
    EXPECT_EQ(front.validate(), "");
    for (std::size_t i = 0; i < front.inserted.size(); ++i) {
        const std::size_t v = front.firstInserted() + i;
        const auto& [ends, t] = front.inserted[i];
        const auto p = static_cast<std::size_t>(ends[0]), q = static_cast<std::size_t>(ends[1]);
        ASSERT_LT(p, front.firstInserted());
        ASSERT_LT(q, front.firstInserted());
        EXPECT_GT(t, 0.1);
        EXPECT_LT(t, 0.9);
        EXPECT_EQ(front.corePoint[v], front.corePoints + static_cast<std::int32_t>(i));
        EXPECT_LT(norm(front.front[v] - (front.front[p] + (front.front[q] - front.front[p]) * t)), 1e-14);
        EXPECT_LT(index.closest(wallPoint(front, v)).distance, 1e-9);
        EXPECT_FALSE(front.mesh.find_halfedge(FrontMesh::VertexHandle(ends[0]), FrontMesh::VertexHandle(ends[1])).is_valid()); // is divided
        for (const std::int32_t e : ends)
            EXPECT_TRUE(front.mesh.find_halfedge(FrontMesh::VertexHandle(e), FrontMesh::VertexHandle(static_cast<int>(v))).is_valid());
    }
}

// Per face how far it reaches over a border, m: the lesser of its two sides.
std::vector<double> reachOver(const Front& front, const std::function<double(const Vec3&)>& side) {
    std::vector<double> reach;
    for (auto f : front.mesh.faces()) {
        double low = 0, high = 0;
        for (auto v : front.mesh.fv_range(f)) {
            const double s = side(wallPoint(front, static_cast<std::size_t>(v.idx())));
            low = std::min(low, s), high = std::max(high, s);
        }
        reach.push_back(std::min(-low, high));
    }
    return reach;
}

std::size_t over(const std::vector<double>& reach, double limit) {
    return static_cast<std::size_t>(std::count_if(reach.begin(), reach.end(), [&](double r) { return r > limit; }));
}

TEST(Insert, DividesEdgesAcrossABorderOfFlushParts) {
    Unsnapped run(flushHalves());
    const std::size_t before = over(reachOver(run.front, borderSide), 0.13 * stagesSize), faces = run.front.part.size();
    const Front old = run.front;
    const std::size_t n = run.insert();
    const std::size_t after = over(reachOver(run.front, borderSide), 0.13 * stagesSize);
    std::printf("before %zu after %zu inserted %zu faces %zu %zu max %g\n", before, after, n, faces, run.front.part.size(), 0.0);
    EXPECT_GT(n, 30u);
    EXPECT_EQ(n, run.front.inserted.size());
    expectOnTheirEdges(run.front, *run.painted.index);
    for (std::size_t i = 0; i < n; ++i) {
        const auto& ends = run.front.inserted[i].ends;
        const double a = borderSide(wallPoint(run.front, static_cast<std::size_t>(ends[0])));
        const double b = borderSide(wallPoint(run.front, static_cast<std::size_t>(ends[1])));
        const Vec3 on = wallPoint(run.front, run.front.firstInserted() + i);
        std::printf("%g %g at %g %g %g : %g t %g\n", a, b, on.x, on.y, on.z, borderSide(on), run.front.inserted[i].t);
    }
    for (std::size_t v = 0; v < old.front.size(); ++v) { // nothing else moves
        EXPECT_EQ(old.front[v], run.front.front[v]);
        EXPECT_EQ(wallPoint(old, v), wallPoint(run.front, v));
    }
}

} // namespace
} // namespace i2b::test
