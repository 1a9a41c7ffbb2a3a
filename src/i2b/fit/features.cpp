#include "i2b/fit/features.h"
#include "i2b/core/collect.h"
#include "i2b/fit/between.h"
#include "i2b/fit/wall_views.h"
#include "i2b/front/replace_faces.h"
#include <algorithm>
#include <set>

namespace i2b {
namespace {

constexpr double degree = 3.14159265358979323846 / 180;
const double smallestTurn = std::cos(25 * degree);
const double flatCorner = std::cos(140 * degree), thinCorner = std::cos(12 * degree);
constexpr double steps = 0.08;       // of h: a wall edge whose middle is farther off than this cuts across something
constexpr double flat = 0.03;       // of h: and one whose middle is nearer has no line beside it
constexpr double bridged = 0.04;    // of h: the same beside a line, where an edge bridges a corner
constexpr double onLine = 0.05;   // of h: so far from a sharp edge the middle of a cut may be
const double alongLine = std::cos(20 * degree);
constexpr double reach = 2.2; // of h: no node is pulled farther to a feature,
constexpr double otherReach = 0.8; // or to one of another surface, as the top of a step is at its foot, where a nearer one may be
constexpr double upon = 0.2;  // of h: so near to a line a node stands all but on it,
constexpr double alone = 0.6; // unless another one runs so near,
constexpr double aside = 0.1; // at least so far beside it
constexpr double apart = 0.2; // of h: nodes beside each other keep so far apart
constexpr double linesApart = 0.3; // of h: and so do lines beside each other to have a node each
constexpr double nextReach = 0.3;  // of h: so far a node is pulled to a line beside the one that its neighbour is on,
constexpr double nextSharp = 0.6;  // or to a sharp edge, as the other one of a thin plate
constexpr double cornerReach = 0.9; // of h: no node is pulled farther to a corner, but
constexpr double tipReach = 1.8;    // so far into a hollow one, at the end of whose faces no cell has room
constexpr double besideCorner = 0.5; // of h: a node whose front is turned so far from straight out of a corner counts as farther off

struct Crossing {
    double distance = 0; // in h
    std::int32_t node = -1, other = -1;
    Snap snap;
};

// A node on its way to a line; none where that is farther than `within` (in h) or the node may not be snapped.
Crossing crossingAt(const Band& band, const SurfaceIndex& index, const FeatureIndex& features, const Positions& x, const Between& between, std::int32_t node,
                    double within = reach) {
    const auto i = static_cast<std::size_t>(node);
    if (!between.line.found || band.outside[i] != 0) return {};
    FeatureIndex::Line own = between.line;
    if (between.kind == SnapKind::line) own = features.closestLine(x[i], reach * band.h[i]);
    if (between.kind != SnapKind::line || (own.found && !isSeen(index, x[static_cast<std::size_t>(band.frontNode[i])], own.point, band.h[i]))) {
        own = between.line;
        own.point += own.tangent * dot(x[i] - own.point, own.tangent);
        if (!index.closest(own.point, mostBentAway * band.h[i])) own.point = between.line.point;
    }
    const double d = own.found ? norm(own.point - x[i]) / band.h[i] : reach + 1;
    if (d > within) return {};
    return {d, node, -1, {between.kind, own.point, own.tangent}};
}

// The better end of a wall edge that crosses a line.
Crossing crossingOf(const Band& band, const SurfaceIndex& index, const FeatureIndex& features, const Positions& x, const Between& between, std::int32_t p,
                    std::int32_t q, double within = reach) {
    Crossing first = crossingAt(band, index, features, x, between, p, within), second = crossingAt(band, index, features, x, between, q, within);
    first.other = q, second.other = p;
    if (first.node < 0 || (second.node >= 0 && second.distance < first.distance)) return second;
    return first;
}

// A wall edge from one side of a step to the other: both ends stand on surfaces that do not turn, its middle off all
// geometry. Each end has a line between itself and the riser that the edge sees on its way, which need not be in the middle.
std::array<Crossing, 2> stepOf(const Band& band, const SurfaceIndex& index, const FeatureIndex& features, const Positions& x,
                               const std::vector<Foot>& feet, std::int32_t p, std::int32_t q) {
    std::array<Crossing, 2> found;
    const auto a = static_cast<std::size_t>(p), b = static_cast<std::size_t>(q);
    const double h = std::max(band.h[a], band.h[b]);
    const Vec3 fluid = (x[static_cast<std::size_t>(band.frontNode[a])] + x[static_cast<std::size_t>(band.frontNode[b])]) * 0.5;
    for (const double share : {0.5, 0.25, 0.75}) {
        const Vec3 way = x[a] + (x[b] - x[a]) * share;
        const Foot riser = footAt(index, way, fluid, h);
        const auto lineTo = [&](const Foot& foot) { return turns(foot, riser) ? lineBetween(index, features, foot, riser, fluid, h) : Between{}; };
        const Between top = lineTo(feet[a]), bottom = lineTo(feet[b]);
        // Away from the middle of an edge that bridges a gap, planes meet where there is no step: one of its edges must be sharp.
        if (share != 0.5 && top.kind != SnapKind::line && bottom.kind != SnapKind::line) continue;
        found = {crossingAt(band, index, features, x, top, p), crossingAt(band, index, features, x, bottom, q)};
        if (found[0].node >= 0 || found[1].node >= 0) break;
    }
    return found;
}

// A wall edge from a node on its line to a free one that bridges a corner between the two, as at the foot of a step lower
// than a cell: the free end has a line of its own between itself and the riser that the edge sees on its way.
Crossing besideLine(const Band& band, const SurfaceIndex& index, const FeatureIndex& features, const Positions& x, const Foot& foot,
                    const Snap& held, std::int32_t holder, std::int32_t free) {
    const auto a = static_cast<std::size_t>(holder), b = static_cast<std::size_t>(free);
    if (held.kind == SnapKind::corner || !foot.found) return {};
    const double h = std::max(band.h[a], band.h[b]);
    const FeatureIndex::Line own = snapLine(index, features, held, x[a], h);
    const Vec3 fluid = (x[static_cast<std::size_t>(band.frontNode[a])] + x[static_cast<std::size_t>(band.frontNode[b])]) * 0.5;
    for (const double share : {0.5, 0.25}) {
        const Vec3 way = own.point + (x[b] - own.point) * share;
        if (index.closeEnough(way, bridged * h, bridged * h)) continue; // most are
        const Foot riser = footAt(index, way, fluid, h);
        if (!riser.found || norm(riser.point - way) < bridged * h || !turns(foot, riser)) continue;
        const Crossing c = crossingAt(band, index, features, x, lineUnder(index, features, foot, riser, fluid, h), free);
        if (c.node < 0 || c.distance > (c.snap.kind == SnapKind::line ? nextSharp : nextReach)) continue;
        const Vec3 off = c.snap.point - own.point;
        if (norm(off - own.tangent * dot(off, own.tangent)) > linesApart * h) return c;
    }
    return {};
}

bool hangs(const Band& band, std::size_t wall) { return !band.parents[static_cast<std::size_t>(band.frontNode[wall])].empty(); }

// What wall edges cross.
struct EdgeLook {
    const Band& band;
    const SurfaceIndex& index;
    const FeatureIndex& features;
    const Positions& x;
    const std::vector<Foot>& feet;
    const std::vector<Snap>& snaps;

