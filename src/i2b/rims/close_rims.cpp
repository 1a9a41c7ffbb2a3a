#include "i2b/rims/close_rims.h"
#include "i2b/assemble/edit_mesh.h"
#include "i2b/core/parallel.h"
#include "i2b/core/sort_unique.h"
#include "i2b/edit/zip_star.h"
#include "i2b/fit/features.h"
#include "i2b/front/front.h"
#include "i2b/quality/fit_wall.h"
#include "i2b/rims/zip_rims.h"
#include <algorithm>
#include <optional>

namespace i2b {
namespace {

using Index = std::size_t;
constexpr int mostRounds = 8;
constexpr double reach = 0.6;       // of h: nodes nearer to a rim are looked at
constexpr double off = 0.01;        // of h: those farther off the geometry are in need,
constexpr double onRim = 0.02;      // and those farther off the rim,
constexpr double alone = 0.35;      // where no other node on it is so near, in h
constexpr double nearCorner = 0.45; // of h: a corner of the rim without a node draws one from so far
constexpr double apart = 0.15;      // of h: two nodes that stay two keep so far apart
constexpr double across = 0.8;      // cosine: edges along the rim are not for closing
constexpr double leastGain = 0.02;  // of h

struct Change {
    PointMove move;
    std::vector<std::int32_t> star; // cells around, ascending
};

// The rims of a geometry and the corners on them, alone.
FeatureGraph rimsOf(const FeatureGraph& features) {
    FeatureGraph rims;
    std::vector<std::uint8_t> onRims(features.points.size(), 0);
    for (const FeatureEdge& e : features.edges) {
        if (!(e.kinds & bitOf(EdgeKind::rim))) continue;
        rims.edges.push_back(e);
        onRims[e.a] = onRims[e.b] = 1;
    }
    if (rims.edges.empty()) return rims;
    rims.points = features.points;
    std::ranges::copy_if(features.corners, std::back_inserter(rims.corners), [&](std::uint32_t c) { return onRims[c] != 0; });
    return rims;
}

class RimCloser {
  public:
    RimCloser(PolyMesh& mesh, const Rows& cellFaces, const Front& front, const Wall& wall, const FeatureIndex& rims, const SurfaceIndex& index, const DictionaryLimits& limits)
        : mesh_(mesh), front_(front), wall_(wall), rims_(rims), index_(index), limits_(limits), cellFaces_(cellFaces), star_(mesh, cellFaces_) {
        cellAt_.assign(wall.nodes.size(), -1);
        for (const WallEdge& e : wall.edges)
            for (const std::int32_t p : {e.a, e.b}) cellAt_[nodePlace(wall, p)] = mesh.owner[Index(wall.faces[Index(e.face)])];
    }
    ClosedRims run(std::int32_t firstLayerCell);

  private:
    struct Node { // a wall node in need
        std::int32_t point = -1;
        double h = 0; // m
    };
    const Vec3& at(std::int32_t point) const { return mesh_.points[Index(point)]; }
    double offGeometry(const Vec3& p, double h) const {
        const ClosestPoint c = index_.closest(p, h);
        return c ? c.distance / h : 1;
    }
    double offRim(const Vec3& p, double radius) const { // m, or infinite
        const FeatureIndex::Line line = rims_.closestLine(p, radius);
        return line.found ? norm(line.point - p) : std::numeric_limits<double>::infinity();
    }
    void seekRest(ClosedRims& out);
    std::vector<std::int32_t> wallNeighbours(std::int32_t point, const std::vector<std::int32_t>& star) const;
    std::optional<Node> nodeInNeed(Index place) const;
    Vec3 placeOnRim(std::int32_t point, std::int32_t other, double h, const std::vector<std::int32_t>& around) const;
    double errorOf(const std::vector<std::int32_t>& star, const PointMove& move, bool isDone, double h) const;
    std::optional<Change> find(const Node& node) const;
    std::optional<Change> tryMove(const PointMove& move, double h) const;
    void write(ClosedRims& out);

