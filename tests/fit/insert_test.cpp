// Proves: vertices are put into those wall edges only that cross a border or an edge, they lie on it, and afterwards each
// face of the front lies on one side; with the fit's own snaps and without any; hollows get vertices at their tips; the same on any
// number of threads.
#include "i2b/fit/between.h"
#include "i2b/fit/insert.h"
#include "fit/unsnapped.h"
#include "i2b/quality/quality_report.h"
#include "pipeline/shape_run.h"
#include <gtest/gtest.h>
#include <functional>
#include <map>
#include <tbb/global_control.h>

namespace i2b::test {
namespace {

std::size_t insert(Unsnapped& run) { return insertVertices(run.front, run.views, run.features, run.x, run.snaps, run.snaps); }

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
        EXPECT_LT(norm(front.front[v] - front.inserted[i].frontAt(front.front[p], front.front[q], wallPoint(front, v))), 1e-14);
        EXPECT_LT(index.closest(wallPoint(front, v)).distance, 1e-9);
        EXPECT_FALSE(front.mesh.find_halfedge(FrontMesh::VertexHandle(ends[0]), FrontMesh::VertexHandle(ends[1])).is_valid()); // is divided
        for (const std::int32_t e : ends)
            EXPECT_TRUE(front.mesh.find_halfedge(FrontMesh::VertexHandle(e), FrontMesh::VertexHandle(static_cast<int>(v))).is_valid());
    }
}

