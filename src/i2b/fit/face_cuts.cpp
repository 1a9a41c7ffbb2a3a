#include "i2b/fit/face_cuts.h"
#include <algorithm>
#include <array>
#include <set>

namespace i2b {
namespace {

constexpr double follows = 0.2;      // of h: so near to a line what a cut along it ends at may be
constexpr double onLine = 0.1;       // of h: a cut whose middle is so near to a line lies on it
constexpr double onGeometry = 0.03;  // of h: so near to the geometry the middle of a cut from bend to bend must be
constexpr double nearer = 0.8;       // share of its distance that the pieces of a face may keep where bends are cut
const double alongLine = std::cos(20 * 3.14159265358979323846 / 180);
constexpr double leastCorner = 0.06; // scaled Jacobian that a piece of a prism must have,
constexpr double leastEver = 0.03;   // or, where the whole prism's are worse, as bad as these, but no worse than this,
constexpr double leastGood = 0.15;   // and where no line asks for it
constexpr double straight = -0.97;   // cosine: the angle at a vertex that is no corner
constexpr std::size_t mostVertices = 8; // of a front face

CutRing withoutCrossings(CutRing ring) {
    std::erase_if(ring, [](const CutPlace& p) { return p.vertex < 0; });
    return ring;
}

} // namespace

CutRing FaceCutter::ringOf(std::size_t face, std::int32_t also) const {
    CutRing ring;
    for (auto he : front_.mesh.fh_range(FrontMesh::FaceHandle(static_cast<int>(face)))) {
        const std::int32_t v = front_.mesh.from_vertex_handle(he).idx();
        ring.push_back({v, -1, marks_.onLine[std::size_t(v)] != 0, false});
        const std::int32_t c = crossingOf_[std::size_t(front_.mesh.edge_handle(he).idx())];
        if (c >= 0 && (c == also || crossings_[std::size_t(c)].alive)) ring.push_back({-1, c, true, false});
    }
    return ring;
}

// Does the line that an end of a cut lies on, beside another line, lead to the other end?
bool FaceCutter::runsAlong(const CutPlace& from, const CutPlace& to) const {
    if (from.crossing < 0) return false;
    const EdgeCrossing& c = crossings_[std::size_t(from.crossing)];
    const Vec3 way = wallAt(to) - c.wall;
    return c.beside && norm(way - c.tangent * dot(way, c.tangent)) < follows * band_.h[std::size_t(c.p)];
}

// Do nodes at both sides of a cut stand on different sides of a line, or does it lie in a bend?
bool FaceCutter::differ(const CutRing& ring, std::size_t from, std::size_t to) const {
    const Vec3 middle = (wallAt(ring[from]) + wallAt(ring[to])) * 0.5;
    if (isOnBend(ring[from]) || isOnBend(ring[to])) return bool(index_.closest(middle, onGeometry * hAt(ring[from])));
    if (runsAlong(ring[from], ring[to]) || runsAlong(ring[to], ring[from])) return true;
    for (std::size_t i = from + 1; i < to; ++i) {
        if (ring[i].star) continue;
        const Foot& a = marks_.feet[std::size_t(ring[i].vertex)];
        for (std::size_t j = to + 1; j < ring.size() + from; ++j) {
            const CutPlace& other = ring[j % ring.size()];
            if (other.star) continue;
            const Foot& b = marks_.feet[std::size_t(other.vertex)];
            if (a.found && b.found && (turns(a, b) || a.part != b.part)) return true;
        }
    }
    return liesOnLine(ring, from, to);
}

// What lies under the middle of the piece of a face from one place to another, round the way the ring goes.
Foot FaceCutter::footUnder(const CutRing& ring, std::size_t from, std::size_t to) const {
    Vec3 wall, front;
    double n = 0;
    for (std::size_t i = from; i <= (to > from ? to : to + ring.size()); ++i, ++n) {
        wall += wallAt(ring[i % ring.size()]);
        front += frontAt(ring[i % ring.size()]);
    }
    return footAt(index_, wall / n, front / n, hAt(ring[from]));
}

// The line that a cut lies on.
FeatureIndex::Line FaceCutter::lineAlong(const CutPlace& from, const CutPlace& to) const {
    const Vec3 &a = wallAt(from), &b = wallAt(to);
    const FeatureIndex::Line line = features_.closestLine((a + b) * 0.5, onLine * hAt(from));
    return line.found && std::abs(dot(line.tangent, normalized(b - a))) >= alongLine ? line : FeatureIndex::Line{};
}

// Nodes that all stand on lines themselves do not say what they part: what lies under the two pieces does.
bool FaceCutter::liesOnLine(const CutRing& ring, std::size_t from, std::size_t to) const {
    const FeatureIndex::Line line = lineAlong(ring[from], ring[to]);
    if (!line.found) return false;
    if (line.isFaint) return true;
    const Foot one = footUnder(ring, from, to), other = footUnder(ring, to, from);
    return one.found && other.found && (turns(one, other) || one.part != other.part);
}

std::size_t FaceCutter::linesFrom(std::int32_t crossing, const std::vector<CutRing>& pieces) const {
    std::set<std::pair<std::int32_t, std::int32_t>> ends;
    for (const CutRing& piece : pieces) {
        for (std::size_t i = 0, n = piece.size(); i < n; ++i) {
            if (piece[i].crossing != crossing) continue;
            for (const CutPlace& end : {piece[(i + 1) % n], piece[(i + n - 1) % n]})
                if (lineAlong(piece[i], end).found) ends.insert({end.vertex, end.crossing});
        }
    }
    return ends.size();
}

// The cut with most new ends, the shortest of these.
bool FaceCutter::bestCut(const CutRing& ring, std::size_t& from, std::size_t& to) const {
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

bool FaceCutter::isOnOneEdge(const CutRing& ring) const {
    std::vector<std::int32_t> vertices;
    for (const CutPlace& p : ring) {
        if (p.vertex >= 0) {
            vertices.push_back(p.vertex);
        } else {
            const EdgeCrossing& c = crossings_[std::size_t(p.crossing)];
            vertices.insert(vertices.end(), {c.p, c.q});
        }
    }
    return front_.areOnOneEdge(vertices);
}

// Of the corners of the prism on a piece; new vertices in the middle of an edge have none, nor has any where the piece goes on all but straight.
double FaceCutter::worstCorner(const CutRing& ring, const EdgeCrossing* moved) const {
    const std::size_t n = ring.size();
    if (n > mostVertices || isOnOneEdge(ring) || std::any_of(ring.begin(), ring.end(), [&](const CutPlace& p) { return dents(p); })) return -1;
    double worst = 1;
    const auto take = [&worst](const Vec3& a, const Vec3& b, const Vec3& c) {
        if (dot(a, b) < straight * norm(a) * norm(b)) return;
        const double l = norm(a) * norm(b) * norm(c);
        worst = std::min(worst, l > 0 ? dot(cross(a, b), c) / l : -1);
    };
    for (std::size_t i = 0; i < n; ++i) {
        const CutPlace &before = ring[(i + n - 1) % n], &at = ring[i], &after = ring[(i + 1) % n];
        if (at.vertex < 0 && !at.isEnd) continue;
        const Vec3 &wall = wallAt(at, moved), &front = frontAt(at, moved), way = wall - front;
        take(frontAt(after, moved) - front, frontAt(before, moved) - front, way);
        take(wallAt(before, moved) - wall, wallAt(after, moved) - wall, -way);
    }
    return worst;
}

double FaceCutter::worstCorner(const std::vector<CutRing>& pieces, const EdgeCrossing& moved) const {
    double worst = 1;
    for (const CutRing& piece : pieces) worst = std::min(worst, worstCorner(piece, &moved));
    return worst;
}

bool FaceCutter::isOptional(const CutPlace& p) const { return p.crossing >= 0 && crossings_[std::size_t(p.crossing)].kind == SnapKind::none; }

bool FaceCutter::isOnBend(const CutPlace& p) const { return p.crossing >= 0 && crossings_[std::size_t(p.crossing)].bend; }

Lie FaceCutter::lieOfRing(const CutRing& ring) const {
    std::array<Vec3, 2 * mostVertices> x;
    std::size_t n = 0;
    for (const CutPlace& p : ring) {
        if (n < x.size()) x[n++] = wallAt(p);
    }
    return lieOf(index_, std::span(x).first(n), hAt(ring.front()));
}

// A cut at bends pays only where the pieces are much nearer to the geometry than the whole face, and none leans.
bool FaceCutter::isNearer(const CutRing& ring, const std::vector<CutRing>& pieces) const {
    const Lie before = lieOfRing(withoutCrossings(ring));
    double off = 0;
    for (const CutRing& piece : pieces) {
        const Lie lie = lieOfRing(piece);
        if (lie.cosine < std::min(tilted, before.cosine)) return false;
        off += lie.off / static_cast<double>(pieces.size());
    }
    return off < nearer * before.off;
}

// Would a bend that no cut ends at stick into the prism over the uncut face?
bool FaceCutter::dents(const CutPlace& p) const {
    if (!isOnBend(p) || p.isEnd) return false;
    const EdgeCrossing& c = crossings_[std::size_t(p.crossing)];
    const Vec3 &a = x_[std::size_t(c.p)], &b = x_[std::size_t(c.q)];
    return dot(c.wall - (a + (b - a) * c.t), c.front - c.wall) > 0;
}

void FaceCutter::divide(const CutRing& ring, FaceCuts& cuts) const {
    std::size_t from = 0, to = 0;
    if (!bestCut(ring, from, to)) {
        cuts.pieces.push_back(ring);
        return;
    }
    CutRing one(ring.begin() + static_cast<std::ptrdiff_t>(from), ring.begin() + static_cast<std::ptrdiff_t>(to) + 1);
    CutRing other(ring.begin() + static_cast<std::ptrdiff_t>(to), ring.end());
    other.insert(other.end(), ring.begin(), ring.begin() + static_cast<std::ptrdiff_t>(from) + 1);
    for (CutRing* piece : {&one, &other}) {
        piece->front().isEnd = piece->back().isEnd = true;
        divide(*piece, cuts);
    }
}

FaceCuts FaceCutter::cutsOf(std::size_t face, std::int32_t also) const {
    const CutRing ring = ringOf(face, also);
    FaceCuts cuts;
    divide(ring, cuts);
    const bool touched = cuts.pieces.size() > 1 || std::any_of(ring.begin(), ring.end(), [](const CutPlace& p) { return p.vertex < 0; });
    const bool mustBeGood = std::any_of(ring.begin(), ring.end(), [&](const CutPlace& p) { return isOptional(p); });
    const double worst = mustBeGood ? leastGood : std::clamp(touched ? worstCorner(withoutCrossings(ring)) : 1.0, leastEver, leastCorner);
    cuts.valid = !touched || std::all_of(cuts.pieces.begin(), cuts.pieces.end(), [&](const CutRing& piece) { return worstCorner(piece) >= worst; });
    if (cuts.valid && cuts.pieces.size() > 1 && std::any_of(ring.begin(), ring.end(), [&](const CutPlace& p) { return isOnBend(p); })) cuts.valid = isNearer(ring, cuts.pieces);
    return cuts;
}

void FaceCutter::wishRoom(const CutRing& piece, std::vector<RoomWish>& wishes) const {
    const std::size_t n = piece.size();
    for (std::size_t i = 0; i < n; ++i) {
        const CutPlace& at = piece[i];
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

} // namespace i2b