    std::array<Crossing, 2> crossingsOf(std::int32_t p, std::int32_t q) const {
        const auto a = static_cast<std::size_t>(p), b = static_cast<std::size_t>(q);
        const bool heldA = snaps[a].kind != SnapKind::none, heldB = snaps[b].kind != SnapKind::none;
        if ((heldA && heldB) || hangs(band, a) || hangs(band, b)) return {};
        if (heldA) return {besideLine(band, index, features, x, feet[b], snaps[a], p, q)};
        if (heldB) return {besideLine(band, index, features, x, feet[a], snaps[b], q, p)};
        if (turns(feet[a], feet[b])) return {acrossTurn(p, q)};
        if (const Between faint = faintBetween(index, features, x[a], x[b], fluidAt(p), hOf(p, q)); faint.line.found) return {crossingOf(band, index, features, x, faint, p, q)};
        if (!feet[a].found || !feet[b].found) return {};
        const std::array<Crossing, 2> found = betweenAlike(p, q);
        return found[0].node >= 0 || found[1].node >= 0 ? found : std::array<Crossing, 2>{acrossCrease(p, q)};
    }

  private:
    const Vec3& fluidAt(std::int32_t p) const { return x[static_cast<std::size_t>(band.frontNode[static_cast<std::size_t>(p)])]; }
    double hOf(std::int32_t p, std::int32_t q) const { return std::max(band.h[static_cast<std::size_t>(p)], band.h[static_cast<std::size_t>(q)]); }

