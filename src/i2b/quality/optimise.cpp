#include "i2b/quality/optimise.h"
#include "i2b/core/parallel.h"
#include "i2b/fit/corner.h"
#include "i2b/quality/cell_star.h"
#include <algorithm>

namespace i2b {
namespace {

using Index = std::size_t;
constexpr double probe = 1e-3;        // of h: step of the differences that give the direction of descent
constexpr double settled = 0.01;      // of h: nodes nearer to the geometry are on it
constexpr double offWall = 0.005;     // of h: nodes farther off are pulled in
constexpr double crossing = 0.05;     // of h: so near to its end a way may meet geometry
constexpr double leastGain = 1e-3;    // of the sum: what a move must bring
constexpr double leastEdge = 0.015;   // of h: no nearer may a node come to another for the wall's sake
constexpr double nearLimit = 0.98;    // of a limit: a node on its way to the wall may bring its cells up to there
constexpr int patience = 2;           // sweeps, then
constexpr int thinPatience = 4;       // the same for thin layers, however many
constexpr std::int64_t many = 200;    // faults of which more than
constexpr double stalled = 0.9;       // this share is left by a sweep are given up
constexpr std::array<float, 5> bends{1, 0.75f, 0.5f, 0.25f, 0}; // tried
constexpr std::array<double, 5> stepLengths{0.25, 0.12, 0.06, 0.03, 0.015}; // of h

// A move for the wall's sake keeps to the limits, or makes nothing worse where they are broken already.
bool mayStand(const Badness& now, const Badness& before) {
    return !now.invalid && (now.worst <= nearLimit || (now.worst <= before.worst && now.sum <= before.sum));
}

} // namespace

// What a thread needs to try moves.
struct Optimiser::Worker {
    Worker(Optimiser& o) : optimiser(o), star(o.mesh_, o.cellFaces_, o.faults_.moments(), o.faults_.limits(), o.faults_.thinFrom()) {}

    void begin(const Task& t) {
        node = t.node;
        from = optimiser.nodes_.place(node);
        moved.clear();
        optimiser.nodes_.follow(node, from, moved);
        points.clear();
        for (const auto& [p, x] : moved) points.push_back(p);
        std::sort(points.begin(), points.end());
        points.erase(std::unique(points.begin(), points.end()), points.end());
        star.gather(points, {t.cell});
    }
    Badness at(const Vec3& to) {
        moved.clear();
        optimiser.nodes_.follow(node, to, moved);
        for (const auto& [p, x] : moved) optimiser.mesh_.points[Index(p)] = x;
        return star.judge();
    }
    // Of a wall node where it is: its point at the wall comes last of its stack.
    double shortestEdge() const { return star.shortestEdgeAt(moved.back().first); }
    // Leaves the node at a place.
    void end(const Vec3& to) {
        at(to);
        if (!(to == from)) optimiser.nodes_.moveTo(node, to);
    }

