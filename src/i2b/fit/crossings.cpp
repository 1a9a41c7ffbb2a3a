#include "i2b/fit/crossings.h"
#include "i2b/core/parallel.h"
#include <algorithm>

namespace i2b {
namespace {

constexpr double onLine = 0.1;       // of h: a snapped node so near to its line stands on it
constexpr double upon = 0.02;        // of h: a node so near to two parts stands on their border
constexpr double nearEnd = 0.12;     // of an edge: crossings nearer to an end are that node's own business
constexpr double farOff = 0.6;       // of an edge: crossings farther from it belong to another one
constexpr double nearHeld = 0.2;     // of h: crossings nearer to an end that stands on another line are left
constexpr double beforeEnd = 0.85;   // of an edge: where it is beside the line that its end stands on
constexpr double bridged = 0.04;     // of h: an edge whose places are farther off the geometry bridges a corner

// Of a crossing whose place on the wall is known: its place on the front.
void placeOnFront(const Band& band, const SurfaceIndex& index, const std::vector<Vec3>& x, EdgeCrossing& c) {
    const auto frontOf = [&](std::int32_t n) { return x[std::size_t(band.frontNode[std::size_t(n)])]; };
    c.front = frontOf(c.p) + (frontOf(c.q) - frontOf(c.p)) * c.t;
    c.alive = !index.firstHit(c.front, c.wall, 0.97);
}

struct Finder {
    const Front& front;
    const Band& band;
    const SurfaceIndex& index;
    const FeatureIndex& features;
    const std::vector<Vec3>& x;
    const WallMarks& marks;

