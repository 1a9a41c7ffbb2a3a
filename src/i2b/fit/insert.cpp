#include "i2b/fit/insert.h"
#include "i2b/core/collect.h"
#include "i2b/core/flags.h"
#include "i2b/fit/crossings.h"
#include "i2b/fit/fit.h"
#include "i2b/fit/front_room.h"
#include "i2b/fit/lie.h"
#include "i2b/fit/wall_views.h"
#include "i2b/front/replace_faces.h"
#include <algorithm>

namespace i2b {
namespace {

constexpr double follows = 0.2;      // of h: so near to a line what a cut along it ends at may be
constexpr double onLine = 0.1;       // of h: a cut whose middle is so near to a line lies on it
constexpr double onGeometry = 0.03;  // of h: so near to the geometry the middle of a cut from bend to bend must be
constexpr double nearer = 0.8;       // share of its distance that the pieces of a face may keep where bends are cut
const double alongLine = std::cos(20 * 3.14159265358979323846 / 180);
constexpr double worstCorner = 0.06; // scaled Jacobian that a piece of a prism must have,
constexpr double worstGood = 0.15;   // and where no line asks for it
constexpr double straight = -0.97;   // cosine: the angle at a vertex that is no corner
constexpr std::size_t mostVertices = 8; // of a front face

struct Place { // a vertex of a face that may be cut
    std::int32_t vertex = -1;    // of the front; or
    std::int32_t crossing = -1;
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
    Inserter(Front& front, WallViews& views, const FeatureIndex& features, std::vector<Vec3>& x,
             std::vector<Snap>& snaps)
        : front_(front), band_(views.band()), index_(views.index()), features_(features), x_(x), snaps_(snaps), marks_(markWall(views, features, x, snaps)) {}
    std::size_t run();

  private:
    bool runsAlong(const Place& from, const Place& to) const;
    Ring ringOf(std::size_t face) const;
    Cuts cutsOf(std::size_t face) const;
    void divide(const Ring& ring, Cuts& cuts) const;
    bool bestCut(const Ring& ring, std::size_t& from, std::size_t& to) const;
    bool differ(const Ring& ring, std::size_t from, std::size_t to) const;
    bool liesOnLine(const Ring& ring, std::size_t from, std::size_t to) const;
    Foot footUnder(const Ring& ring, std::size_t from, std::size_t to) const;
    bool isOnOneEdge(const Ring& ring) const;
    bool isValid(const Ring& ring, double worst) const;
    bool isOptional(const Place& p) const;
    bool isOnBend(const Place& p) const;
    Lie lieOfRing(const Ring& ring) const;
    bool isNearer(const Ring& ring, const std::vector<Ring>& pieces) const;
    bool dents(const Place& p) const;
    bool isOfWholeFace(std::int32_t edge) const;
    void lookForCrossings();
    std::vector<RoomWish> roomWanted(const std::vector<Cuts>& cuts) const;
    void wishRoom(const Ring& piece, std::vector<RoomWish>& wishes) const;
    bool stepAsideWhereRefused(const std::vector<Cuts>& cuts);
    bool prune(const std::vector<Cuts>& cuts);
    void apply(const std::vector<Cuts>& cuts);
    const Vec3& wallAt(const Place& p) const { return p.vertex >= 0 ? x_[std::size_t(p.vertex)] : crossings_[std::size_t(p.crossing)].wall; }
    double hAt(const Place& p) const { return band_.h[std::size_t(p.vertex >= 0 ? p.vertex : crossings_[std::size_t(p.crossing)].p)]; }
    const Vec3& frontAt(const Place& p) const {
        return p.vertex >= 0 ? x_[std::size_t(band_.frontNode[std::size_t(p.vertex)])] : crossings_[std::size_t(p.crossing)].front;
    }