    // Its ends stand on different sides of a line.
    Crossing acrossTurn(std::int32_t p, std::int32_t q) const {
        const Foot &a = feet[static_cast<std::size_t>(p)], &b = feet[static_cast<std::size_t>(q)];
        const Between between = lineBetween(index, features, a, b, fluidAt(p), hOf(p, q));
        Crossing crossing = crossingOf(band, index, features, x, between, p, q, between.isOfBoth ? reach : otherReach);
        if (between.isOfBoth || crossing.node >= 0) return crossing;
        crossing = crossingOf(band, index, features, x, meetingOf(index, features, a, b, fluidAt(p), hOf(p, q)), p, q, otherReach);
        return crossing.node < 0 ? crossingOf(band, index, features, x, between, p, q) : crossing;
    }
    // After all that cross a line.
    Crossing acrossCrease(std::int32_t p, std::int32_t q) const {
        const auto a = static_cast<std::size_t>(p), b = static_cast<std::size_t>(q);
        Crossing crossing = crossingOf(band, index, features, x, creaseBetween(index, features, feet[a], feet[b], x[a], x[b], fluidAt(p), hOf(p, q)), p, q);
        crossing.distance += 2 * reach;
        return crossing;
    }
    // Its ends do not tell them apart: what lies between may.
    std::array<Crossing, 2> betweenAlike(std::int32_t p, std::int32_t q) const {
        const auto a = static_cast<std::size_t>(p), b = static_cast<std::size_t>(q);
        const double h = hOf(p, q);
        const ClosestPoint near = index.closeEnough((x[a] + x[b]) * 0.5, steps * h, flat * h); // most edges lie on what they stand on
        std::array<Crossing, 2> found;
        if (!near) {
            found = stepOf(band, index, features, x, feet, p, q);
            if (found[0].node >= 0 || found[1].node >= 0) return found;
        }
        if (near.distance > flat * h) found[0] = crossingOf(band, index, features, x, lineOver(index, features, feet[a].point, feet[b].point, fluidAt(p), h), p, q);
        if (found[0].node < 0 && feet[a].part != feet[b].part) found[0] = crossingOf(band, index, features, x, borderBetween(index, feet[a], feet[b], fluidAt(p), h), p, q);
        return found;
    }
};

std::size_t snapCorners(const Band& band, const SurfaceIndex& index, const FeatureIndex& features, const std::vector<Foot>& feet, const Positions& x,
                        std::vector<Snap>& snaps) {
    struct Candidate {
        double distance;
        std::uint32_t corner;
        std::int32_t node;
        Vec3 point;
    };
    RawVector<Candidate> list = collect<Candidate>(band.walls, [&](std::size_t n, const auto& put) {
        if (hangs(band, n) || band.outside[n] != 0) return;
        const ClosestPoint c = features.closestCorner(x[n], tipReach * band.h[n]);
        if (!c || !isSeen(index, x[static_cast<std::size_t>(band.frontNode[n])], c.point, band.h[n])) return;
        // Only where the wall around really bends: some neighbour stands on another side.
        std::array<Foot, 3> sides{feet[n]};
        std::size_t found = 1;
        for (const BandEdge& e : band.edges[n]) {
            const auto m = static_cast<std::size_t>(e.b);
            if (found == sides.size()) break;
            if (m >= band.walls) continue;
            if (std::all_of(sides.begin(), sides.begin() + std::ptrdiff_t(found), [&](const Foot& f) { return turns(f, feet[m]); })) sides[found++] = feet[m];
        }
        const bool isFaint = features.isFaint(c); // there the wall need not bend
        if (isFaint && features.isCrowded(c, band.h[n])) return;
        if (found == 1 && !isFaint) return;
        const Vec3 out = normalized(sides[0].normal + sides[1].normal + sides[2].normal);
        const auto isBefore = [&](const Foot& f) { return dot(f.point - c.point, out) > 0; };
        if (c.distance > cornerReach * band.h[n] && (found < 3 || !std::all_of(sides.begin(), sides.end(), isBefore) || features.isCrowded(c, band.h[n]))) return;
        const double turned = 1 - dot(out, normalized(x[static_cast<std::size_t>(band.frontNode[n])] - c.point));
        put({c.distance / band.h[n] + besideCorner * turned, c.triangle, static_cast<std::int32_t>(n), c.point});
    }, 256);
    std::stable_sort(list.begin(), list.end(), [](const Candidate& a, const Candidate& b) { return a.distance < b.distance; });
    std::set<std::uint32_t> taken; // one node a corner
    for (const Snap& s : snaps) {
        if (s.kind == SnapKind::corner) taken.insert(features.closestCorner(s.point, std::numeric_limits<double>::infinity()).triangle);
    }
    std::size_t added = 0;
    for (const Candidate& c : list) {
        Snap& snap = snaps[static_cast<std::size_t>(c.node)];
        if (snap.kind == SnapKind::corner || !taken.insert(c.corner).second) continue;
        snap = {SnapKind::corner, c.point, {}};
        ++added;
    }
    return added;
}

} // namespace

FeatureIndex::Line snapLine(const SurfaceIndex& index, const FeatureIndex& features, const Snap& snap, const Vec3& x, double h) {
    FeatureIndex::Line line{snap.point, snap.tangent, true};
    if (snap.kind == SnapKind::line) {
        const FeatureIndex::Line now = features.closestLine(x, 0.5 * h);
        if (now.found) line = now;
    }
    if (snap.kind == SnapKind::implicitLine) { // straight, which the geometry need not be
        line.point += snap.tangent * dot(x - snap.point, snap.tangent);
        const ClosestPoint c = index.closest(line.point, mostBentAway * h);
        line.point = c ? c.point : snap.point; // which the geometry has confirmed
    }
    return line;
}

FeatureIndex::Line lineUpon(const FeatureIndex& features, const Vec3& x, double h) {
    const FeatureIndex::Line line = features.closestLine(x, upon * h);
    return line.found && !line.isRim && !features.hasOtherBeside(line, alone * h, aside * h) ? line : FeatureIndex::Line{};
}

std::size_t snapToFeatures(WallViews& views, const Front& front, const FeatureIndex& features,
                           const Positions& x, std::vector<Snap>& snaps) {
    const Band& band = views.band();
    const SurfaceIndex& index = views.index();
    std::vector<Foot> feet(band.walls);
    parallelFor(band.walls, [&](std::size_t n) { feet[n] = views.foot(n, x); });
    std::size_t added = snapCorners(band, index, features, feet, x, snaps);
    const EdgeLook look{band, index, features, x, feet, snaps};
    RawVector<Crossing> crossings = collect<Crossing>(front.mesh.n_edges(), [&](std::size_t e, const auto& put) {
        const auto he = front.mesh.halfedge_handle(FrontMesh::EdgeHandle(static_cast<int>(e)), 0);
        for (const Crossing& c : look.crossingsOf(front.mesh.from_vertex_handle(he).idx(), front.mesh.to_vertex_handle(he).idx()))
            if (c.node >= 0) put(c);
    }, 256);
    std::stable_sort(crossings.begin(), crossings.end(), [](const Crossing& a, const Crossing& b) { return a.distance < b.distance; });
    const auto isTaken = [&](const Crossing& c) {
        const std::span<const BandEdge> edges = band.edges[static_cast<std::size_t>(c.node)];
        return std::any_of(edges.begin(), edges.end(), [&](const BandEdge& edge) {
            const auto m = static_cast<std::size_t>(edge.b);
            return m < band.walls && snaps[m].kind != SnapKind::none && norm(snaps[m].point - c.snap.point) < apart * band.h[m];
        });
    };
    for (const Crossing& c : crossings) {
        Snap& snap = snaps[static_cast<std::size_t>(c.node)];
        if (snap.kind != SnapKind::none || (c.other >= 0 && snaps[static_cast<std::size_t>(c.other)].kind != SnapKind::none) || isTaken(c)) continue;
        snap = c.snap;
        ++added;
    }
    return added;
}

std::size_t splitAlongFeatures(Front& front, const Band& band, const SurfaceIndex& index, const FeatureIndex& features,
                               const Positions& x, const std::vector<Snap>& snaps) {
    const std::size_t faces = front.ownerCell.size();
    std::vector<std::int8_t> diagonal(faces, -1); // 0: vertices 0 and 2, 1: vertices 1 and 3
    const auto verticesOf = [&](std::size_t f, std::array<std::int32_t, 8>& v) {
        std::size_t n = 0;
        for (auto h : front.mesh.fv_range(FrontMesh::FaceHandle(static_cast<int>(f)))) v[n++] = h.idx();
        return n;
    };
    // Where a node will be: snapped ones have not arrived yet.
    const auto going = [&](std::size_t n) { return snaps[n].kind == SnapKind::none ? x[n] : snaps[n].point; };
    const auto angle = [&](std::size_t at, std::size_t p, std::size_t q) { // cosine
        return dot(normalized(going(p) - going(at)), normalized(going(q) - going(at)));
    };
    const auto isThin = [&](std::size_t p, std::size_t q, std::size_t r) {
        return angle(p, q, r) > thinCorner || angle(q, r, p) > thinCorner || angle(r, p, q) > thinCorner;
    };
    // A cut from p to q runs along a sharp edge of the soup, or the nodes beside it, r and t, stand on different sides of a line.
    const auto crossesAlong = [&](std::size_t p, std::size_t q, std::size_t r, std::size_t t) {
        const FeatureIndex::Line line = features.closestLine((going(p) + going(q)) * 0.5, onLine * band.h[p]);
        if (line.found && std::abs(dot(line.tangent, normalized(going(q) - going(p)))) > alongLine) return true;
        if (snaps[r].kind != SnapKind::none || snaps[t].kind != SnapKind::none) return false;
        const Foot a = footOf(band, index, x, r), b = footOf(band, index, x, t);
        return a.found && b.found && (dot(a.normal, b.normal) <= smallestTurn || a.part != b.part);
    };
    const auto isSnapped = [&](std::size_t n) { return snaps[n].kind != SnapKind::none; };
    parallelFor(faces, [&](std::size_t f) {
        std::array<std::int32_t, 8> v{};
        if (verticesOf(f, v) != 4 || front.staysWhole(f)) return;
        double widest = 2; // cosine; below flatCorner for corners that ask for a cut
        for (std::size_t d = 0; d < 2; ++d) {
            const auto s = [&](std::size_t i) { return static_cast<std::size_t>(v[(i + d) % 4]); };
            if (isThin(s(0), s(1), s(2)) || isThin(s(0), s(2), s(3))) continue; // three nodes of one line
            // A snapped node between two others of the same line has no corner in the quad: two triangles give it two.
            double corner = std::min(isSnapped(s(0)) ? angle(s(0), s(1), s(3)) : 1, isSnapped(s(2)) ? angle(s(2), s(3), s(1)) : 1);
            if (corner > flatCorner) {
                if (!isSnapped(s(0)) || !isSnapped(s(2)) || !crossesAlong(s(0), s(2), s(1), s(3))) continue;
                corner = 1;
            }
            if (corner < widest) widest = corner, diagonal[f] = static_cast<std::int8_t>(d);
        }
    });
    std::vector<FaceCut> cuts;
    for (std::size_t f = 0; f < faces; ++f) {
        if (diagonal[f] < 0) continue;
        std::array<std::int32_t, 8> v{};
        verticesOf(f, v);
        const auto d = static_cast<std::size_t>(diagonal[f]);
        cuts.push_back({static_cast<std::int32_t>(f), {{v[d], v[d + 1], v[d + 2]}, {v[d], v[d + 2], v[(d + 3) % 4]}}});
    }
    replaceFaces(front, cuts);
    return cuts.size();
}

} // namespace i2b