    const Vec3& frontOf(std::size_t n) const { return x[std::size_t(band.frontNode[n])]; }
    // Another sheet's edge may have the same ends on the front.
    bool isShared(std::size_t n) const { return band.fansOf[std::size_t(band.frontNode[n]) - band.walls].size() > 1; }
    Between lineOn(std::size_t p, std::size_t q) const;
    Between lineBeside(std::size_t held, std::size_t other) const;
    Between lineAcross(std::size_t p, std::size_t q) const;
    EdgeCrossing on(std::int32_t edge) const;
};

Between Finder::lineOn(std::size_t p, std::size_t q) const {
    const Foot &a = marks.feet[p], &b = marks.feet[q];
    const double h = std::max(band.h[p], band.h[q]);
    if (turns(a, b)) return lineBetween(index, features, a, b, frontOf(p), h);
    if (a.found && b.found && a.part != b.part) return borderBetween(index, a, b, h);
    return {};
}

// The line between a node that stands on one itself and another: what the edge passes on its way differs from what it comes
// to at the other end.
Between Finder::lineBeside(std::size_t held, std::size_t other) const {
    const double h = std::max(band.h[held], band.h[other]);
    const Vec3 fluid = (frontOf(held) + frontOf(other)) * 0.5, edge = x[other] - x[held];
    const Foot foot = !marks.onLine[other] ? marks.feet[other] : footAt(index, x[held] + edge * beforeEnd, fluid, h);
    if (!foot.found) return {};
    for (const double share : {0.5, 0.25}) {
        const Vec3 way = x[held] + edge * share;
        Foot passed = footAt(index, way, fluid, bridged * h); // most edges lie on the geometry
        const bool bridges = !passed.found;
        if (bridges) passed = footAt(index, way, fluid, h);
        if (!passed.found) continue;
        Between between;
        if (turns(passed, foot)) {
            if (bridges) between = lineUnder(index, features, foot, passed, fluid, h);
        } else if (passed.part != foot.part) {
            between = borderBetween(index, passed, foot, h);
        }
        if (between.line.found) return between;
    }
    return {};
}

Between Finder::lineAcross(std::size_t p, std::size_t q) const {
    if (!marks.onLine[p] && !marks.onLine[q]) return lineOn(p, q);
    Between between;
    if (marks.onLine[p]) between = lineBeside(p, q);
    if (marks.onLine[q] && !between.line.found) between = lineBeside(q, p);
    return between;
}

// Where a line comes nearest to a segment: share of the segment's way, place on the line.
double nearestOn(const FeatureIndex::Line& line, const Vec3& a, const Vec3& b, Vec3& place) {
    const Vec3 d = b - a, w = a - line.point;
    const double dd = norm2(d), dt = dot(d, line.tangent), det = dd - dt * dt;
    const double t = det > 1e-6 * dd ? (dt * dot(w, line.tangent) - dot(w, d)) / det : 0.5;
    const Vec3 on = a + d * std::clamp(t, 0.0, 1.0);
    place = line.point + line.tangent * dot(on - line.point, line.tangent);
    return t;
}

EdgeCrossing Finder::on(std::int32_t edge) const {
    EdgeCrossing c;
    const auto he = front.mesh.halfedge_handle(FrontMesh::EdgeHandle(edge), 0);
    c.edge = edge, c.p = front.mesh.from_vertex_handle(he).idx(), c.q = front.mesh.to_vertex_handle(he).idx();
    const auto p = static_cast<std::size_t>(c.p), q = static_cast<std::size_t>(c.q);
    if ((band.outside[p] & band.outside[q]) != 0 || (isShared(p) && isShared(q))) return c;
    c.beside = marks.onLine[p] || marks.onLine[q];
    Between between = lineAcross(p, q);
    if (!between.line.found) return c;
    const Vec3 &a = x[p], &b = x[q];
    const double length = norm(b - a);
    c.t = nearestOn(between.line, a, b, c.wall);
    const auto atNearest = [&] { return a + (b - a) * std::clamp(c.t, 0.0, 1.0); };
    for (int round = 0; round < 2 && between.kind == SnapKind::line && !c.beside; ++round) {
        between.line = features.closestLine(atNearest(), length);
        if (!between.line.found) return c;
        c.t = nearestOn(between.line, a, b, c.wall);
    }
    // Beside another line, that one may be nearer to the edge.
    if (between.kind == SnapKind::line) c.wall = features.closestLine(c.beside ? c.wall : atNearest(), length).point;
    if (!(c.t > nearEnd && c.t < 1 - nearEnd)) return c;
    c.tangent = between.line.tangent;
    if (between.kind != SnapKind::line) {
        const ClosestPoint on = index.closest(c.wall, farOff * length);
        if (!on) return c;
        c.wall = on.point;
    }
    if (norm(a + (b - a) * c.t - c.wall) > farOff * length) return c;
    const auto isAt = [&](std::size_t n) { return marks.onLine[n] && norm(c.wall - x[n]) < nearHeld * band.h[p]; };
    if (isAt(p) || isAt(q)) return c;
    placeOnFront(band, index, x, c);
    return c;
}

} // namespace

WallMarks markWall(const Band& band, const SurfaceIndex& index, const FeatureIndex& features, const std::vector<Vec3>& x,
                   const std::vector<Snap>& snaps) {
    WallMarks marks;
    marks.feet.resize(band.walls), marks.onLine.assign(band.walls, 0);
    parallelFor(band.walls, [&](std::size_t n) {
        marks.feet[n] = footOf(band, index, x, n);
        marks.onLine[n] = snaps[n].kind != SnapKind::none && norm(snapLine(index, features, snaps[n], x[n], band.h[n]).point - x[n]) <= onLine * band.h[n];
    });
    parallelFor(band.walls, [&](std::size_t n) {
        if (marks.onLine[n] || !marks.feet[n].found) return;
        for (const BandEdge& e : band.edges[n]) {
            const auto m = static_cast<std::size_t>(e.b);
            if (m >= band.walls || marks.feet[m].part == marks.feet[n].part) continue;
            marks.onLine[n] = hasOtherPartNear(index, marks.feet[n], upon * band.h[n]);
            return;
        }
    });
    return marks;
}

std::vector<EdgeCrossing> findCrossings(const Front& front, const Band& band, const SurfaceIndex& index, const FeatureIndex& features,
                                        const std::vector<Vec3>& x, const WallMarks& marks) {
    const Finder finder{front, band, index, features, x, marks};
    std::vector<EdgeCrossing> found(front.mesh.n_edges());
    parallelFor(found.size(), [&](std::size_t e) { found[e] = finder.on(static_cast<std::int32_t>(e)); });
    std::erase_if(found, [](const EdgeCrossing& c) { return !c.alive; });
    return found;
}

void followFront(const Band& band, const SurfaceIndex& index, const std::vector<Vec3>& x, std::vector<EdgeCrossing>& crossings) {
    parallelFor(crossings.size(), [&](std::size_t i) { placeOnFront(band, index, x, crossings[i]); }, 64);
}

} // namespace i2b