    Front& front_;
    const Band& band_;
    const SurfaceIndex& index_;
    const FeatureIndex& features_;
    std::vector<Vec3>& x_;
    std::vector<Snap>& snaps_;
    const WallMarks marks_;
    std::vector<EdgeCrossing> crossings_;
    std::vector<std::int32_t> crossingOf_;  // per edge of the front; -1: none
    RawVector<std::int32_t> faces_;          // that may be cut, ascending
};

Ring Inserter::ringOf(std::size_t face) const {
    Ring ring;
    for (auto he : front_.mesh.fh_range(FrontMesh::FaceHandle(static_cast<int>(face)))) {
        const std::int32_t v = front_.mesh.from_vertex_handle(he).idx();
        ring.push_back({v, -1, marks_.onLine[std::size_t(v)] != 0, false});
        const std::int32_t c = crossingOf_[std::size_t(front_.mesh.edge_handle(he).idx())];
        if (c >= 0 && crossings_[std::size_t(c)].alive) ring.push_back({-1, c, true, false});
    }
    return ring;
}

// Does the line that an end of a cut lies on, beside another line, lead to the other end?
bool Inserter::runsAlong(const Place& from, const Place& to) const {
    if (from.crossing < 0) return false;
    const EdgeCrossing& c = crossings_[std::size_t(from.crossing)];
    const Vec3 way = wallAt(to) - c.wall;
    return c.beside && norm(way - c.tangent * dot(way, c.tangent)) < follows * band_.h[std::size_t(c.p)];
}

// Do nodes at both sides of a cut stand on different sides of a line, or does it lie in a bend?
bool Inserter::differ(const Ring& ring, std::size_t from, std::size_t to) const {
    const Vec3 middle = (wallAt(ring[from]) + wallAt(ring[to])) * 0.5;
    if (isOnBend(ring[from]) || isOnBend(ring[to])) return bool(index_.closest(middle, onGeometry * hAt(ring[from])));
    if (runsAlong(ring[from], ring[to]) || runsAlong(ring[to], ring[from])) return true;
    for (std::size_t i = from + 1; i < to; ++i) {
        if (ring[i].star) continue;
        const Foot& a = marks_.feet[std::size_t(ring[i].vertex)];
        for (std::size_t j = to + 1; j < ring.size() + from; ++j) {
            const Place& other = ring[j % ring.size()];
            if (other.star) continue;
            const Foot& b = marks_.feet[std::size_t(other.vertex)];
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

bool Inserter::isOnOneEdge(const Ring& ring) const {
    std::vector<std::int32_t> vertices;
    for (const Place& p : ring) {
        if (p.vertex >= 0) {
            vertices.push_back(p.vertex);
        } else {
            const EdgeCrossing& c = crossings_[std::size_t(p.crossing)];
            vertices.insert(vertices.end(), {c.p, c.q});
        }
    }
    return front_.areOnOneEdge(vertices);
}

// Corners of the prism on a piece; new vertices in the middle of an edge have none, nor has any where the piece goes on all but straight.
bool Inserter::isValid(const Ring& ring, double worst) const {
    const std::size_t n = ring.size();
    if (n > mostVertices || isOnOneEdge(ring) || std::any_of(ring.begin(), ring.end(), [&](const Place& p) { return dents(p); })) return false;
    const auto isGood = [worst](const Vec3& a, const Vec3& b, const Vec3& c) {
        const double l = norm(a) * norm(b) * norm(c);
        return (l > 0 && dot(cross(a, b), c) >= worst * l) || dot(a, b) < straight * norm(a) * norm(b);
    };
    for (std::size_t i = 0; i < n; ++i) {
        const Place &before = ring[(i + n - 1) % n], &at = ring[i], &after = ring[(i + 1) % n];
        if (at.vertex < 0 && !at.isEnd) continue;
        const Vec3 way = wallAt(at) - frontAt(at);
        if (!isGood(frontAt(after) - frontAt(at), frontAt(before) - frontAt(at), way)) return false;
        if (!isGood(wallAt(before) - wallAt(at), wallAt(after) - wallAt(at), -way)) return false;
    }
    return true;
}

// Does no line ask for it?
bool Inserter::isOptional(const Place& p) const { return p.crossing >= 0 && crossings_[std::size_t(p.crossing)].kind == SnapKind::none; }

bool Inserter::isOnBend(const Place& p) const { return p.crossing >= 0 && crossings_[std::size_t(p.crossing)].bend; }

Lie Inserter::lieOfRing(const Ring& ring) const {
    std::array<Vec3, 2 * mostVertices> x;
    std::size_t n = 0;
    for (const Place& p : ring) {
        if (n < x.size()) x[n++] = wallAt(p);
    }
    return lieOf(index_, std::span(x).first(n), hAt(ring.front()));
}

// A cut at bends pays only where the pieces are much nearer to the geometry than the whole face, and none leans.
bool Inserter::isNearer(const Ring& ring, const std::vector<Ring>& pieces) const {
    Ring whole = ring;
    std::erase_if(whole, [](const Place& p) { return p.vertex < 0; });
    const Lie before = lieOfRing(whole);
    double off = 0;
    for (const Ring& piece : pieces) {
        const Lie lie = lieOfRing(piece);
        if (lie.cosine < std::min(tilted, before.cosine)) return false;
        off += lie.off / static_cast<double>(pieces.size());
    }
    return off < nearer * before.off;
}

// Would a bend that no cut ends at stick into the prism over the uncut face?
bool Inserter::dents(const Place& p) const {
    if (!isOnBend(p) || p.isEnd) return false;
    const EdgeCrossing& c = crossings_[std::size_t(p.crossing)];
    const Vec3 &a = x_[std::size_t(c.p)], &b = x_[std::size_t(c.q)];
    return dot(c.wall - (a + (b - a) * c.t), c.front - c.wall) > 0;
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
    const bool mustBeGood = std::any_of(ring.begin(), ring.end(), [&](const Place& p) { return isOptional(p); });
    const double worst = mustBeGood ? worstGood : worstCorner;
    cuts.valid = !touched || std::all_of(cuts.pieces.begin(), cuts.pieces.end(), [&](const Ring& piece) { return isValid(piece, worst); });
    if (cuts.valid && cuts.pieces.size() > 1 && std::any_of(ring.begin(), ring.end(), [&](const Place& p) { return isOnBend(p); })) cuts.valid = isNearer(ring, cuts.pieces);
    return cuts;
}

// Of corners of a piece that have too little height under the front.
void Inserter::wishRoom(const Ring& piece, std::vector<RoomWish>& wishes) const {
    const std::size_t n = piece.size();
    for (std::size_t i = 0; i < n; ++i) {
        const Place& at = piece[i];
        if (at.vertex < 0 && !at.isEnd) continue;
        const Vec3 before = wallAt(piece[(i + n - 1) % n]) - wallAt(at), after = wallAt(piece[(i + 1) % n]) - wallAt(at);
        const Vec3 normal = normalized(cross(before, after)), way = frontAt(at) - wallAt(at);
        if (norm(cross(before, after)) <= leastSlope * norm(before) * norm(after) || dot(normal, way) >= leastSlope * norm(way)) continue;
        if (at.vertex >= 0) {
            wishes.push_back({at.vertex, normal, -1, 0, wallAt(at)});
        } else {
            const EdgeCrossing& c = crossings_[std::size_t(at.crossing)];
            wishes.push_back({c.p, normal, c.q, c.t, c.wall});
        }
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

// Gives up crossings of faces that cannot take them, and those that end no cut; beside one on a line those that need not be come first.
// False: nothing to give up.
bool Inserter::prune(const std::vector<Cuts>& cuts) {
    std::vector<std::uint8_t> used(crossings_.size(), 0), refused(crossings_.size(), 0);
    parallelFor(cuts.size(), [&](std::size_t i) {
        const bool anyOptional = !cuts[i].valid && std::any_of(cuts[i].pieces.begin(), cuts[i].pieces.end(), [&](const Ring& piece) {
            return std::any_of(piece.begin(), piece.end(), [&](const Place& p) { return isOptional(p); });
        });
        for (const Ring& piece : cuts[i].pieces) {
            for (const Place& p : piece) {
                if (p.crossing < 0) continue;
                if (p.isEnd) setFlag(used[std::size_t(p.crossing)]);
                if (!cuts[i].valid && isOptional(p) == anyOptional) setFlag(refused[std::size_t(p.crossing)]);
            }
        }
    });
    bool any = false;
    for (std::size_t i = 0; i < crossings_.size(); ++i) {
        if (!crossings_[i].alive || (used[i] && !refused[i])) continue;
        crossings_[i].alive = false;
        any = true;
    }
    return any;
}

// A cut is refused where a prism of it would fold: the place on the front is then as straight under the wall's as its edge
// allows, which follows the other side of the layer less evenly. Gives whether any crossing moved.
bool Inserter::stepAsideWhereRefused(const std::vector<Cuts>& cuts) {
    std::vector<std::uint8_t> refused(crossings_.size(), 0);
    for (const Cuts& c : cuts) {
        if (c.valid || c.pieces.size() < 2) continue;
        for (const Ring& piece : c.pieces) {
            for (const Place& p : piece) {
                if (p.crossing >= 0) refused[std::size_t(p.crossing)] = 1;
            }
        }
    }
    bool any = false;
    for (std::size_t i = 0; i < crossings_.size(); ++i) {
        if (refused[i]) any = stepAside(band_, index_, x_, crossings_[i]) || any;
    }
    return any;
}

void Inserter::apply(const std::vector<Cuts>& cuts) {
    std::vector<std::int32_t> vertexOf(crossings_.size(), -1);
    const auto lattice = static_cast<std::int32_t>(front_.corePoints);
    for (std::size_t i = 0; i < crossings_.size(); ++i) {
        const EdgeCrossing& c = crossings_[i];
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
        snaps_.push_back({c.kind, c.wall, c.tangent});
    }
    std::vector<FaceCut> faceCuts;
    for (std::size_t i = 0; i < cuts.size(); ++i) {
        const bool whole = !cuts[i].valid || (cuts[i].pieces.size() == 1 && std::all_of(cuts[i].pieces[0].begin(), cuts[i].pieces[0].end(), [](const Place& p) { return p.vertex >= 0; }));
        if (whole) continue;
        FaceCut& cut = faceCuts.emplace_back();
        cut.face = faces_[i];
        for (const Ring& piece : cuts[i].pieces) {
            std::vector<std::int32_t>& polygon = cut.polygons.emplace_back();
            for (const Place& p : piece) polygon.push_back(p.vertex >= 0 ? p.vertex : vertexOf[std::size_t(p.crossing)]);
        }
    }
    replaceFaces(front_, faceCuts);
}

bool Inserter::isOfWholeFace(std::int32_t edge) const {
    for (const unsigned side : {0u, 1u}) {
        const auto face = front_.mesh.face_handle(front_.mesh.halfedge_handle(FrontMesh::EdgeHandle(edge), side));
        if (face.is_valid() && front_.staysWhole(static_cast<std::size_t>(face.idx()))) return true;
    }
    return false;
}

void Inserter::lookForCrossings() {
    crossings_ = findCrossings(front_, band_, index_, features_, x_, marks_);
    std::erase_if(crossings_, [&](const EdgeCrossing& c) { return isOfWholeFace(c.edge); });
    crossingOf_.assign(front_.mesh.n_edges(), -1);
    for (std::size_t i = 0; i < crossings_.size(); ++i) crossingOf_[std::size_t(crossings_[i].edge)] = static_cast<std::int32_t>(i);
    faces_ = collect<std::int32_t>(front_.ownerCell.size(), [&](std::size_t f, const auto& put) {
        std::size_t stars = 0, crossed = 0;
        for (auto he : front_.mesh.fh_range(FrontMesh::FaceHandle(static_cast<int>(f)))) {
            stars += marks_.onLine[std::size_t(front_.mesh.from_vertex_handle(he).idx())];
            crossed += crossingOf_[std::size_t(front_.mesh.edge_handle(he).idx())] >= 0;
        }
        if ((crossed > 0 || stars > 1) && !front_.staysWhole(f)) put(static_cast<std::int32_t>(f));
    }, 2048);
}

std::size_t Inserter::run() {
    lookForCrossings();
    std::vector<Cuts> cuts;
    const auto cutAll = [&] {
        cuts.resize(faces_.size());
        parallelFor(faces_.size(), [&](std::size_t i) { cuts[i] = cutsOf(static_cast<std::size_t>(faces_[i])); }, 64);
    };
    cutAll();
    if (makeRoom(roomWanted(cuts), band_, index_, x_, front_) > 0) {
        followFront(band_, index_, x_, crossings_);
        cutAll();
    }
    if (stepAsideWhereRefused(cuts)) cutAll();
    const auto isStale = [&](const Cuts& c) {
        return std::any_of(c.pieces.begin(), c.pieces.end(), [&](const Ring& piece) {
            return std::any_of(piece.begin(), piece.end(), [&](const Place& p) { return p.crossing >= 0 && !crossings_[std::size_t(p.crossing)].alive; });
        });
    };
    while (prune(cuts)) {
        parallelFor(faces_.size(), [&](std::size_t i) {
            if (isStale(cuts[i])) cuts[i] = cutsOf(static_cast<std::size_t>(faces_[i]));
        }, 64);
    }
    apply(cuts);
    return front_.inserted.size();
}

} // namespace

std::size_t insertVertices(Front& front, WallViews& views, const FeatureIndex& features, std::vector<Vec3>& x,
                           std::vector<Snap>& snaps) {
    return Inserter(front, views, features, x, snaps).run();
}

} // namespace i2b