// How far an inserted vertex is off the edge that it divides, of h: bends are where that is farthest off the geometry.
double offItsEdge(const Front& front, std::size_t i) {
    const auto& [ends, t] = front.inserted[i];
    const Vec3 a = wallPoint(front, static_cast<std::size_t>(ends[0])), b = wallPoint(front, static_cast<std::size_t>(ends[1]));
    return norm(wallPoint(front, front.firstInserted() + i) - (a + (b - a) * t)) / stagesSize;
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

// What a face is cut for: two of its nodes, neither on a line, see sides that turn or different parts.
std::size_t straddling(const ToFront& run, const std::vector<std::uint8_t>& onLine) {
    std::size_t n = 0;
    for (auto f : run.front.mesh.faces()) {
        std::vector<Foot> feet;
        for (auto v : run.front.mesh.fv_range(f)) {
            const auto i = static_cast<std::size_t>(v.idx());
            if (i >= run.front.firstInserted() || onLine[i]) continue;
            const Vec3 b = wallPoint(run.front, i);
            feet.push_back(footAt(*run.painted.index, b, run.front.front[i], stagesSize));
        }
        bool differ = false;
        for (const Foot& a : feet)
            for (const Foot& b : feet) differ = differ || turns(a, b) || a.part != b.part;
        n += differ;
    }
    return n;
}

void expectSoundMesh(const ToFront& run) {
    const LayerStack layers = makeLayers(run.front, LayerOptions{});
    const PolyMesh mesh = assemble({run.lattice, run.kept, run.front, layers, run.painted.soup.parts});
    EXPECT_EQ(mesh.validate(), "");
    const QualityReport q = measureQuality(mesh);
    EXPECT_EQ(q.negativeVolumeCells + q.wrongOrientedFaces, 0);
    EXPECT_EQ(q.openCells + q.openCellsByEdges + q.unusedPoints + q.duplicateFaces + q.faultyFaceVertices, 0);
}

// No node is snapped to the border: nearly every face across it is cut, all else stays. Fewer are needed where nodes stand all but
// on it, at which cuts may end.
TEST(Insert, DividesEdgesAcrossABorderOfFlushParts) {
    Unsnapped run(flushHalves());
    const Front old = run.front;
    const double clear = 0.13 * stagesSize; // crossings nearer to an end are left
    const std::size_t before = over(reachOver(run.front, borderSide), clear);
    const std::size_t n = insert(run);
    EXPECT_GT(n, 30u);
    EXPECT_EQ(n, run.front.inserted.size());
    EXPECT_LE(6 * over(reachOver(run.front, borderSide), clear), before);
    expectOnTheirEdges(run.front, *run.painted.index);
    std::size_t elsewhere = 0;
    for (std::size_t i = 0; i < n; ++i) {
        const auto& ends = run.front.inserted[i].ends;
        const double a = borderSide(wallPoint(run.front, static_cast<std::size_t>(ends[0])));
        const double b = borderSide(wallPoint(run.front, static_cast<std::size_t>(ends[1])));
        const Vec3 on = wallPoint(run.front, run.front.firstInserted() + i);
        if (std::abs(borderSide(on)) >= 0.05 * stagesSize) { // a sharp edge of the plate, to which no node is snapped either
            const FeatureIndex::Line line = run.features.closestLine(on, 0.25 * stagesSize);
            // or a bend, of which one so near to a sharp edge is a part
            EXPECT_TRUE(line.found ? norm(line.point - on) < 1e-9 : offItsEdge(run.front, i) > 0.03);
            ++elsewhere;
            continue;
        }
        EXPECT_LT(a * b, 0); // crosses
    }
    EXPECT_LE(20 * elsewhere, n);
    ASSERT_EQ(run.front.firstInserted(), old.front.size());
    for (std::size_t v = 0; v < old.front.size(); ++v) { // nothing else moves
        EXPECT_EQ(old.front[v], run.front.front[v]);
        EXPECT_EQ(wallPoint(old, v), wallPoint(run.front, v));
    }
    expectSoundMesh(run);
}

// The same of the sharp edges of a box at an odd angle, to which no node is snapped either.
TEST(Insert, DividesEdgesAcrossSharpEdges) {
    Unsnapped run(turnedBox());
    const std::vector<std::uint8_t> none(run.front.front.size(), 0);
    const std::size_t before = straddling(run, none);
    const std::size_t n = insert(run);
    EXPECT_GT(n, 50u);
    expectOnTheirEdges(run.front, *run.painted.index);
    std::size_t across = 0;
    for (std::size_t i = 0; i < n; ++i) {
        const auto& ends = run.front.inserted[i].ends;
        const auto footOfEnd = [&](std::int32_t end) {
            const auto v = static_cast<std::size_t>(end);
            return footAt(*run.painted.index, wallPoint(run.front, v), run.front.front[v], stagesSize);
        };
        const Vec3 on = wallPoint(run.front, run.front.firstInserted() + i);
        const FeatureIndex::Line line = run.features.closestLine(on, stagesSize);
        if (!line.found || norm(line.point - on) > 1e-9) { // a bend beside the edge
            EXPECT_GT(offItsEdge(run.front, i), 0.03);
            continue;
        }
        EXPECT_TRUE(turns(footOfEnd(ends[0]), footOfEnd(ends[1])));
        ++across;
    }
    EXPECT_GT(10 * across, 9 * n);
    EXPECT_LT(straddling(run, none), before);
    expectSoundMesh(run);
}

// A whole fit, with snaps: only where the border runs over a sharp edge, to which the nodes there are held, may a face reach
// over it, and not far.
TEST(Insert, LeavesNoFaceOnBothSidesOfABorder) {
    const ToMesh run(flushHalves(), stagesOptions());
    EXPECT_EQ(run.front.validate(), "");
    const std::vector<double> reach = reachOver(run.front, borderSide);
    EXPECT_LE(over(reach, 0.05 * stagesSize), 8u); // two at each of four such places
    EXPECT_EQ(over(reach, 0.25 * stagesSize), 0u);
    for (auto f : run.front.mesh.faces()) {
        if (reach[static_cast<std::size_t>(f.idx())] <= 0.05 * stagesSize) continue;
        std::size_t held = 0;
        for (auto v : run.front.mesh.fv_range(f)) held += run.fitted.snaps[static_cast<std::size_t>(v.idx())].kind == SnapKind::line;
        EXPECT_GE(held, 1u);
    }
}

// At odd angles few faces are left that go round an edge.
TEST(Insert, LeavesFewFacesRoundAnEdge) {
    const Unsnapped without(turnedBox());
    const ToMesh run(turnedBox(), stagesOptions());
    EXPECT_EQ(run.front.validate(), "");
    std::vector<std::uint8_t> onLine(run.front.front.size(), 0);
    for (std::size_t v = 0; v < run.fitted.snaps.size(); ++v) onLine[v] = run.fitted.snaps[v].kind != SnapKind::none;
    EXPECT_LT(10 * straddling(run, onLine), straddling(without, std::vector<std::uint8_t>(without.front.front.size(), 0)));
}

// In a tetrahedron no front comes near the tips: those that a vertex is put at stand there alone, and edges lead from there along three lines.
TEST(Insert, PutsVerticesAtTheTipsOfHollows) {
    const auto shape = std::ranges::find(shapes(), std::string_view("tetrahedron"), &Shape::name);
    Options options = stagesOptions();
    options.domain.flow = Flow::internal;
    std::size_t tips = 0;
    for (const unsigned pose : {0u, 2u, 8u}) {
        const ToMesh run(posed(*shape, stagesSize, pose).soup, options);
        EXPECT_EQ(run.front.validate(), "");
        for (std::size_t v = run.front.firstInserted(); v < run.front.front.size(); ++v) {
            if (run.fitted.snaps[v].kind != SnapKind::corner) continue;
            ++tips;
            const Vec3 tip = wallPoint(run.front, v);
            EXPECT_LT(run.features.closestCorner(tip, stagesSize).distance, 1e-9);
            for (std::size_t other = 0; other < run.front.firstInserted(); ++other) ASSERT_GT(norm(wallPoint(run.front, other) - tip), 0.2 * stagesSize);
            int lines = 0;
            for (const auto end : run.front.mesh.vv_range(FrontMesh::VertexHandle(static_cast<int>(v)))) {
                const Vec3 middle = (wallPoint(run.front, static_cast<std::size_t>(end.idx())) + tip) * 0.5;
                lines += run.features.closestLine(middle, 0.1 * stagesSize).found;
            }
            EXPECT_GE(lines, 3);
        }
    }
    EXPECT_GE(tips, 3u);
}

TEST(Insert, SameOnAnyNumberOfThreads) {
    for (const Surface& soup : {flushHalves(), turnedBox()}) {
        std::uint64_t sum = 0;
        for (const std::size_t threads : {1u, 3u}) {
            const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
            Unsnapped run(soup);
            EXPECT_GT(insert(run), 30u);
            if (threads == 1) sum = run.front.checksum();
            EXPECT_EQ(run.front.checksum(), sum);
        }
    }
}

} // namespace
} // namespace i2b::test
