#include "i2b/fit/insert.h"
#include "i2b/core/parallel.h"
#include "i2b/fit/between.h"
#include "i2b/fit/fit.h"
#include "i2b/fit/front_room.h"
#include "i2b/front/replace_faces.h"
#include <algorithm>

namespace i2b {
namespace {

constexpr double nearEnd = 0.12;     // of an edge: crossings nearer to an end are that node's own business
constexpr double farOff = 0.6;       // of an edge: crossings farther from it belong to another one
constexpr double nearStar = 0.2;     // of h: crossings nearer to an end that stands on another line are left
constexpr double beforeEnd = 0.85;   // of an edge: where it is beside the line that its end stands on
constexpr double follows = 0.2;      // of h: so near to a line what a cut along it ends at may be
constexpr double bridged = 0.04;     // of h: an edge whose places are farther off the geometry bridges a corner
constexpr double onLine = 0.1;       // of h: a snapped node so near to its line stands on it
const double alongLine = std::cos(20 * 3.14159265358979323846 / 180);
constexpr double upon = 0.02;        // of h: a node so near to two parts stands on their border
constexpr double worstCorner = 0.03; // scaled Jacobian that a piece of a prism must have
constexpr std::size_t mostVertices = 8; // of a front face

struct Candidate {
    std::int32_t edge = -1, p = -1, q = -1; // of the front; its vertices
    double t = 0;
    Vec3 front, wall;                       // m
    bool alive = true;
    bool beside = false;                    // an end of the edge stands on another line
    Vec3 tangent;                           // unit, of the line or border
};

struct Place { // a vertex of a face that may be cut
    std::int32_t vertex = -1;    // of the front; or
    std::int32_t candidate = -1;
    bool star = false;           // stands on a line or border
    bool isEnd = false;          // of a cut
};
using Ring = std::vector<Place>;

struct Cuts { // of one face
    std::vector<Ring> pieces;
    bool valid = true;
};

class Inserter {
  public:
    Inserter(Front& front, const Band& band, const SurfaceIndex& index, const FeatureIndex& features, std::vector<Vec3>& x,
             const std::vector<Snap>& snaps)
        : front_(front), band_(band), index_(index), features_(features), x_(x), snaps_(snaps) {}
    std::size_t run();

  private:
    void look();
    Candidate crossingOn(std::int32_t edge) const;
    Between lineOn(std::size_t p, std::size_t q) const;
    Between lineBeside(std::size_t star, std::size_t other) const;
    bool runsAlong(const Place& from, const Place& to) const;
    Ring ringOf(std::size_t face) const;
    Cuts cutsOf(std::size_t face) const;
    void divide(const Ring& ring, Cuts& cuts) const;
    bool bestCut(const Ring& ring, std::size_t& from, std::size_t& to) const;
    bool differ(const Ring& ring, std::size_t from, std::size_t to) const;
    bool liesOnLine(const Ring& ring, std::size_t from, std::size_t to) const;
    Foot footUnder(const Ring& ring, std::size_t from, std::size_t to) const;
    bool isValid(const Ring& ring) const;
    void findCandidates();
    std::vector<RoomWish> roomWanted(const std::vector<Cuts>& cuts) const;
    void wishRoom(const Ring& piece, std::vector<RoomWish>& wishes) const;
    bool prune(const std::vector<Cuts>& cuts);
    void apply(const std::vector<Cuts>& cuts);
    const Vec3& wallAt(const Place& p) const { return p.vertex >= 0 ? x_[std::size_t(p.vertex)] : candidates_[std::size_t(p.candidate)].wall; }
    double hAt(const Place& p) const { return band_.h[std::size_t(p.vertex >= 0 ? p.vertex : candidates_[std::size_t(p.candidate)].p)]; }
    const Vec3& frontAt(const Place& p) const {
        return p.vertex >= 0 ? x_[std::size_t(band_.frontNode[std::size_t(p.vertex)])] : candidates_[std::size_t(p.candidate)].front;
    }

