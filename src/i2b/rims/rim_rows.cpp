#include "i2b/rims/rim_rows.h"
#include "i2b/core/parallel.h"
#include "i2b/core/sort_unique.h"
#include "i2b/fit/features.h"
#include "i2b/front/front.h"
#include "i2b/geometry/surface_index.h"
#include "i2b/quality/fit_wall.h"
#include <algorithm>
#include <map>

namespace i2b {
namespace {

using Index = std::size_t;
constexpr double reach = 0.45;      // of h: nodes nearer to a rim may go there,
constexpr double reachBeyond = 0.9; // and so may these, of columns that end nowhere else
constexpr double farFront = 2;      // of h: front nodes nearer to it say where,
constexpr double farAlong = 0.7;    // unless that is so far from where the node is now
constexpr double nearCorner = 0.45; // of h: a corner of the rim draws the nearest of these
constexpr double pairReach = 0.8;   // of h along the rim, between two that become one
constexpr double same = 1e-6;       // of h

class RowFinder {
  public:
    RowFinder(const PolyMesh& mesh, const Wall& wall, const Front& front, const SurfaceIndex& index, const FeatureIndex& rims) : mesh_(mesh), wall_(wall), front_(front), index_(index), rims_(rims) {}
    RimRows run() {
        findNodes();
        findFaces();
        findRows();
        spread();
        joinPairs();
        meetCorners();
        spread();
        return std::move(rows_);
    }

  private:
    RimRows::Node& node(std::int32_t point) { return rows_.nodes[nodePlace(wall_, point)]; }
    double apart(std::int32_t a, std::int32_t b) { return norm(node(a).to - node(b).to) / std::min(node(a).h, node(b).h); }
    // Is nothing of the sheet nearer to a place than its rim?
    bool isBeyond(const Vec3& p) const { return rims_.closestLine(p, (1 + same) * index_.closest(p).distance).found; }
    bool isAtCorner(const RimRows::Node& n) const { return bool(rims_.closestCorner(n.to, same * n.h)); }
    void findNodes();
    void findFaces();
    void findRows();
    void spread();
    void joinPairs();
    void meetCorners();
    // f(edge of one side, of the other), for edges between two faces of the wall
    template <class F>
    void forEdges(const F& f) {
        for (Index i = 0; i + 1 < wall_.edges.size(); ++i)
            if (wall_.edges[i].a == wall_.edges[i + 1].a && wall_.edges[i].b == wall_.edges[i + 1].b) f(wall_.edges[i], Index(wall_.edges[i].face), Index(wall_.edges[i + 1].face));
    }

