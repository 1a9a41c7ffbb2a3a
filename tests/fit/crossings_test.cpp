// Proves: edges between nodes that stand on lines are divided at a line that they pass over, on that line. Front nodes make room
// for a vertex on an edge as for one of their own, without spoiling a corner. Places of vertices keep to line and edge when they are moved.
#include "i2b/fit/corner.h"
#include "i2b/fit/crossings.h"
#include "i2b/fit/front_room.h"
#include "fit/unsnapped.h"
#include <gtest/gtest.h>
#include <random>

namespace i2b::test {
namespace {

const samples::Frame ridge = samples::along({-0.5, -0.4, -0.3}, {0.7, 0.6, 0.4});

// A block with a ridge one cell wide along its top, in an odd direction.
Surface ridged() {
    const samples::Loop2 outline{{-0.7, -0.5}, {0.7, -0.5}, {0.7, 0.5}, {0.05, 0.5}, {0, 0.54}, {-0.05, 0.5}, {-0.7, 0.5}};
    Surface soup;
    addPart(soup, samples::extrude(ridge, outline, {}, {0, 1.3}), "block");
    return soup;
}

// The nodes on and near the ridge put on its feet, and held there: nothing is on its top.
void snapToFeet(Unsnapped& run) {
    const auto v = [](const Vec3& p) { return dot(p - ridge.origin, ridge.v); };
    const auto u = [](const Vec3& p) { return dot(p - ridge.origin, ridge.u); };
    for (std::size_t n = 0; n < run.band.walls; ++n) {
        if (v(run.x[n]) < 0.45 || std::abs(u(run.x[n])) > 0.08) continue;
        const Vec3 aside = ridge.u * (u(run.x[n]) > 0 ? 0.05 : -0.05);
        const FeatureIndex::Line line = run.features.closestLine(run.x[n] + aside - ridge.v * 0.03, 0.5 * stagesSize);
        if (line.found && v(line.point) < 0.52) run.snaps[n] = {SnapKind::line, line.point, line.tangent}, run.x[n] = line.point;
    }
}

double worstCorner(const Band& band, const Positions& x) {
    double worst = 1;
    band.corners.forAll([&](const Corner& c) { worst = std::min(worst, scaledJacobian(c, x)); });
    return worst;
}

// What leads from one foot of the ridge to the other passes over its top.
TEST(Crossings, OfEdgesBetweenLinesLieOnTheLineThatTheyPassOver) {
    Unsnapped run(ridged());
    snapToFeet(run);
    const WallMarks marks = markWall(run.views, run.features, run.x, run.snaps, run.snaps);
    const std::vector<EdgeCrossing> crossings = findCrossings(run.front, run.band, *run.painted.index, run.features, run.x, marks);
    int between = 0;
    for (const EdgeCrossing& c : crossings) {
        const auto p = static_cast<std::size_t>(c.p), q = static_cast<std::size_t>(c.q);
        EXPECT_GE(c.t, 0.12);
        EXPECT_LE(c.t, 0.88);
        if (c.kind != SnapKind::line) continue;
        const FeatureIndex::Line line = run.features.closestLine(c.wall, stagesSize);
        ASSERT_TRUE(line.found);
        EXPECT_LT(norm(line.point - c.wall), 1e-9);
        if (!marks.onLine[p] || !marks.onLine[q]) continue;
        ++between;
        for (const std::size_t end : {p, q}) EXPECT_GT(norm(run.x[end] - c.wall), 0.1 * stagesSize); // not what the end stands on
        EXPECT_GT(norm(run.x[p] + (run.x[q] - run.x[p]) * c.t - c.wall), 0.03 * stagesSize); // passes over
    }
    EXPECT_GT(between, 3);
}

// Moved on the front and along its line, a crossing's place on the wall stays on a sharp edge, and that on the front on its edge; under the
// wall's place no other share of the edge is nearer to it.
TEST(Crossings, StayOnTheirLineAndTheirEdgeWhenMoved) {
    Unsnapped run(ridged());
    const WallMarks marks = markWall(run.views, run.features, run.x, run.snaps, run.snaps);
    int slid = 0;
    for (const EdgeCrossing& c : findCrossings(run.front, run.band, *run.painted.index, run.features, run.x, marks)) {
        if (c.kind != SnapKind::line) continue;
        const auto onEdge = [&](double t) {
            const auto frontOf = [&](std::int32_t n) { return run.x[static_cast<std::size_t>(run.band.frontNode[static_cast<std::size_t>(n)])]; };
            return frontOf(c.p) + (frontOf(c.q) - frontOf(c.p)) * t;
        };
        const double under = shareUnder(run.band, run.x, c);
        for (int i = 12; i <= 88; ++i) EXPECT_LE(norm(onEdge(under) - c.wall), norm(onEdge(0.01 * i) - c.wall) + 1e-12);
        EdgeCrossing placed = c;
        placeOnFront(run.band, run.x, placed, 0.4);
        EXPECT_LT(norm(placed.front - (onEdge(0.4) + (c.wall - onEdge(0.4)) * Front::Inserted::lift)), 1e-14);
        for (const double way : {0.2 * stagesSize, -0.3 * stagesSize}) {
            EdgeCrossing moved = c;
            if (!slideAlong(*run.painted.index, run.features, moved, way)) continue; // past the line's end
            ++slid;
            EXPECT_LT(norm(run.features.closestLine(moved.wall, stagesSize).point - moved.wall), 1e-12);
            EXPECT_NEAR(norm(moved.wall - c.wall), std::abs(way), 0.25 * std::abs(way));
            EXPECT_GT(dot(moved.wall - c.wall, c.tangent) * way, 0);
        }
    }
    EXPECT_GT(slid, 20);
}

// Wishes for places in the middle of edges, in directions at random over which the front stands too low: what moves comes higher, by at
// most the room that is asked for, and every corner that was good stays so.
TEST(FrontRoom, ForAPlaceOnAnEdgeComesFromItsEnds) {
    Unsnapped run(turnedBox());
    std::mt19937 random(5);
    const auto real = [&] { return static_cast<double>(random()) / 2147483648.0 - 1; };
    const double before = worstCorner(run.band, run.x);
    ASSERT_GT(before, 0);
    int moved = 0;
    for (std::size_t e = 0; e < run.front.mesh.n_edges(); e += 7) {
        const auto he = run.front.mesh.halfedge_handle(FrontMesh::EdgeHandle(static_cast<int>(e)), 0);
        const std::int32_t p = run.front.mesh.from_vertex_handle(he).idx(), q = run.front.mesh.to_vertex_handle(he).idx();
        const auto frontOf = [&](std::int32_t n) { return run.x[static_cast<std::size_t>(run.band.frontNode[static_cast<std::size_t>(n)])]; };
        const double t = 0.5 + 0.3 * real();
        const Vec3 place = run.x[static_cast<std::size_t>(p)] + (run.x[static_cast<std::size_t>(q)] - run.x[static_cast<std::size_t>(p)]) * t;
        const auto way = [&] { return frontOf(p) + (frontOf(q) - frontOf(p)) * t - place; };
        const Vec3 up = normalized(way()), aside = normalized(cross(up, Vec3{real(), real(), real()}));
        const Vec3 normal = normalized(aside + up * 0.1); // the way to the front rises by 0.1 over it
        const double had = dot(way(), normal), asked = leastSlope * norm(way());
        ASSERT_LT(had, asked);
        const std::size_t n = makeRoom({{p, normal, q, t, place}}, run.band, *run.painted.index, run.x, run.front);
        EXPECT_LE(n, 2u);
        if (n == 0) {
            EXPECT_NEAR(dot(way(), normal), had, 1e-12);
            continue;
        }
        ++moved;
        EXPECT_GT(dot(way(), normal), had);
        EXPECT_LT(dot(way(), normal), 1.01 * asked);
        EXPECT_EQ(frontOf(p), run.front.front[static_cast<std::size_t>(p)]); // is told
        EXPECT_EQ(frontOf(q), run.front.front[static_cast<std::size_t>(q)]);
    }
    EXPECT_GT(moved, 20);
    EXPECT_GE(worstCorner(run.band, run.x), std::min(before, 0.2));
}

} // namespace
} // namespace i2b::test
