#include "i2b/fit/crossings.h"
#include "i2b/core/collect.h"
#include "i2b/core/parallel.h"
#include "i2b/fit/wall_views.h"
#include <algorithm>

namespace i2b {
namespace {

constexpr double onLine = 0.1;       // of h: a snapped node so near to its line stands on it
constexpr double upon = 0.02;        // of h: a node so near to two parts stands on their border
constexpr double nearEnd = 0.12;     // of an edge: crossings nearer to an end are that node's own business
constexpr double pastEnd = 0.1;      // the same past an end, which leans over the line
constexpr double farOff = 0.9;       // of an edge: crossings farther from it belong to another one
constexpr double nearHeld = 0.2;     // of h: crossings nearer to an end that stands on another line are left
constexpr double beforeEnd = 0.85;   // of an edge: where it is beside the line that its end stands on
constexpr double bridged = 0.04;     // of h: an edge whose places are farther off the geometry bridges a corner
constexpr double bent = 0.03;        // of h: an edge farther off the geometry bridges a bend
constexpr double flat = 0.015;       // of h: one whose middle is so near bridges none: at a single bend it is half as far off at least
constexpr double besideLine = 0.25;  // of h: bends nearer to a line are a part of it
constexpr double steep = 0.7;        // cosine: edges along a line lead across no bend beside it
constexpr double cornerReach = 2.5;  // of h: from the middle of an edge to a corner beyond it
constexpr double mayCome = 1.5;      // of h: a node that is nearer to the corner wished for it gets there later
constexpr double strays = 0.25;      // of a way along a line: how far off that it may have bent,
constexpr double goesOn = 0.9;       // and the cosine that it must not turn by more
constexpr int looks = 8;             // equal parts of an edge, between which a bend is looked for

struct Finder {
    const Front& front;
    const Band& band;
    const SurfaceIndex& index;
    const FeatureIndex& features;
    const Positions& x;
    const WallMarks& marks;