    const PolyMesh& mesh_;
    const Wall& wall_;
    const Front& front_;
    const SurfaceIndex& index_;
    const FeatureIndex& rims_;
    RimRows rows_;
    std::vector<RimRows::Edge> ends_; // of strips, across them
};

void RowFinder::findNodes() {
    std::vector<RimRows::Node>& nodes = rows_.nodes;
    nodes.resize(wall_.nodes.size());
    std::vector<int> edges(nodes.size(), 0);
    for (const WallEdge& e : wall_.edges) {
        const Index a = nodePlace(wall_, e.a), b = nodePlace(wall_, e.b);
        const double length = norm(front_.front[a] - front_.front[b]);
        nodes[a].h += length, nodes[b].h += length, ++edges[a], ++edges[b];
    }
    parallelFor(nodes.size(), [&](Index n) {
        nodes[n].h /= std::max(edges[n], 1);
        if (front_.outside[n] != 0) return; // nodes in sides of the domain stay there
        const double h = nodes[n].h;
        const Vec3& place = mesh_.points[Index(wall_.nodes[n])];
        const FeatureIndex::Line line = rims_.closestLine(place, reachBeyond * h);
        if (!line.found || (norm(line.point - place) > reach * h && !isBeyond(front_.front[n]))) return;
        nodes[n].moves = true;
        const FeatureIndex::Line under = rims_.closestLine(front_.front[n], farFront * h); // columns across the rim make the best wedges
        nodes[n].to = under.found && norm(under.point - line.point) < farAlong * h ? under.point : line.point;
    });
}

void RowFinder::findFaces() {
    rows_.isBefore.assign(wall_.faces.size(), 0);
    parallelFor(rows_.isBefore.size(), [&](Index f) {
        rows_.isBefore[f] = std::ranges::all_of(mesh_.face(wall_.faces[f]), [&](std::int32_t p) { return node(p).moves; });
    });
    for (const WallEdge& e : wall_.edges)
        for (const std::int32_t p : {e.a, e.b})
            if (node(p).moves) rows_.facesOf[p].push_back(e.face);
    for (auto& [point, faces] : rows_.facesOf) sortUnique(faces);
    forEdges([&](const WallEdge& e, Index face, Index other) {
        const int before = rows_.isBefore[face] + rows_.isBefore[other];
        if (before == 2) rows_.across.push_back({e.a, e.b, face, other});
        if (before == 1 && node(e.a).moves && node(e.b).moves && apart(e.a, e.b) < RimRows::tooNear) ends_.push_back({e.a, e.b, face, other});
    });
}

// Along the edges between faces before a rim and others.
void RowFinder::findRows() {
    std::vector<std::uint8_t> times(rows_.nodes.size(), 0);
    const auto add = [&](Index n, Index next) {
        if (times[n] < 2) rows_.nodes[n].row[times[n]] = static_cast<std::int32_t>(next);
        times[n] = static_cast<std::uint8_t>(std::min(times[n] + 1, 3));
    };
    forEdges([&](const WallEdge& e, Index face, Index other) {
        if (rows_.isBefore[face] == rows_.isBefore[other]) return;
        if (node(e.a).moves && node(e.b).moves && apart(e.a, e.b) < RimRows::tooNear) return; // a strip's end
        const Index a = nodePlace(wall_, e.a), b = nodePlace(wall_, e.b);
        add(a, b), add(b, a);
    });
    for (Index n = 0; n < times.size(); ++n)
        if (times[n] != 2) rows_.nodes[n].row = {-1, -1};
}

// Evens out the nodes of each row along the rim; those on its corners stay.
void RowFinder::spread() {
    const std::vector<RimRows::Node> old = rows_.nodes;
    const auto evened = [&](const RimRows::Node& n) {
        if (n.row[1] < 0) return n.to;
        const RimRows::Node &a = old[Index(n.row[0])], &b = old[Index(n.row[1])];
        return a.moves && b.moves ? rims_.closestLine(n.to * 0.5 + (a.to + b.to) * 0.25, n.h).point : n.to;
    };
    parallelFor(old.size(), [&](Index i) {
        const RimRows::Node& n = old[i];
        if (!n.moves || isAtCorner(n)) return;
        if (n.partner < 0) rows_.nodes[i].to = evened(n);
        else rows_.nodes[i].to = rims_.closestLine((evened(n) + evened(old[nodePlace(wall_, n.partner)])) * 0.5, n.h).point;
    });
}

// Ends of edges across the strip, those that meet best first.
void RowFinder::joinPairs() {
    std::vector<RimRows::Edge> edges = rows_.across;
    edges.insert(edges.end(), ends_.begin(), ends_.end());
    std::vector<std::pair<double, Index>> order;
    for (Index i = 0; i < edges.size(); ++i)
        if (const double d = apart(edges[i].a, edges[i].b); d < pairReach) order.emplace_back(d, i);
    std::ranges::sort(order);
    for (const auto& [d, i] : order) {
        RimRows::Node &a = node(edges[i].a), &b = node(edges[i].b);
        if (a.partner >= 0 || b.partner >= 0) continue;
        a.partner = edges[i].b, b.partner = edges[i].a;
        a.to = b.to = betweenOnRim(a, b, rims_);
    }
}

// The nearest of the nodes goes to a corner of the rim.
void RowFinder::meetCorners() {
    struct Nearest { double distance; Index node; Vec3 place; };
    std::map<std::uint32_t, Nearest> corners;
    for (Index n = 0; n < rows_.nodes.size(); ++n) {
        if (!rows_.nodes[n].moves) continue;
        const ClosestPoint corner = rims_.closestCorner(rows_.nodes[n].to, nearCorner * rows_.nodes[n].h);
        if (!corner) continue;
        const Nearest found{corner.distance, n, corner.point};
        const auto [at, isNew] = corners.try_emplace(corner.triangle, found);
        if (!isNew && corner.distance < at->second.distance) at->second = found;
    }
    for (const auto& [corner, nearest] : corners) {
        RimRows::Node& n = rows_.nodes[nearest.node];
        n.to = nearest.place;
        if (n.partner >= 0) node(n.partner).to = nearest.place;
    }
}

} // namespace

RimRows findRimRows(const PolyMesh& mesh, const Wall& wall, const Front& front, const SurfaceIndex& index, const FeatureIndex& rims) { return RowFinder(mesh, wall, front, index, rims).run(); }

Vec3 betweenOnRim(const RimRows::Node& a, const RimRows::Node& b, const FeatureIndex& rims) {
    for (const RimRows::Node* n : {&a, &b})
        if (rims.closestCorner(n->to, same * n->h)) return n->to;
    return rims.closestLine((a.to + b.to) * 0.5, a.h).point;
}

} // namespace i2b