    Optimiser& optimiser;
    CellStar star;
    MeshNode node;
    Vec3 from;
    MeshNodes::Moved moved;
    std::vector<std::int32_t> points;
};

Optimiser::Optimiser(PolyMesh& mesh, const Rows& cellFaces, MeshFaults& faults, Front& front, LayerStack& layers, const WallGuide& guide)
    : mesh_(mesh), cellFaces_(cellFaces), faults_(faults), front_(front), stack_(layers), thin_(!layers.asHighAsCan()), layers_(thin_ ? layers.count : 1), guide_(guide), nodes_(front, layers) {}

std::vector<Optimiser::Task> Optimiser::tasksOf(const std::vector<std::int32_t>& cells) const {
    std::vector<std::pair<MeshNode, std::int32_t>> found;
    std::vector<MeshNode> nodes;
    for (const std::int32_t c : cells) {
        for (const std::int32_t f : cellFaces_[c]) {
            for (const std::int32_t p : mesh_.face(f)) {
                nodes.clear();
                nodes_.nodesOf(p, nodes);
                for (const MeshNode& n : nodes) found.emplace_back(n, c);
            }
        }
    }
    std::sort(found.begin(), found.end());
    std::vector<Task> tasks;
    for (const auto& [node, cell] : found) {
        if (tasks.empty() || tasks.back().node != node) tasks.push_back({node, cell, {}});
    }
    return tasks;
}

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

// Wall nodes that are on the geometry stay on it, on the feature that they are held to.
Vec3 Optimiser::onWall(const MeshNode& node, const Vec3& from, const Vec3& to) const {
    if (node.kind != MeshNode::wall || mayLeave_ || front_.outside[Index(node.id)] != 0) return to;
    const double h = front_.h[Index(node.id)];
    if (Index(node.id) < guide_.snaps.size() && guide_.snaps[Index(node.id)].kind != SnapKind::none) {
        const FeatureIndex::Line was = snapLine(guide_.index, guide_.features, guide_.snaps[Index(node.id)], from, h);
        if (norm(was.point - from) <= settled * h) return snapLine(guide_.index, guide_.features, guide_.snaps[Index(node.id)], to, h).point;
    }
    const ClosestPoint was = guide_.index.closest(from, settled * h);
    if (!was) return to;
    const ClosestPoint c = guide_.index.closest(to, norm(to - from) + settled * h);
    return c ? c.point : from;
}

bool Optimiser::mendNode(const Task& task, Worker& worker) {
    const std::uint8_t outside = nodes_.outside(task.node);
    // Where the wall meets a side of the domain at a sharp angle thin layers are skew: there its nodes may leave it.
    if (task.node.kind == MeshNode::wall && outside != 0 && !thin_) return false;
    worker.begin(task);
    const Vec3 from = worker.from;
    const Badness before = worker.at(from);
    if (before.sum == 0) return false;
    const double h = nodes_.h(task.node);
    Vec3 down;
    for (int axis = 0; axis < 3; ++axis) {
        if (outside >> (2 * axis) & 3) continue;
        Vec3 to = from;
        to[axis] += probe * h;
        down[axis] = before.sum - worker.at(to).sum;
    }
    down = normalized(down);
    Vec3 best = from;
    Badness least = before;
    for (const double length : stepLengths) {
        if (down == Vec3{}) break;
        const Vec3 to = onWall(task.node, from, from + down * (length * h));
        const Badness b = worker.at(to);
        if (b.worst > before.worst || (b.invalid && !before.invalid) || !(b.sum < least.sum) || !isFree(task.node, to)) continue;
        least = b, best = to;
    }
    if (!(least.sum < before.sum * (1 - leastGain))) best = from;
    worker.end(best);
    return !(best == from);
}

// Of the column of layers over a wall node; none where that is straight whatever it says.
float* Optimiser::bendOf(const MeshNode& wall) {
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
    if (mayStand(worker.at(to), before)) return true;
    float* bend = bendOf(task.node);
    if (!bend) return false;
    const float was = *bend;
    for (const float value : bends) {
        *bend = value;
        if (value != was && mayStand(worker.at(to), before)) return true;
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

std::int64_t Optimiser::bend() {
    if (stack_.columns.empty()) return 0;
    FaultCount count;
    std::vector<std::int32_t> cells = faults_.badCells();
    const std::vector<std::int32_t> poor = faults_.poorCells(count);
    cells.insert(cells.end(), poor.begin(), poor.end());
    std::vector<Task> tasks = tasksOf(cells);
    return sweep(tasks, [&](const Task& t, Worker& w) { return bendNode(t, w); });
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

// Groups of tasks that may go at once: no cell that one changes is read by another. Those beyond 64 colours wait for
// the next sweep.
std::vector<std::vector<std::uint32_t>> Optimiser::colour(const std::vector<Task>& tasks) const {
    std::vector<std::int32_t> cells;
    std::vector<std::vector<std::int32_t>> reads(tasks.size());
    parallelFor(tasks.size(), [&](Index t) {
        for (const std::int32_t c : tasks[t].cells) {
            reads[t].push_back(c);
            for (const std::int32_t f : cellFaces_[c]) {
                if (f < mesh_.internalFaces()) reads[t].push_back(mesh_.owner[Index(f)] == c ? mesh_.neighbour[Index(f)] : mesh_.owner[Index(f)]);
            }
        }
        std::sort(reads[t].begin(), reads[t].end());
        reads[t].erase(std::unique(reads[t].begin(), reads[t].end()), reads[t].end());
    }, 16);
    for (const auto& r : reads) cells.insert(cells.end(), r.begin(), r.end());
    std::sort(cells.begin(), cells.end());
    cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
    struct Masks { std::uint64_t read = 0, changed = 0; };
    std::vector<Masks> masks(cells.size());
    const auto masksOf = [&](std::int32_t c) -> Masks& { return masks[static_cast<Index>(std::lower_bound(cells.begin(), cells.end(), c) - cells.begin())]; };
    std::vector<std::vector<std::uint32_t>> groups;
    for (Index t = 0; t < tasks.size(); ++t) {
        std::uint64_t taken = 0;
        for (const std::int32_t c : tasks[t].cells) taken |= masksOf(c).read;
        for (const std::int32_t c : reads[t]) taken |= masksOf(c).changed;
        const int free = std::countr_one(taken);
        if (free == 64) continue;
        for (const std::int32_t c : tasks[t].cells) masksOf(c).changed |= std::uint64_t(1) << free;
        for (const std::int32_t c : reads[t]) masksOf(c).read |= std::uint64_t(1) << free;
        if (groups.size() <= Index(free)) groups.resize(Index(free) + 1);
        groups[Index(free)].push_back(static_cast<std::uint32_t>(t));
    }
    return groups;
}

template <class Move>
std::int64_t Optimiser::sweep(std::vector<Task>& tasks, const Move& move) {
    parallelChunks(tasks.size(), 32, [&](Index begin, Index end, Index) {
        Worker worker(*this);
        for (Index t = begin; t < end; ++t) {
            worker.begin(tasks[t]);
            tasks[t].cells = worker.star.cells();
        }
    });
    std::int64_t moves = 0;
    for (const std::vector<std::uint32_t>& group : colour(tasks)) {
        std::vector<std::uint8_t> hasMoved(group.size(), 0);
        parallelChunks(group.size(), 8, [&](Index begin, Index end, Index) {
            Worker worker(*this);
            for (Index i = begin; i < end; ++i) hasMoved[i] = move(tasks[group[i]], worker);
        });
        std::vector<std::int32_t> points, seeds;
        MeshNodes::Moved moved;
        for (Index i = 0; i < group.size(); ++i) {
            if (!hasMoved[i]) continue;
            ++moves;
            const Task& task = tasks[group[i]];
            moved.clear();
            nodes_.follow(task.node, nodes_.place(task.node), moved);
            for (const auto& [p, x] : moved) points.push_back(p);
            seeds.insert(seeds.end(), task.cells.begin(), task.cells.end());
        }
        faults_.update(points, seeds);
    }
    return moves;
}

std::int64_t Optimiser::mend(int sweeps, bool mayLeave) {
    mayLeave_ = mayLeave;
    std::int64_t moves = 0, before = 0, patientFrom = 0;
    for (int i = 0; i < sweeps; ++i) {
        FaultCount count;
        std::vector<std::int32_t> cells = faults_.badCells();
        const std::vector<std::int32_t> poor = faults_.poorCells(count);
        if (i >= patience && count.all > many * layers_ && static_cast<double>(count.all) > stalled * static_cast<double>(before)) break;
        if (thin_ && i % thinPatience == 0) {
            if (i > 0 && count.all > 0 && static_cast<double>(count.all) > stalled * static_cast<double>(patientFrom) && cells.empty()) break;
            patientFrom = count.all;
        }
        before = count.all;
        cells.insert(cells.end(), poor.begin(), poor.end());
        std::vector<Task> tasks = tasksOf(cells);
        const std::int64_t now = sweep(tasks, [&](const Task& t, Worker& w) { return mendNode(t, w); });
        moves += now;
        if (now == 0) break;
    }
    return moves;
}

std::vector<Optimiser::Task> Optimiser::tasksOff() const {
    const Index walls = front_.firstInserted();
    std::vector<std::uint8_t> off(walls, 0);
    parallelFor(walls, [&](Index v) {
        Vec3 target;
        off[v] = targetOf(static_cast<std::int32_t>(v), target) && norm(target - front_.wall(v)) > offWall * front_.h[v];
    });
    return wallTasks(off);
}

// Of the wall vertices wanted, each with a cell at the wall.
std::vector<Optimiser::Task> Optimiser::wallTasks(const std::vector<std::uint8_t>& wanted) const {
    const Index walls = wanted.size();
    std::vector<std::int32_t> cellOf(walls, -1); // a wall cell of each
    const auto first = static_cast<std::int32_t>(mesh_.neighbour.size());
    for (std::int32_t f = first; f < mesh_.faces(); ++f) {
        for (const std::int32_t p : mesh_.face(f)) {
            if (p < nodes_.corePoints()) continue;
            const Index v = nodes_.vertexOf(p);
            if (v < walls && wanted[v] && cellOf[v] < 0) cellOf[v] = mesh_.owner[Index(f)];
        }
    }
    std::vector<Task> tasks;
    for (Index v = 0; v < walls; ++v) {
        if (cellOf[v] >= 0) tasks.push_back({{MeshNode::wall, static_cast<std::int32_t>(v)}, cellOf[v], {}});
    }
    return tasks;
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

std::int64_t Optimiser::snapWished(int sweeps) {
    std::vector<std::uint8_t> wanted(guide_.wishes.size());
    for (Index v = 0; v < wanted.size(); ++v) wanted[v] = guide_.wishes[v].kind != SnapKind::none;
    std::vector<Task> tasks = wallTasks(wanted);
    std::int64_t moves = 0;
    for (int i = 0; i < sweeps && !tasks.empty(); ++i) moves += sweep(tasks, [&](const Task& t, Worker& w) { return snapNode(t, w); });
    return moves;
}

std::int64_t Optimiser::pullIn(int sweeps) {
    std::vector<Task> tasks = tasksOff();
    std::int64_t moves = 0;
    for (int i = 0; i < sweeps && !tasks.empty(); ++i) {
        const std::int64_t now = sweep(tasks, [&](const Task& t, Worker& w) { return pullNode(t, w); });
        moves += now;
        if (now == 0) break;
    }
    return moves;
}

} // namespace i2b