    const Vec3& frontOf(std::size_t n) const { return x[std::size_t(band.frontNode[n])]; }
    // Another sheet's edge may have the same ends on the front.
    bool isShared(std::size_t n) const { return band.fansOf[std::size_t(band.frontNode[n]) - band.walls].size() > 1; }
    Between lineOn(std::size_t p, std::size_t q) const;
    Between lineBeside(std::size_t held, std::size_t other) const;
    Between bendBeside(std::size_t held, std::size_t other) const;
    Between bendOn(std::size_t p, std::size_t q) const;
    double foldAt(std::size_t held, std::size_t other, const Vec3& way) const;
    bool isUnderEnd(const Vec3& bend, std::size_t p, std::size_t q) const;
    Between lineAcross(std::size_t p, std::size_t q) const;
    Between foldAcross(EdgeCrossing& c) const;
    EdgeCrossing edgeOf(std::int32_t edge) const;
    EdgeCrossing on(std::int32_t edge) const;
    EdgeCrossing cornerBeyond(std::int32_t edge) const;
};

Between Finder::lineOn(std::size_t p, std::size_t q) const {
    const Foot &a = marks.feet[p], &b = marks.feet[q];
    const double h = std::max(band.h[p], band.h[q]);
    if (turns(a, b)) return lineBetween(index, features, a, b, frontOf(p), h, true);
    if (const Between faint = faintBetween(index, features, x[p], x[q], frontOf(p), h); faint.line.found) return faint;
    if (a.found && b.found && a.part != b.part) return borderBetween(index, a, b, frontOf(p), h);
    return {};
}

// The line between a node that stands on one itself and another: what the edge passes on its way differs from what it comes
// to at the other end.
Between Finder::lineBeside(std::size_t held, std::size_t other) const {
    const double h = std::max(band.h[held], band.h[other]);
    const Vec3 fluid = (frontOf(held) + frontOf(other)) * 0.5, edge = x[other] - x[held];
    const Foot foot = !marks.onLine[other] ? marks.feet[other] : footAt(index, x[held] + edge * beforeEnd, fluid, h);
    if (!foot.found) return {};
    for (const double share : {0.5, 0.25, 0.125}) {
        const Vec3 way = x[held] + edge * share;
        Foot passed = footAt(index, way, fluid, bridged * h); // most edges lie on the geometry
        const bool bridges = !passed.found;
        if (bridges) passed = footAt(index, way, fluid, h);
        if (!passed.found) continue;
        Between between;
        if (turns(passed, foot)) {
            if (bridges) between = lineUnder(index, features, foot, passed, fluid, h);
        } else if (passed.part != foot.part) {
            between = borderBetween(index, passed, foot, fluid, h);
        }
        if (between.line.found) return between;
    }
    return {};
}

// The cosine of the wall's fold at a line, from its other side onto a way off it.
double Finder::foldAt(std::size_t held, std::size_t other, const Vec3& way) const {
    const Vec3 &tangent = marks.tangents[held], edge = x[other] - x[held];
    const auto across = [&](const Vec3& v) { return normalized(v - tangent * dot(v, tangent)); };
    Vec3 otherSide;
    for (const BandEdge& e : band.edges[held]) {
        const auto m = static_cast<std::size_t>(e.b);
        if (m < band.walls && dot(x[held] - x[m], edge) > 0) otherSide += across(x[held] - x[m]);
    }
    return dot(normalized(otherSide), across(way));
}

// Where the geometry bends again within a cell of a line, be it round or blunt: the place that the edge is farthest off. Without a
// vertex there the wall would fold less at the line than the geometry does, or not reach into the bend at all.
Between Finder::bendBeside(std::size_t held, std::size_t other) const {
    const Vec3 &tangent = marks.tangents[held], edge = x[other] - x[held], fluid = (frontOf(held) + frontOf(other)) * 0.5;
    if (tangent == Vec3{} || std::abs(dot(tangent, normalized(edge))) > steep) return {};
    const double h = std::max(band.h[held], band.h[other]);
    if (index.closeEnough(x[held] + edge * 0.5, flat * h, flat * h)) return {};
    const double foldNow = foldAt(held, other, edge);
    Between bend;
    double farthest = bent * h;
    for (int i = 1; i < looks; ++i) {
        const Vec3 place = x[held] + edge * (double(i) / looks);
        const Foot foot = footAt(index, place, fluid, h);
        if (!foot.found || norm(foot.point - place) <= farthest) continue;
        const Vec3 way = foot.point - x[held];
        const bool isNear = norm(way - tangent * dot(way, tangent)) < besideLine * h;
        // Of a bend that makes the fold sharper what is farther away serves, too; one that blunts it is the line's own rounding.
        if (isNear && foldAt(held, other, way) <= foldNow) continue;
        farthest = norm(foot.point - place);
        bend = isNear ? Between{} : Between{{foot.point, tangent, true}, SnapKind::implicitLine};
    }
    return bend;
}

// The same away from lines: cuts need not follow a direction there.
Between Finder::bendOn(std::size_t p, std::size_t q) const {
    const Vec3 edge = x[q] - x[p], fluid = (frontOf(p) + frontOf(q)) * 0.5;
    const double h = std::max(band.h[p], band.h[q]);
    if (index.closeEnough(x[p] + edge * 0.5, flat * h, flat * h)) return {};
    Between bend;
    double farthest = bent * h;
    for (int i = 2; i < looks - 1; ++i) {
        const Vec3 place = x[p] + edge * (double(i) / looks);
        const Foot foot = footAt(index, place, fluid, h);
        const Vec3 along = normalized(cross(foot.normal, edge));
        if (!foot.found || norm(foot.point - place) <= farthest || along == Vec3{}) continue;
        farthest = norm(foot.point - place);
        bend = {{foot.point, along, true}, SnapKind::implicitLine};
    }
    return bend;
}

// Is a bend a part of a sharp edge under an end of the wall's edge, and so that node's own business?
bool Finder::isUnderEnd(const Vec3& bend, std::size_t p, std::size_t q) const {
    const FeatureIndex::Line line = features.closestLine(bend, besideLine * std::max(band.h[p], band.h[q]));
    if (!line.found || line.isRim) return false;
    Vec3 place;
    const double t = nearestOn(line, x[p], x[q], place);
    return !(t > nearEnd && t < 1 - nearEnd);
}

Between Finder::lineAcross(std::size_t p, std::size_t q) const {
    if (!marks.onLine[p] && !marks.onLine[q]) return lineOn(p, q);
    Between between;
    if (marks.onLine[p]) between = lineBeside(p, q);
    if (marks.onLine[q] && !between.line.found) between = lineBeside(q, p);
    const Vec3 fluid = (frontOf(p) + frontOf(q)) * 0.5;
    const double h = std::max(band.h[p], band.h[q]);
    if (!between.line.found) between = lineOver(index, features, x[p], x[q], fluid, h);
    if (!between.line.found) between = faintBetween(index, features, x[p], x[q], fluid, h);
    return between;
}

// What no line is: a crease, or where the geometry bends.
Between Finder::foldAcross(EdgeCrossing& c) const {
    const auto p = static_cast<std::size_t>(c.p), q = static_cast<std::size_t>(c.q);
    const Vec3 fluid = (frontOf(p) + frontOf(q)) * 0.5;
    const Between crease = creaseBetween(index, features, marks.feet[p], marks.feet[q], x[p], x[q], fluid, std::max(band.h[p], band.h[q]));
    if (crease.line.found) return crease;
    c.bend = !c.beside;
    if (c.bend) return bendOn(p, q);
    if (marks.onLine[p] && marks.onLine[q]) return {};
    return marks.onLine[p] ? bendBeside(p, q) : bendBeside(q, p);
}

EdgeCrossing Finder::edgeOf(std::int32_t edge) const {
    EdgeCrossing c;
    const auto he = front.mesh.halfedge_handle(FrontMesh::EdgeHandle(edge), 0);
    c.edge = edge, c.p = front.mesh.from_vertex_handle(he).idx(), c.q = front.mesh.to_vertex_handle(he).idx();
    return c;
}

// A corner into which the wall does not reach, as the tip of a hollow, beside an edge of the face that closes it: with a vertex there
// the face beyond the edge goes on to the corner, and the one that closed it is cut along the line that leads there.
EdgeCrossing Finder::cornerBeyond(std::int32_t edge) const {
    EdgeCrossing c = edgeOf(edge);
    const auto p = static_cast<std::size_t>(c.p), q = static_cast<std::size_t>(c.q);
    if (!marks.onLine[p] && !marks.onLine[q]) return c;
    if ((band.outside[p] | band.outside[q]) != 0 || (isShared(p) && isShared(q))) return c;
    const double h = std::max(band.h[p], band.h[q]);
    const Vec3 middle = (x[p] + x[q]) * 0.5, along = x[q] - x[p];
    const ClosestPoint corner = features.closestCorner(middle, cornerReach * h);
    if (!corner || marks.takenCorners.contains(corner.triangle) || features.isCrowded(corner, h)) return c;
    c.corner = corner.triangle, c.wall = corner.point, c.kind = SnapKind::corner, c.beside = true;
    const double share = dot(c.wall - x[p], along) / norm2(along);
    if (!(share > 0 && share < 1) || norm(c.wall - (x[p] + along * share)) < nearHeld * h) return c;
    placeOnFront(band, x, c, std::clamp(share, nearEnd, 1 - nearEnd));
    c.alive = isFree(index, c);
    return c;
}

EdgeCrossing Finder::on(std::int32_t edge) const {
    EdgeCrossing c = edgeOf(edge);
    const auto p = static_cast<std::size_t>(c.p), q = static_cast<std::size_t>(c.q);
    if ((band.outside[p] & band.outside[q]) != 0 || (isShared(p) && isShared(q))) return c;
    c.beside = marks.onLine[p] || marks.onLine[q];
    Between between = lineAcross(p, q);
    c.kind = between.kind;
    if (!between.line.found) {
        between = foldAcross(c);
        if (between.line.found && isUnderEnd(between.line.point, p, q)) return c;
        c.kind = SnapKind::none;
    }
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
    if (between.kind == SnapKind::line) {
        const FeatureIndex::Line line = features.closestLine(c.beside ? c.wall : atNearest(), length);
        c.wall = line.point, c.onRim = line.isRim;
    }
    if (!(c.t > -pastEnd && c.t < 1 + pastEnd)) return c;
    const auto isFrom = [&](std::size_t n) { return norm(c.wall - x[n]) > nearHeld * band.h[n]; };
    const double t = std::clamp(c.t, nearEnd, 1 - nearEnd);
    // Else an end leans over the line, as over the foot of a step whose upper edge it stands on: the place on the front is farther along.
    if (t != c.t && !(isFrom(p) && isFrom(q))) return c;
    c.t = t;
    c.tangent = between.line.tangent;
    if (between.kind != SnapKind::line) {
        const ClosestPoint on = index.closest(c.wall, farOff * length);
        if (!on) return c;
        c.wall = on.point;
    }
    if (norm(a + (b - a) * c.t - c.wall) > farOff * length) return c;
    const auto isAt = [&](std::size_t n) { return marks.onLine[n] && norm(c.wall - x[n]) < nearHeld * band.h[p]; };
    if (isAt(p) || isAt(q)) return c;
    placeOnFront(band, x, c, c.t);
    c.alive = isFree(index, c);
    return c;
}

} // namespace

WallMarks markWall(WallViews& views, const FeatureIndex& features, const Positions& x,
                   const std::vector<Snap>& snaps, const std::vector<Snap>& wishes) {
    const Band& band = views.band();
    const SurfaceIndex& index = views.index();
    WallMarks marks;
    marks.feet.resize(band.walls), marks.onLine.assign(band.walls, 0), marks.tangents.resize(band.walls);
    parallelFor(band.walls, [&](std::size_t n) {
        marks.feet[n] = views.foot(n, x);
        if (snaps[n].kind == SnapKind::none) {
            const FeatureIndex::Line line = lineUpon(features, x[n], band.h[n]);
            if (line.found && marks.feet[n].found) marks.onLine[n] = 1, marks.tangents[n] = line.tangent;
            return;
        }
        const FeatureIndex::Line line = snapLine(index, features, snaps[n], x[n], band.h[n]);
        marks.onLine[n] = norm(line.point - x[n]) <= onLine * band.h[n];
        if (marks.onLine[n] && snaps[n].kind != SnapKind::corner) marks.tangents[n] = line.tangent;
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
    const RawVector<std::uint32_t> taken = collect<std::uint32_t>(band.walls, [&](std::size_t n, const auto& put) {
        const auto take = [&](const Snap& snap, double within) {
            if (snap.kind != SnapKind::corner || norm(snap.point - x[n]) > within * band.h[n]) return;
            if (const ClosestPoint corner = features.closestCorner(snap.point, band.h[n])) put(corner.triangle);
        };
        take(snaps[n], onLine), take(wishes[n], mayCome);
    }, 4096);
    marks.takenCorners.insert(taken.begin(), taken.end());
    return marks;
}

std::vector<EdgeCrossing> findCrossings(const Front& front, const Band& band, const SurfaceIndex& index, const FeatureIndex& features,
                                        const Positions& x, const WallMarks& marks) {
    const Finder finder{front, band, index, features, x, marks};
    const RawVector<EdgeCrossing> found = collect<EdgeCrossing>(front.mesh.n_edges(), [&](std::size_t e, const auto& put) {
        EdgeCrossing crossing = finder.on(static_cast<std::int32_t>(e));
        if (!crossing.alive) {
            crossing = finder.cornerBeyond(static_cast<std::int32_t>(e));
            if (!crossing.alive) return;
            crossing.alive = false;
        }
        put(crossing);
    }, 256);
    return {found.begin(), found.end()};
}

void placeOnFront(const Band& band, const Positions& x, EdgeCrossing& c, double t) {
    const auto frontOf = [&](std::int32_t n) { return x[std::size_t(band.frontNode[std::size_t(n)])]; };
    c.t = t;
    c.front = Front::Inserted{{c.p, c.q}, c.t}.frontAt(frontOf(c.p), frontOf(c.q), c.wall);
}

double shareUnder(const Band& band, const Positions& x, const EdgeCrossing& c) {
    const Vec3 &p = x[std::size_t(band.frontNode[std::size_t(c.p)])], &q = x[std::size_t(band.frontNode[std::size_t(c.q)])];
    const double length2 = norm2(q - p);
    return length2 == 0 ? c.t : std::clamp(dot(c.wall - p, q - p) / length2, nearEnd, 1 - nearEnd);
}

bool slideAlong(const SurfaceIndex& index, const FeatureIndex& features, EdgeCrossing& c, double way) {
    const Vec3 place = c.wall + c.tangent * way;
    if (c.kind == SnapKind::line) {
        const FeatureIndex::Line line = features.closestLine(place, strays * std::abs(way));
        if (!line.found || std::abs(dot(line.tangent, c.tangent)) < goesOn) return false;
        c.wall = line.point, c.tangent = line.tangent, c.onRim = line.isRim;
        return true;
    }
    const ClosestPoint on = c.kind == SnapKind::implicitLine ? index.closest(place, strays * std::abs(way)) : ClosestPoint{};
    if (on) c.wall = on.point;
    return bool(on);
}

bool isFree(const SurfaceIndex& index, const EdgeCrossing& c) { return !index.firstHit(c.front, c.wall, 0.97); }

void followFront(const Band& band, const SurfaceIndex& index, const Positions& x, std::vector<EdgeCrossing>& crossings) {
    parallelFor(crossings.size(), [&](std::size_t i) {
        placeOnFront(band, x, crossings[i], crossings[i].t);
        crossings[i].alive = isFree(index, crossings[i]);
    }, 64);
}

} // namespace i2b
