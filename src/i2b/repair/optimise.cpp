#include "i2b/repair/optimise.h"
#include "i2b/core/numbering.h"
#include "i2b/core/parallel.h"
#include "i2b/core/sort_unique.h"
#include "i2b/repair/optimise_worker.h"
#include <algorithm>
#include <bit>
#include <numeric>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_sort.h>

namespace i2b {
namespace {

using Index = std::size_t;
constexpr double offWall = 0.005;     // of h: nodes farther off are pulled in
constexpr int patience = 2;           // sweeps, then
constexpr int thinPatience = 4;       // the same for thin layers, however many
constexpr std::int64_t many = 200;    // faults of which more than
constexpr std::size_t few = 50;       // undivided faces: up to so many nothing is given up
constexpr int backSweeps = 4;
constexpr double stalled = 0.9;       // this share is left by a sweep are given up

} // namespace

std::vector<std::int32_t> cellsBeside(const PolyMesh& mesh, const std::vector<std::int32_t>& faces) {
    std::vector<std::int32_t> cells;
    for (const std::int32_t f : faces) {
        cells.push_back(mesh.owner[Index(f)]);
        if (f < mesh.internalFaces()) cells.push_back(mesh.neighbour[Index(f)]);
    }
    sortUnique(cells);
    return cells;
}

Optimiser::Optimiser(PolyMesh& mesh, const Rows& cellFaces, MeshFaults& faults, Front& front, LayerStack& layers, const WallGuide& guide)
    : mesh_(mesh), cellFaces_(cellFaces), faults_(faults), front_(front), stack_(layers), thin_(layers.areThin()), layers_(thin_ ? layers.count : 1), guide_(guide), nodes_(front, layers) {}

// Those of a face, each with a cell that uses it.
void Optimiser::addNodes(std::int32_t face, std::int32_t cell, std::vector<std::pair<MeshNode, std::int32_t>>& found) const {
    std::vector<MeshNode> nodes;
    for (const std::int32_t p : mesh_.face(face)) {
        nodes.clear();
        nodes_.nodesOf(p, nodes);
        for (const MeshNode& n : nodes) found.emplace_back(n, cell);
    }
}

std::vector<Optimiser::Task> Optimiser::asTasks(std::vector<std::pair<MeshNode, std::int32_t>> found) {
    tbb::parallel_sort(found.begin(), found.end());
    std::vector<Task> tasks;
    for (const auto& [node, cell] : found) {
        if (tasks.empty() || tasks.back().node != node) tasks.push_back({node, cell});
    }
    return tasks;
}

std::vector<Optimiser::Task> Optimiser::tasksOf(const std::vector<std::int32_t>& cells) const {
    constexpr Index chunk = 256;
    std::vector<std::vector<std::pair<MeshNode, std::int32_t>>> parts((cells.size() + chunk - 1) / chunk);
    parallelChunks(cells.size(), chunk, [&](Index begin, Index end, Index part) {
        for (Index i = begin; i < end; ++i)
            for (const std::int32_t f : cellFaces_[cells[i]]) addNodes(f, cells[i], parts[part]);
        sortUnique(parts[part]); // a node is found at many faces
    });
    std::vector<std::pair<MeshNode, std::int32_t>> found;
    for (const auto& part : parts) found.insert(found.end(), part.begin(), part.end());
    return asTasks(std::move(found));
}

std::vector<Optimiser::Task> Optimiser::tasksOfFaces(const std::vector<std::int32_t>& faces) const {
    std::vector<std::pair<MeshNode, std::int32_t>> found;
    for (const std::int32_t f : faces) addNodes(f, mesh_.owner[Index(f)], found);
    return asTasks(std::move(found));
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

namespace {

// Some of the cells of a mesh, each with its place among them in ascending order: a bit a cell, or by their numbers where they are few.
class CellRanks {
  public:
    CellRanks(std::int32_t cells, std::size_t adds) : areFew_(adds < Index(cells) / 256), words_(areFew_ ? 0 : Index(cells) / 64 + 1, 0) {}
    void add(std::int32_t cell) {
        if (areFew_) few_.add(cell);
        else words_[Index(cell) / 64] |= std::uint64_t(1) << (cell % 64);
    }
    std::size_t count() { // from here on rank() may be asked
        if (areFew_) {
            few_.close();
            return few_.items().size();
        }
        before_.resize(words_.size());
        std::uint32_t sum = 0;
        for (Index w = 0; w < words_.size(); ++w) before_[w] = sum, sum += static_cast<std::uint32_t>(std::popcount(words_[w]));
        return sum;
    }
    std::size_t rank(std::int32_t cell) const {
        if (areFew_) return Index(few_.placeOf(cell));
        const std::uint64_t lower = (std::uint64_t(1) << (cell % 64)) - 1;
        return before_[Index(cell) / 64] + static_cast<Index>(std::popcount(words_[Index(cell) / 64] & lower));
    }

  private:
    bool areFew_;
    Numbering few_;
    std::vector<std::uint64_t> words_;
    std::vector<std::uint32_t> before_; // set bits before each word
};

} // namespace

// The cells that a task changes and those beyond their faces, ascending.
void Optimiser::findStar(const Task& task, Worker& worker, Star& star) const {
    star.cells = worker.cellsOf(task);
    for (const std::int32_t c : star.cells) {
        star.reads.push_back(c);
        for (const std::int32_t f : cellFaces_[c]) {
            if (f < mesh_.internalFaces()) star.reads.push_back(mesh_.owner[Index(f)] == c ? mesh_.neighbour[Index(f)] : mesh_.owner[Index(f)]);
        }
    }
    sortUnique(star.reads);
    star.reads.shrink_to_fit();
}

const Optimiser::Star& Optimiser::starOf(const MeshNode& node, std::int32_t cell) {
    Star& star = stars_[node];
    if (star.cells.empty()) {
        Worker worker(*this);
        findStar({node, cell}, worker, star);
    }
    return star;
}

// Groups of tasks that may go at once: no cell that one changes is read by another. Those beyond 64 colours wait for
// the next sweep.
std::vector<std::vector<std::uint32_t>> Optimiser::colour(const std::vector<Task>& tasks) const {
    const Index reads = std::accumulate(tasks.begin(), tasks.end(), Index(0), [](Index n, const Task& t) { return n + t.star->reads.size(); });
    CellRanks ranks(mesh_.cells, reads);
    for (const Task& task : tasks)
        for (const std::int32_t c : task.star->reads) ranks.add(c);
    struct Masks { std::uint64_t read = 0, changed = 0; };
    std::vector<Masks> masks(ranks.count());
    std::vector<std::vector<std::uint32_t>> groups;
    for (Index t = 0; t < tasks.size(); ++t) {
        std::uint64_t taken = 0;
        for (const std::int32_t c : tasks[t].star->cells) taken |= masks[ranks.rank(c)].read;
        for (const std::int32_t c : tasks[t].star->reads) taken |= masks[ranks.rank(c)].changed;
        const int free = std::countr_one(taken);
        if (free == 64) continue;
        for (const std::int32_t c : tasks[t].star->cells) masks[ranks.rank(c)].changed |= std::uint64_t(1) << free;
        for (const std::int32_t c : tasks[t].star->reads) masks[ranks.rank(c)].read |= std::uint64_t(1) << free;
        if (groups.size() <= Index(free)) groups.resize(Index(free) + 1);
        groups[Index(free)].push_back(static_cast<std::uint32_t>(t));
    }
    return groups;
}

template <class Move>
std::int64_t Optimiser::sweep(std::vector<Task>& tasks, const Move& move, RestingNodes* resting) {
    tbb::enumerable_thread_specific<Worker> workers([this] { return Worker(*this); });
    std::vector<std::uint8_t> rests(tasks.size(), 0);
    std::vector<Star*> stars;
    for (Task& task : tasks) task.star = stars.emplace_back(&stars_[task.node]);
    parallelFor(tasks.size(), [&](Index t) {
        if (stars[t]->cells.empty()) findStar(tasks[t], workers.local(), *stars[t]);
        rests[t] = resting && resting->has(tasks[t].node, tasks[t].star->reads);
    }, 8);
    Index left = 0;
    for (Index t = 0; t < tasks.size(); ++t) {
        if (rests[t]) continue;
        if (left != t) tasks[left] = std::move(tasks[t]);
        ++left;
    }
    tasks.resize(left);
    std::int64_t moves = 0;
    std::vector<std::int32_t> touched;
    for (const std::vector<std::uint32_t>& group : colour(tasks)) {
        std::vector<std::uint8_t> hasMoved(group.size(), 0);
        std::vector<NodeMove> from;
        if (tracked_)
            for (const std::uint32_t t : group) from.push_back(whereIs(tasks[t].node, tasks[t].cell));
        parallelFor(group.size(), [&](Index i) { hasMoved[i] = move(tasks[group[i]], workers.local()); }, 1);
        std::vector<std::int32_t> changed; // each once: no task of a group reads what another changes
        for (Index i = 0; i < group.size(); ++i) {
            const Task& task = tasks[group[i]];
            if (resting && !hasMoved[i]) resting->stays(task.node);
            if (!hasMoved[i]) continue;
            ++moves;
            if (resting) resting->moves(task.star->cells);
            if (tracked_) tracked_->try_emplace(task.node, from[i]);
            changed.insert(changed.end(), task.star->cells.begin(), task.star->cells.end());
        }
        if (resting) resting->next();
        faults_.follow(changed);
        touched.insert(touched.end(), changed.begin(), changed.end());
    }
    sortUnique(touched);
    faults_.update(touched);
    return moves;
}

std::int64_t Optimiser::mend(int sweeps, bool mayLeave) {
    allMayLeave(mayLeave);
    std::int64_t moves = 0, before = 0, patientFrom = 0;
    RestingNodes resting;
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
        const std::int64_t now = sweep(tasks, [&](const Task& t, Worker& w) { return mendNode(t, w); }, &resting);
        moves += now;
        if (now == 0) break;
    }
    return moves;
}

std::int64_t Optimiser::mendKeepingTets(int sweeps) {
    keepsTets_ = true;
    const std::int64_t moves = mend(sweeps);
    keepsTets_ = false;
    return moves;
}

void Optimiser::mendAt(const std::vector<std::int32_t>& cells, int sweeps) {
    allMayLeave(false);
    RestingNodes resting;
    Index before = 0;
    for (int i = 0; i < sweeps; ++i) {
        FaultCount count;
        std::vector<std::int32_t> faulty;
        for (const std::vector<std::int32_t>& found : {faults_.badCells(), faults_.poorCells(count)})
            std::ranges::set_intersection(cells, found, std::back_inserter(faulty));
        if (i > 0 && static_cast<double>(faulty.size()) > stalled * static_cast<double>(before)) break;
        before = faulty.size();
        std::vector<Task> tasks = tasksOf(faulty);
        if (tasks.empty() || sweep(tasks, [&](const Task& t, Worker& w) { return mendNode(t, w); }, &resting) == 0) break;
    }
}

void Optimiser::mendFlatAt(const std::vector<std::int32_t>& cells, int sweeps) {
    allMayLeave(false);
    leastFull_ = faults_.limits().determinant;
    const std::vector<std::int32_t> undivided = faults_.undividedFaces();
    for (int i = 0; i < sweeps; ++i) {
        std::vector<Task> tasks = tasksOf(cells);
        if (sweep(tasks, [&](const Task& t, Worker& w) { return mendNode(t, w); }) == 0) break;
    }
    // Those moves do not ask whether faces divide.
    for (int i = 0; i < sweeps; ++i) {
        std::vector<std::int32_t> fresh;
        std::ranges::set_difference(faults_.undividedFaces(), undivided, std::back_inserter(fresh));
        std::vector<Task> tasks = tasksOfCellsAt(fresh);
        if (tasks.empty() || sweep(tasks, [&](const Task& t, Worker& w) { return mendNodeTets(t, w); }) == 0) break;
    }
    leastFull_ = 0;
}

std::vector<Optimiser::Task> Optimiser::tasksOfCellsAt(const std::vector<std::int32_t>& faces) const {
    return tasksOf(cellsBeside(mesh_, faces));
}

void Optimiser::mendTets(int sweeps, const std::vector<std::int32_t>& but) {
    allMayLeave(false);
    const auto facesLeft = [&] {
        std::vector<std::int32_t> left;
        std::ranges::set_difference(faults_.undividedFaces(), but, std::back_inserter(left));
        return left;
    };
    std::vector<std::int32_t> faces = facesLeft();
    RestingNodes resting;
    for (const bool wide : {false, true}) {
        for (int i = 0; i < sweeps && !faces.empty(); ++i) {
            std::vector<Task> tasks = wide ? tasksOfCellsAt(faces) : tasksOfFaces(faces);
            const std::int64_t moves = sweep(tasks, [&](const Task& t, Worker& w) { return mendNodeTets(t, w); }, &resting);
            const auto before = static_cast<double>(faces.size());
            faces = facesLeft();
            if (moves == 0 || (faces.size() > few && static_cast<double>(faces.size()) > stalled * before)) break;
        }
    }
}

void Optimiser::moveTogether(const std::vector<NodeMove>& moves) {
    std::vector<std::int32_t> points, seeds;
    MeshNodes::Moved moved;
    for (const NodeMove& m : moves) {
        if (tracked_) tracked_->try_emplace(m.node, whereIs(m.node, m.cell));
        if (float* bend = bendOf(m.node); bend && m.bend >= 0) *bend = m.bend;
        nodes_.moveTo(m.node, m.to);
        seeds.push_back(m.cell);
    }
    for (const NodeMove& m : moves) nodes_.moveTo(m.node, m.to); // front points on edges hang on others, which are where they go now
    for (const NodeMove& m : moves) nodes_.follow(m.node, m.to, moved);
    for (const auto& [p, x] : moved) mesh_.points[Index(p)] = x, points.push_back(p);
    faults_.update(points, seeds);
}

void Optimiser::undo() {
    if (!tracked_) return;
    std::vector<NodeMove> back;
    for (const auto& [node, from] : *tracked_) back.push_back(from);
    tracked_.reset();
    moveTogether(back);
}

void Optimiser::moveBack(const std::vector<MeshNode>& nodes) {
    std::vector<NodeMove> back;
    for (const MeshNode& node : nodes) back.push_back(tracked_->at(node));
    moveTogether(back);
    for (const MeshNode& node : nodes) tracked_->erase(node);
}

Optimiser::NodeMove Optimiser::whereIs(const MeshNode& node, std::int32_t cell) const {
    const float* bend = bendOf(node);
    return {node, cell, nodes_.place(node), bend ? *bend : -1};
}

std::vector<Optimiser::NodeMove> Optimiser::trackedPlaces() const {
    std::vector<NodeMove> places;
    if (!tracked_) return places;
    for (const auto& [node, from] : *tracked_) places.push_back(whereIs(node, from.cell));
    return places;
}

void Optimiser::comeBack(int sweeps, const std::vector<std::int32_t>& butAt) {
    if (!tracked_) return;
    Places places;
    std::vector<Task> tasks;
    const std::vector<Task> stay = tasksOfCellsAt(butAt);
    for (const auto& [node, from] : *tracked_) {
        if (node.kind != MeshNode::wall || std::ranges::binary_search(stay, node, {}, &Task::node)) continue;
        places[node.id] = from.to;
        tasks.push_back({node, from.cell});
    }
    bringBack(std::move(tasks), places, sweeps);
}

void Optimiser::bringBack(std::vector<Task> tasks, const Places& places, int sweeps) {
    for (int i = 0; i < sweeps && !tasks.empty(); ++i)
        sweep(tasks, [&](const Task& t, Worker& w) { return bringBack(t, places.at(t.node.id), w); });
}

void Optimiser::mendTetsOffWall(std::vector<std::int32_t> faces, int sweeps) {
    std::vector<Task> walls = tasksOfCellsAt(faces); // no others move
    std::erase_if(walls, [](const Task& t) { return t.node.kind != MeshNode::wall; });
    Places places;
    for (const Task& t : walls) places[t.node.id] = nodes_.place(t.node);
    allMayLeave(false), isLast_ = true;
    for (const Task& t : tasksOfFaces(faces))
        if (t.node.kind == MeshNode::wall) leavers_.insert(t.node.id);
    RestingNodes resting;
    for (int i = 0; i < sweeps && !faces.empty(); ++i) {
        std::vector<Task> tasks = tasksOfCellsAt(faces);
        if (sweep(tasks, [&](const Task& t, Worker& w) { return mendNodeTets(t, w); }, &resting) == 0) break;
        std::vector<std::int32_t> left;
        std::ranges::set_intersection(faces, faults_.undividedFaces(), std::back_inserter(left));
        faces = std::move(left);
    }
    allMayLeave(false), isLast_ = false;
    std::erase_if(walls, [&](const Task& t) { return places.at(t.node.id) == nodes_.place(t.node); });
    bringBack(std::move(walls), places, backSweeps);
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
        if (cellOf[v] >= 0) tasks.push_back({{MeshNode::wall, static_cast<std::int32_t>(v)}, cellOf[v]});
    }
    return tasks;
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