    Front& front_;
    const Band& band_;
    const SurfaceIndex& index_;
    const FeatureIndex& features_;
    std::vector<Vec3>& x_;
    const std::vector<Snap>& snaps_;
    std::vector<Foot> feet_;                 // per wall node
    std::vector<std::uint8_t> star_;         // per wall node
    std::vector<Candidate> candidates_;
    std::vector<std::int32_t> candidateOf_;  // per edge of the front; -1: none
    std::vector<std::int32_t> faces_;        // that may be cut, ascending
};

void Inserter::look() {
    feet_.resize(band_.walls), star_.assign(band_.walls, 0);
    parallelFor(band_.walls, [&](std::size_t n) {
        feet_[n] = footOf(band_, index_, x_, n);
        star_[n] = snaps_[n].kind != SnapKind::none && norm(snapLine(index_, features_, snaps_[n], x_[n], band_.h[n]).point - x_[n]) <= onLine * band_.h[n];
    });
    parallelFor(band_.walls, [&](std::size_t n) {
        if (star_[n] || !feet_[n].found) return;
        for (const BandEdge& e : band_.edges[n]) {
            const auto m = static_cast<std::size_t>(e.b);
            if (m >= band_.walls || feet_[m].part == feet_[n].part) continue;
            star_[n] = hasOtherPartNear(index_, feet_[n], upon * band_.h[n]);
            return;
        }
    });
}

Between Inserter::lineOn(std::size_t p, std::size_t q) const {
    const Foot &a = feet_[p], &b = feet_[q];
    const double h = std::max(band_.h[p], band_.h[q]);
    if (turns(a, b)) return lineBetween(index_, features_, a, b, x_[std::size_t(band_.frontNode[p])], h);
    if (a.found && b.found && a.part != b.part) return borderBetween(index_, a, b, h);
    return {};
}

// The line between a node that stands on one itself and another: what the edge passes on its way differs from what it comes
// to at the other end.
Between Inserter::lineBeside(std::size_t star, std::size_t other) const {
    const double h = std::max(band_.h[star], band_.h[other]);
    const Vec3 fluid = (x_[std::size_t(band_.frontNode[star])] + x_[std::size_t(band_.frontNode[other])]) * 0.5;
    const Foot foot = !star_[other] ? feet_[other] : footAt(index_, x_[star] + (x_[other] - x_[star]) * beforeEnd, fluid, h);
    if (!foot.found) return {};
    for (const double share : {0.5, 0.25}) {
        const Vec3 way = x_[star] + (x_[other] - x_[star]) * share;
        Foot passed = footAt(index_, way, fluid, h);
        if (!passed.found) continue;
        Between between;
        if (turns(passed, foot) && norm(passed.point - way) > bridged * h) {
            between = lineUnder(index_, features_, foot, passed, fluid, h);
        } else if (!turns(passed, foot) && passed.part != foot.part) {
            between = borderBetween(index_, passed, foot, h);
        }
        if (between.line.found) return between;
    }
    return {};
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

Candidate Inserter::crossingOn(std::int32_t edge) const {
    const auto he = front_.mesh.halfedge_handle(FrontMesh::EdgeHandle(edge), 0);
    Candidate c{edge, front_.mesh.from_vertex_handle(he).idx(), front_.mesh.to_vertex_handle(he).idx(), 0, {}, {}, false, false, {}};
    const auto p = static_cast<std::size_t>(c.p), q = static_cast<std::size_t>(c.q);
    if ((band_.outside[p] & band_.outside[q]) != 0) return c;
    const auto isShared = [&](std::size_t n) { return band_.fansOf[std::size_t(band_.frontNode[n]) - band_.walls].size() > 1; };
    if (isShared(p) && isShared(q)) return c; // another sheet's edge may have the same ends
    c.beside = star_[p] || star_[q];
    Between between = !c.beside ? lineOn(p, q) : star_[p] ? lineBeside(p, q) : lineBeside(q, p);
    if (!between.line.found && star_[p] && star_[q]) between = lineBeside(q, p);
    if (!between.line.found) return c;
    const Vec3 &a = x_[p], &b = x_[q];
    const double length = norm(b - a);
    c.t = nearestOn(between.line, a, b, c.wall);
    for (int round = 0; round < 2 && between.kind == SnapKind::line && !c.beside; ++round) {
        between.line = features_.closestLine(a + (b - a) * std::clamp(c.t, 0.0, 1.0), length);
        if (!between.line.found) return c;
        c.t = nearestOn(between.line, a, b, c.wall);
    }
    // Beside another line, that one may be nearer to the edge.
    if (between.kind == SnapKind::line) c.wall = features_.closestLine(c.beside ? c.wall : a + (b - a) * std::clamp(c.t, 0.0, 1.0), length).point;
    if (!(c.t > nearEnd && c.t < 1 - nearEnd)) return c;
    c.tangent = between.line.tangent;
    if (between.kind != SnapKind::line) {
        const ClosestPoint on = index_.closest(c.wall, farOff * length);
        if (!on) return c;
        c.wall = on.point;
    }
    if (norm(a + (b - a) * c.t - c.wall) > farOff * length) return c;
    const auto isNear = [&](std::size_t n) { return star_[n] && norm(c.wall - x_[n]) < nearStar * band_.h[p]; };
    if (isNear(p) || isNear(q)) return c;
    const Vec3 &f = x_[std::size_t(band_.frontNode[p])], &g = x_[std::size_t(band_.frontNode[q])];
    c.front = f + (g - f) * c.t;
    c.alive = !index_.firstHit(c.front, c.wall, 0.97);
    return c;
}

Ring Inserter::ringOf(std::size_t face) const {
    Ring ring;
    for (auto he : front_.mesh.fh_range(FrontMesh::FaceHandle(static_cast<int>(face)))) {
        const std::int32_t v = front_.mesh.from_vertex_handle(he).idx();
        ring.push_back({v, -1, star_[std::size_t(v)] != 0, false});
        const std::int32_t c = candidateOf_[std::size_t(front_.mesh.edge_handle(he).idx())];
        if (c >= 0 && candidates_[std::size_t(c)].alive) ring.push_back({-1, c, true, false});
    }
    return ring;
}

// Does the line that an end of a cut lies on, beside another line, lead to the other end?
bool Inserter::runsAlong(const Place& from, const Place& to) const {
    if (from.candidate < 0) return false;
    const Candidate& c = candidates_[std::size_t(from.candidate)];
    const Vec3 way = wallAt(to) - c.wall;
    return c.beside && norm(way - c.tangent * dot(way, c.tangent)) < follows * band_.h[std::size_t(c.p)];
}

// Do nodes at both sides of a cut stand on different sides of a line?
bool Inserter::differ(const Ring& ring, std::size_t from, std::size_t to) const {
    if (runsAlong(ring[from], ring[to]) || runsAlong(ring[to], ring[from])) return true;
    for (std::size_t i = from + 1; i < to; ++i) {
        if (ring[i].star) continue;
        const Foot& a = feet_[std::size_t(ring[i].vertex)];
        for (std::size_t j = to + 1; j < ring.size() + from; ++j) {
            const Place& other = ring[j % ring.size()];
            if (other.star) continue;
            const Foot& b = feet_[std::size_t(other.vertex)];
            if (a.found && b.found && (turns(a, b) || a.part != b.part)) return true;
        }
    }
    return liesOnLine(ring, from, to);
}

// What lies under the middle of the piece of a face from one place to another, round the way the ring goes.
Foot Inserter::footUnder(const Ring& ring, std::size_t from, std::size_t to) const {
    Vec3 wall, front;
    double n = 0;
    for (std::size_t i = from; i <= (to > from ? to : to + ring.size()); ++i, ++n) {
        wall += wallAt(ring[i % ring.size()]);
        front += frontAt(ring[i % ring.size()]);
    }
    return footAt(index_, wall / n, front / n, hAt(ring[from]));
}

// Nodes that all stand on lines themselves do not say what they part: what lies under the two pieces does.
bool Inserter::liesOnLine(const Ring& ring, std::size_t from, std::size_t to) const {
    const Vec3 &a = wallAt(ring[from]), &b = wallAt(ring[to]);
    const FeatureIndex::Line line = features_.closestLine((a + b) * 0.5, onLine * hAt(ring[from]));
    if (!line.found || std::abs(dot(line.tangent, normalized(b - a))) < alongLine) return false;
    const Foot one = footUnder(ring, from, to), other = footUnder(ring, to, from);
    return one.found && other.found && (turns(one, other) || one.part != other.part);
}

// The cut with most new ends, the shortest of these.
bool Inserter::bestCut(const Ring& ring, std::size_t& from, std::size_t& to) const {
    int most = -1;
    double shortest = 0;
    for (std::size_t i = 0; i < ring.size(); ++i) {
        for (std::size_t j = i + 2; j < ring.size(); ++j) {
            if ((i == 0 && j + 1 == ring.size()) || !ring[i].star || !ring[j].star || (ring[i].isEnd && ring[j].isEnd)) continue;
            const int fresh = (ring[i].vertex < 0 && !ring[i].isEnd) + (ring[j].vertex < 0 && !ring[j].isEnd);
            const double length = norm2(wallAt(ring[i]) - wallAt(ring[j]));
            if (fresh < most || (fresh == most && length >= shortest) || !differ(ring, i, j)) continue;
            most = fresh, shortest = length, from = i, to = j;
        }
    }
    return most >= 0;
}

// Corners of the prism on a piece; new vertices in the middle of an edge have none.
bool Inserter::isValid(const Ring& ring) const {
    const std::size_t n = ring.size();
    if (n > mostVertices) return false;
    for (std::size_t i = 0; i < n; ++i) {
        const Place &before = ring[(i + n - 1) % n], &at = ring[i], &after = ring[(i + 1) % n];
        if (at.vertex < 0 && !at.isEnd) continue;
        const auto corner = [](const Vec3& a, const Vec3& b, const Vec3& c) {
            const double l = norm(a) * norm(b) * norm(c);
            return l > 0 ? dot(cross(a, b), c) / l : -1;
        };
        const Vec3 way = wallAt(at) - frontAt(at);
        if (corner(frontAt(after) - frontAt(at), frontAt(before) - frontAt(at), way) < worstCorner) return false;
        if (corner(wallAt(before) - wallAt(at), wallAt(after) - wallAt(at), -way) < worstCorner) return false;
    }
    return true;
}

void Inserter::divide(const Ring& ring, Cuts& cuts) const {
    std::size_t from = 0, to = 0;
    if (!bestCut(ring, from, to)) {
        cuts.pieces.push_back(ring);
        return;
    }
    Ring one(ring.begin() + static_cast<std::ptrdiff_t>(from), ring.begin() + static_cast<std::ptrdiff_t>(to) + 1);
    Ring other(ring.begin() + static_cast<std::ptrdiff_t>(to), ring.end());
    other.insert(other.end(), ring.begin(), ring.begin() + static_cast<std::ptrdiff_t>(from) + 1);
    for (Ring* piece : {&one, &other}) {
        piece->front().isEnd = piece->back().isEnd = true;
        divide(*piece, cuts);
    }
}

Cuts Inserter::cutsOf(std::size_t face) const {
    const Ring ring = ringOf(face);
    Cuts cuts;
    divide(ring, cuts);
    const bool touched = cuts.pieces.size() > 1 || std::any_of(ring.begin(), ring.end(), [](const Place& p) { return p.vertex < 0; });
    cuts.valid = !touched || std::all_of(cuts.pieces.begin(), cuts.pieces.end(), [&](const Ring& piece) { return isValid(piece); });
    return cuts;
}

// Of the corners of a piece that stand right on the wall, with too little height under the front.
void Inserter::wishRoom(const Ring& piece, std::vector<RoomWish>& wishes) const {
    const std::size_t n = piece.size();
    for (std::size_t i = 0; i < n; ++i) {
        const Place& at = piece[i];
        if (at.vertex < 0) continue;
        const Vec3 before = wallAt(piece[(i + n - 1) % n]) - wallAt(at), after = wallAt(piece[(i + 1) % n]) - wallAt(at);
        const Vec3 normal = normalized(cross(before, after)), way = frontAt(at) - wallAt(at);
        if (norm(cross(before, after)) > leastSlope * norm(before) * norm(after) && dot(normal, way) < leastSlope * norm(way)) wishes.push_back({at.vertex, normal});
    }
}

// Where a cut is refused for the want of it.
std::vector<RoomWish> Inserter::roomWanted(const std::vector<Cuts>& cuts) const {
    std::vector<RoomWish> wishes;
    for (const Cuts& c : cuts) {
        if (c.valid || c.pieces.size() < 2) continue;
        for (const Ring& piece : c.pieces) wishRoom(piece, wishes);
    }
    return wishes;
}

// Gives up candidates of faces that cannot take them, and those that end no cut. False: nothing to give up.
bool Inserter::prune(const std::vector<Cuts>& cuts) {
    std::vector<std::uint8_t> used(candidates_.size(), 0), refused(candidates_.size(), 0);
    for (const Cuts& c : cuts) {
        for (const Ring& piece : c.pieces) {
            for (const Place& p : piece) {
                if (p.candidate < 0) continue;
                used[std::size_t(p.candidate)] |= p.isEnd;
                refused[std::size_t(p.candidate)] |= !c.valid;
            }
        }
    }
    bool any = false;
    for (std::size_t i = 0; i < candidates_.size(); ++i) {
        if (!candidates_[i].alive || (used[i] && !refused[i])) continue;
        candidates_[i].alive = false;
        any = true;
    }
    return any;
}

void Inserter::apply(const std::vector<Cuts>& cuts) {
    std::vector<std::int32_t> vertexOf(candidates_.size(), -1);
    const auto lattice = static_cast<std::int32_t>(front_.corePoints);
    for (std::size_t i = 0; i < candidates_.size(); ++i) {
        const Candidate& c = candidates_[i];
        if (!c.alive) continue;
        const auto p = static_cast<std::size_t>(c.p), q = static_cast<std::size_t>(c.q);
        vertexOf[i] = static_cast<std::int32_t>(front_.front.size());
        front_.mesh.add_vertex({c.wall.x, c.wall.y, c.wall.z});
        front_.corePoint.push_back(lattice + static_cast<std::int32_t>(front_.inserted.size()));
        front_.front.push_back(c.front);
        front_.h.push_back(std::min(front_.h[p], front_.h[q]));
        front_.size.push_back(cwiseMin(front_.size[p], front_.size[q]));
        front_.inside.push_back(front_.inside[p] + (front_.inside[q] - front_.inside[p]) * c.t);
        front_.direction.push_back(front_.direction[p]);
        front_.outside.push_back(front_.outside[p] & front_.outside[q]);
        front_.inserted.push_back({{c.p, c.q}, c.t});
    }
    std::vector<FaceCut> faceCuts;
    for (std::size_t i = 0; i < cuts.size(); ++i) {
        const bool whole = !cuts[i].valid || (cuts[i].pieces.size() == 1 && std::all_of(cuts[i].pieces[0].begin(), cuts[i].pieces[0].end(), [](const Place& p) { return p.vertex >= 0; }));
        if (whole) continue;
        FaceCut& cut = faceCuts.emplace_back();
        cut.face = faces_[i];
        for (const Ring& piece : cuts[i].pieces) {
            std::vector<std::int32_t>& polygon = cut.polygons.emplace_back();
            for (const Place& p : piece) polygon.push_back(p.vertex >= 0 ? p.vertex : vertexOf[std::size_t(p.candidate)]);
        }
    }
    replaceFaces(front_, faceCuts);
}

void Inserter::findCandidates() {
    const std::size_t edges = front_.mesh.n_edges();
    std::vector<Candidate> all(edges);
    parallelFor(edges, [&](std::size_t e) { all[e] = crossingOn(static_cast<std::int32_t>(e)); });
    candidates_.clear();
    candidateOf_.assign(edges, -1);
    for (std::size_t e = 0; e < edges; ++e) {
        if (!all[e].alive) continue;
        candidateOf_[e] = static_cast<std::int32_t>(candidates_.size());
        candidates_.push_back(all[e]);
    }
    faces_.clear();
    for (std::size_t f = 0; f < front_.ownerCell.size(); ++f) {
        std::size_t stars = 0, crossed = 0;
        for (auto he : front_.mesh.fh_range(FrontMesh::FaceHandle(static_cast<int>(f)))) {
            stars += star_[std::size_t(front_.mesh.from_vertex_handle(he).idx())];
            crossed += candidateOf_[std::size_t(front_.mesh.edge_handle(he).idx())] >= 0;
        }
        if (crossed > 0 || stars > 1) faces_.push_back(static_cast<std::int32_t>(f));
    }
}

std::size_t Inserter::run() {
    look();
    findCandidates();
    std::vector<Cuts> cuts;
    const auto cutAll = [&] {
        cuts.resize(faces_.size());
        parallelFor(faces_.size(), [&](std::size_t i) { cuts[i] = cutsOf(static_cast<std::size_t>(faces_[i])); }, 64);
    };
    cutAll();
    if (makeRoom(roomWanted(cuts), band_, index_, x_, front_) > 0) {
        findCandidates();
        cutAll();
    }
    while (prune(cuts)) cutAll();
    apply(cuts);
    return front_.inserted.size();
}

} // namespace

std::size_t insertVertices(Front& front, const Band& band, const SurfaceIndex& index, const FeatureIndex& features, std::vector<Vec3>& x,
                           const std::vector<Snap>& snaps) {
    return Inserter(front, band, index, features, x, snaps).run();
}

} // namespace i2b
