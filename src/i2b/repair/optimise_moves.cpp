#include "i2b/fit/corner.h"
#include "i2b/repair/optimise_worker.h"
#include <algorithm>
#include <cmath>

namespace i2b {
namespace {

using Index = std::size_t;
constexpr double settled = 0.01;      // of h: nodes nearer to the geometry are on it
constexpr double crossing = 0.05;     // of h: so near to its end a way may meet geometry
constexpr double leastEdge = 0.015;   // of h: no nearer may a node come to another for the wall's sake

} // namespace

// Does a node's move take a way between front and wall through geometry?
bool Optimiser::isFree(const MeshNode& node, const Vec3& to) const {
    const auto crosses = [&](const Vec3& f, const Vec3& b, double h) {
        const double length = norm(b - f), off = crossing * h;
        if (!(length > off)) return false;
        return bool(guide_.index.firstHit(f, b, 1 - off / length));
    };
    if (node.kind == MeshNode::core) return true;
    if (node.kind == MeshNode::wall) {
        const auto v = Index(node.id);
        return !crosses(front_.front[v], to, front_.h[v]) || crosses(front_.front[v], front_.wall(Index(node.id)), front_.h[v]);
    }
    const auto [first, last] = nodes_.fansOf(node.id);
    return std::all_of(first, last, [&](std::int32_t v) {
        const double h = front_.h[Index(v)];
        return !crosses(to, front_.wall(Index(v)), h) || crosses(front_.front[Index(v)], front_.wall(Index(v)), h);
    });
}

// What a wall node at a place is on, and stays on.
Optimiser::Hold Optimiser::holdAt(const MeshNode& node, const Vec3& from) const {
    if (node.kind != MeshNode::wall || mayLeave(node) || front_.outside[Index(node.id)] != 0) return Hold::nothing;
    const double h = front_.h[Index(node.id)];
    if (isHeld(node) && norm(snapLine(guide_.index, guide_.features, guide_.snaps[Index(node.id)], from, h).point - from) <= settled * h) return Hold::feature;
    return guide_.index.closest(from, settled * h) ? Hold::surface : Hold::nothing;
}

// Where a node on its way from one place to another ends up.
Vec3 Optimiser::onWall(Hold hold, const MeshNode& node, const Vec3& from, const Vec3& to) const {
    if (hold == Hold::nothing) return to;
    const double h = front_.h[Index(node.id)];
    if (hold == Hold::feature) return snapLine(guide_.index, guide_.features, guide_.snaps[Index(node.id)], to, h).point;
    const ClosestPoint c = guide_.index.closest(to, norm(to - from) + settled * h);
    return c ? c.point : from;
}

bool Optimiser::mendNode(const Task& task, Worker& worker) {
    const std::uint8_t outside = nodes_.outside(task.node);
    // Where the wall meets a side of the domain at a sharp angle thin layers are skew: there its nodes may leave it.
    if (task.node.kind == MeshNode::wall && outside != 0 && !thin_ && !mayLeave(task.node)) return false;
    worker.begin(task);
    const Vec3 from = worker.from;
    const Badness before = worker.at(from);
    if (before.sum == 0) return false;
    const Vec3 middle = worker.middle();
    const double h = nodes_.h(task.node);
    const Vec3 down = worker.descent(before.sum, probe * h, outside, [&](const Vec3& to) { return worker.sumBeside(to); });
    const Hold hold = holdAt(task.node, from);
    std::vector<std::pair<Vec3, double>> found; // ever better places, and their sums
    const auto tryStep = [&](const Vec3& step) {
        const Vec3 to = onWall(hold, task.node, from, from + step);
        const double least = found.empty() ? before.sum : found.back().second;
        const Badness b = worker.at(to, before, least);
        if (b.worst > before.worst || (b.invalid && !before.invalid) || !(b.sum < least) || !isFree(task.node, to)) return;
        found.emplace_back(to, b.sum);
    };
    const Vec3 toMiddle = withinSides(middle - from, outside);
    for (const double length : stepLengths) tryStep(down * (length * h));
    if (found.empty()) // no way down
        for (const double share : towardsMiddle) tryStep(toMiddle * share);
    const TetLack tets = keepsTets_ && !found.empty() ? worker.tetsAt(from) : TetLack{};
    const auto helps = [&](const std::pair<Vec3, double>& place) {
        return place.second < before.sum * (1 - leastGain) && (!keepsTets_ || worker.mayDivideAt(place.first, tets));
    };
    while (!found.empty() && !helps(found.back())) found.pop_back();
    const Vec3 best = found.empty() ? from : found.back().first;
    worker.end(best);
    return !(best == from);
}

// To a feature?
bool Optimiser::isHeld(const MeshNode& wall) const {
    return Index(wall.id) < guide_.snaps.size() && guide_.snaps[Index(wall.id)].kind != SnapKind::none;
}

// Of the column of layers over a wall node; none where that is straight whatever it says.
float* Optimiser::bendOf(const MeshNode& wall) const {
    if (wall.kind != MeshNode::wall || stack_.columns.empty()) return nullptr;
    Column& column = stack_.columns[Index(wall.id)];
    return column.normal() == Vec3{} ? nullptr : &column.bend;
}

bool Optimiser::bendNode(const Task& task, Worker& worker) {
    float* bend = bendOf(task.node);
    if (!bend) return false;
    worker.begin(task);
    const Badness before = worker.at(worker.from);
    const float was = *bend;
    float best = was;
    Badness least = before;
    for (const float value : bends) {
        *bend = value;
        const Badness b = worker.at(worker.from);
        if (b.worst > before.worst || (b.invalid && !before.invalid) || !(b.sum < least.sum * (1 - leastGain))) continue;
        least = b, best = value;
    }
    *bend = best;
    worker.end(worker.from);
    return best != was;
}

// Whether a wall node may stand at a place, with its column as it is or bent another way, which it then is.
bool Optimiser::fitsAt(const Task& task, Worker& worker, const Vec3& to, const Badness& before) {
    if (worker.mayStandAt(to, before)) return true;
    float* bend = bendOf(task.node);
    if (!bend) return false;
    const float was = *bend;
    for (const float value : bends) {
        *bend = value;
        if (value != was && worker.mayStandAt(to, before)) return true;
    }
    *bend = was;
    return false;
}

// Brings a wall node to a place if it may stand there: no nearer to another node than `shortest` (m), and seen by the flow.
bool Optimiser::comeTo(const Task& task, Worker& worker, const Vec3& to, const Badness& before, double shortest) {
    float* bend = bendOf(task.node);
    const float was = bend ? *bend : 0;
    if (fitsAt(task, worker, to, before) && worker.shortestEdge() >= shortest && isFree(task.node, to)) {
        worker.end(to);
        return true;
    }
    if (bend) *bend = was;
    return false;
}

bool Optimiser::targetOf(std::int32_t vertex, Vec3& target) const {
    const auto v = Index(vertex);
    const Vec3 b = front_.wall(v);
    const double h = front_.h[v];
    if (v < guide_.snaps.size() && guide_.snaps[v].kind != SnapKind::none) {
        target = snapLine(guide_.index, guide_.features, guide_.snaps[v], b, h).point;
        return true;
    }
    const Vec3& size = front_.size[v];
    const WallTarget t = targetSeen(guide_.index, front_.front[v], b, h, std::max({size.x, size.y, size.z}), front_.outside[v]);
    target = t.point;
    return t.found;
}

bool Optimiser::pullNode(const Task& task, Worker& worker) {
    Vec3 target;
    if (!targetOf(task.node.id, target)) return false;
    worker.begin(task);
    const Vec3 from = worker.from, way = withinSides(target - from, nodes_.outside(task.node));
    if (norm(way) < 1e-9 * nodes_.h(task.node)) return false;
    const Badness before = worker.at(from);
    const double shortest = std::min(worker.shortestEdge(), leastEdge * nodes_.h(task.node));
    for (const double part : {1.0, 0.5, 0.25}) {
        if (comeTo(task, worker, from + way * part, before, shortest)) return true;
    }
    worker.end(from);
    return false;
}

bool Optimiser::snapNode(const Task& task, Worker& worker) {
    const auto v = Index(task.node.id);
    const Snap& wish = guide_.wishes[v];
    if (guide_.snaps[v].kind != SnapKind::none) return false;
    worker.begin(task);
    const Vec3 from = worker.from, to = snapLine(guide_.index, guide_.features, wish, from, front_.h[v]).point;
    const Badness before = worker.at(from);
    const double shortest = std::min(worker.shortestEdge(), leastEdge * front_.h[v]);
    const bool there = comeTo(task, worker, to, before, shortest);
    if (there) guide_.snaps[v] = wish;
    else worker.end(from);
    return there;
}

} // namespace i2b