    PolyMesh& mesh_;
    const Front& front_;
    const Wall& wall_; // its nodes follow each other as the vertices of the front do
    const FeatureIndex& rims_;
    const SurfaceIndex& index_;
    const DictionaryLimits& limits_;
    const Rows& cellFaces_;
    ZipStar star_;
    bool anyJoined_ = false;
    std::vector<std::int32_t> cellAt_; // per wall node, one that uses it
};

// Of the faces of the wall around a point, its neighbours along their edges.
std::vector<std::int32_t> RimCloser::wallNeighbours(std::int32_t point, const std::vector<std::int32_t>& star) const {
    std::vector<std::int32_t> next, loop;
    for (const std::int32_t f : star_.wallFaces(star)) {
        star_.loopOf(f, {}, loop);
        for (Index i = 0; i < loop.size(); ++i) {
            if (loop[i] != point) continue;
            next.push_back(loop[(i + 1) % loop.size()]);
            next.push_back(loop[(i + loop.size() - 1) % loop.size()]);
        }
    }
    sortUnique(next);
    return next;
}

std::optional<RimCloser::Node> RimCloser::nodeInNeed(Index place) const {
    const std::int32_t point = wall_.nodes[place];
    const double h = wall_.nodeH[place];
    if (star_.isGone(point) || front_.outside[place] != 0) return {}; // nodes in sides of the domain stay there
    const FeatureIndex::Line line = rims_.closestLine(at(point), reach * h);
    if (!line.found) return {};
    if (offGeometry(at(point), h) > off) return Node{point, h};
    if (norm(line.point - at(point)) <= onRim * h) return {};
    const std::vector<std::int32_t> next = wallNeighbours(point, star_.cellsAt(point, -1, cellAt_[place]));
    const bool isAlone = std::ranges::none_of(next, [&](std::int32_t q) { return norm(at(q) - line.point) < alone * h && rims_.closestLine(at(q), onRim * h).found; });
    return isAlone ? std::optional(Node{point, h}) : std::nullopt;
}

// Where on the rim a point, or two, should be: at a corner that is without a node, else where it is nearest.
Vec3 RimCloser::placeOnRim(std::int32_t point, std::int32_t other, double h, const std::vector<std::int32_t>& around) const {
    const bool others = other >= 0 && offRim(at(other), 2 * h) < offRim(at(point), 2 * h);
    const Vec3 to = rims_.closestLine(at(others ? other : point), 2 * h).point;
    const ClosestPoint corner = rims_.closestCorner(to, nearCorner * h);
    const auto isThere = [&](std::int32_t q) { return q != point && q != other && norm(at(q) - corner.point) < onRim * h; };
    return corner && std::ranges::none_of(around, isThere) ? corner.point : to;
}

// In h: how far the node or nodes and the middles of the wall's faces around are off, and the nearer node off the rim.
double RimCloser::errorOf(const std::vector<std::int32_t>& star, const PointMove& move, bool isDone, double h) const {
    double sum = 0;
    std::vector<std::int32_t> loop;
    const auto place = [&](std::int32_t p) { return isDone && p == move.keep ? move.to : at(p); };
    if (!isDone) {
        double nearest = reach;
        for (const std::int32_t p : {move.keep, move.gone}) {
            if (p < 0) continue;
            sum += offGeometry(at(p), h);
            nearest = std::min(nearest, offRim(at(p), reach * h) / h);
        }
        sum += nearest;
    }
    for (const std::int32_t f : star_.wallFaces(star)) {
        star_.loopOf(f, isDone ? move : PointMove{}, loop);
        if (loop.size() < 3) continue;
        Vec3 middle;
        for (const std::int32_t p : loop) middle += place(p);
        sum += offGeometry(middle / static_cast<double>(loop.size()), h);
    }
    return sum;
}

std::optional<Change> RimCloser::tryMove(const PointMove& move, double h) const {
    const Index place = nodePlace(wall_, move.keep);
    Change change{move, star_.cellsAt(move.keep, move.gone, cellAt_[place])};
    if (errorOf(change.star, move, false, h) - errorOf(change.star, move, true, h) < leastGain) return {};
    if (move.gone >= 0 && !star_.mayJoin(move, change.star)) return {};
    if (!star_.isNoWorse(move, change.star, limits_)) return {};
    return change;
}

std::optional<Change> RimCloser::find(const Node& node) const {
    const Index place = nodePlace(wall_, node.point);
    const std::vector<std::int32_t> star = star_.cellsAt(node.point, -1, cellAt_[place]);
    std::vector<std::int32_t> next = wallNeighbours(node.point, star);
    std::ranges::stable_sort(next, {}, [&](std::int32_t q) { return norm2(at(q) - at(node.point)); });
    const double h = node.h;
    for (const std::int32_t q : next) {
        const FeatureIndex::Line line = rims_.closestLine(at(q), reach * h);
        if (!line.found) continue;
        const Vec3 edge = at(q) - at(node.point);
        if (norm(edge) > apart * h && std::abs(dot(edge, line.tangent)) > across * norm(edge)) continue;
        const std::int32_t keep = std::min(q, node.point), gone = std::max(q, node.point);
        if (auto change = tryMove({keep, gone, placeOnRim(node.point, q, h, next)}, h)) return change;
    }
    const Vec3 to = placeOnRim(node.point, -1, h, next);
    if (std::ranges::any_of(next, [&](std::int32_t q) { return norm(at(q) - to) < apart * h; })) return {};
    return tryMove({node.point, -1, to}, h);
}

void RimCloser::write(ClosedRims& out) {
    const std::vector<std::int32_t> gone = star_.pointsGone();
    for (Index i = 0; i < wall_.nodes.size(); ++i)
        if (std::ranges::binary_search(gone, wall_.nodes[i])) out.lostNodes.push_back(static_cast<std::int32_t>(i));
    out.lostFaces = star_.rewrite();
    if (star_.united().empty()) return;
    MeshEdits edits;
    edits.groups.resize(Index(mesh_.cells));
    parallelFor(edits.groups.size(), [&](Index c) { edits.groups[c] = static_cast<std::int32_t>(c); });
    for (const auto& [cell, to] : star_.united()) edits.groups[Index(cell)] = to;
    out.cellOf = editMesh(mesh_, edits);
}

// Single pairs and nodes, where that helps.
void RimCloser::seekRest(ClosedRims& out) {
    std::vector<std::uint8_t> isNear(wall_.nodes.size(), 0);
    parallelFor(isNear.size(), [&](Index i) { isNear[i] = rims_.closestLine(at(wall_.nodes[i]), reach * wall_.nodeH[i]).found; });
    std::vector<std::uint32_t> places;
    for (Index i = 0; i < isNear.size(); ++i)
        if (isNear[i]) places.push_back(static_cast<std::uint32_t>(i));
    for (int round = 0; round < mostRounds && !places.empty(); ++round) {
        std::vector<std::optional<Change>> changes(places.size());
        parallelFor(places.size(), [&](Index i) {
            if (const auto node = nodeInNeed(places[i])) changes[i] = find(*node);
        }, 1);
        std::vector<bool> isTouched(Index(mesh_.cells)); // cells that are not as they were when the changes were judged
        bool any = false;
        for (const std::optional<Change>& change : changes) {
            if (!change || std::ranges::any_of(change->star, [&](std::int32_t c) { return isTouched[Index(c)]; })) continue;
            for (const std::int32_t c : star_.withNeighbours(change->star)) isTouched[Index(c)] = true;
            any = true;
            star_.apply(change->move);
            anyJoined_ = anyJoined_ || change->move.gone >= 0;
            out.moved += change->move.gone < 0;
        }
        if (!any) break;
    }
}

ClosedRims RimCloser::run(std::int32_t firstLayerCell) {
    ClosedRims out;
    anyJoined_ = zipRims(star_, mesh_, cellFaces_, wall_, front_, index_, rims_, limits_, firstLayerCell) > 0;
    seekRest(out);
    if (anyJoined_) write(out);
    return out;
}

} // namespace

ClosedRims closeRims(PolyMesh& mesh, const Front& front, const FeatureGraph& features, const SurfaceIndex& index, const DictionaryLimits& limits, std::int32_t firstLayerCell) {
    const FeatureIndex rims(rimsOf(features));
    if (rims.empty()) return {};
    const Rows cellFaces = buildCellFaces(mesh);
    const Wall wall = collectWall(mesh, cellFaces, {});
    return RimCloser(mesh, cellFaces, front, wall, rims, index, limits).run(firstLayerCell);
}

} // namespace i2b
