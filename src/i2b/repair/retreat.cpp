#include "i2b/repair/retreat.h"
#include "i2b/core/collect.h"
#include "i2b/core/raw_vector.h"
#include "i2b/core/sort_unique.h"
#include <algorithm>
#include <tbb/parallel_sort.h>

namespace i2b {
namespace {

constexpr double backward = 0.35; // of the way from start to fit, a round
constexpr double slope = 0.34;    // largest difference between points of one cell
constexpr int gentleRounds = 12;  // then the points of a bad cell go back whole
constexpr int lastRound = 40;
constexpr int qualityRounds = 14;
constexpr double qualityStep = 0.2;

// The way of a point from the start of the fit to its end.
struct Path {
    Vec3 start, fitted;
    Vec3 at(float beta) const { return beta == 1.0f ? fitted : start + (fitted - start) * double(beta); }
};

// The nodes that the fit has placed: core points, then the wall point of each fan. Each has a beta, the share of its
// way that it has gone; a way only where it has moved.
class Nodes {
  public:
    Nodes(const Front& front, const MeshNodes& meshNodes, const LatticeMesh& lattice, LayerStack& layers, double thickness)
        : front_(front), meshNodes_(meshNodes), layers_(layers), core_(static_cast<std::size_t>(front.corePoints) + front.inserted.size()) {
        const auto startOf = [&](std::int32_t point) { return lattice.latticePoint(point); };
        const std::size_t fans = front.front.size();
        behind_.resize(front.movedPoints.size()), ahead_.resize(front.firstInserted()), wall_.reserve(fans), wall_.resize(front.firstInserted());
        parallelFor(behind_.size(), [&](std::size_t i) { behind_[i] = {startOf(front.movedPoints[i]), front.movedTo[i]}; }, 2048);
        parallelFor(ahead_.size(), [&](std::size_t v) {
            const std::array<std::int8_t, 3>& d = front.direction[v];
            const Vec3 f = startOf(front.corePoint[v]);
            ahead_[v] = {f, front.front[v]};
            wall_[v] = {f + Vec3{double(d[0]), double(d[1]), double(d[2])} * (thickness * front.h[v]), front_.wall(v)};
        }, 2048);
        for (const Front::Inserted& i : front.inserted) { // on an edge, of the front and of the wall, at the start
            const auto p = static_cast<std::size_t>(i.ends[0]), q = static_cast<std::size_t>(i.ends[1]);
            wall_.push_back({wall_[p].start + (wall_[q].start - wall_[p].start) * i.t, front_.wall(wall_.size())});
        }
        followers_ = collect<Follower>(fans - ahead_.size(), [&](std::size_t i, const auto& put) {
            const std::size_t v = ahead_.size() + i;
            forNodesOf(v, [&](std::size_t n) { put({n, v}); });
        }, 1024);
        tbb::parallel_sort(followers_);
        beta_.resize(core_ + fans), marks_.resize(core_ + fans);
        parallelFor(beta_.size(), [&](std::size_t n) { beta_[n] = 1, marks_[n] = 0; }, 8192);
        bend_.resize(layers.columns.size());
        parallelFor(bend_.size(), [&](std::size_t v) { bend_[v] = layers.columns[v].bend; }, 8192);
    }
    // Of a mesh point; the points of a layer belong to the fan.
    std::size_t of(std::int32_t point) const {
        const auto p = static_cast<std::size_t>(point);
        return p < core_ ? p : core_ + layers_.vertexOfPoint(p - core_);
    }
    // The place of a layer point hangs on the front point of its fan too, which its cell may not have.
    bool ofLayer(std::int32_t point) const { return static_cast<std::size_t>(point) >= core_; }
    std::size_t frontOf(std::size_t node) const { return static_cast<std::size_t>(front_.corePoint[node - core_]); }

    void set(std::size_t n, float value) {
        if (beta_[n] == value) return;
        beta_[n] = value;
        if (!(marks_[n] & stepped)) stepped_.push_back(n);
        if (!(marks_[n] & touched)) touched_.push_back(n);
        marks_[n] = stepped | touched;
        // The wall's normals are those of the fit: at the start columns are straight.
        if (n >= core_ && !bend_.empty()) layers_.columns[n - core_].bend = bend_[n - core_] * value;
    }
    // Puts the mesh points of all nodes set since the last time where they belong; gives their numbers.
    std::vector<std::int32_t> place(RawVector<Vec3>& points);
    void store(Front& front) const;

    float beta(std::size_t n) const { return beta_[n]; }
    // How far those have gone that ever stepped back, in the order in which they first did. All others are at the end of their way.
    std::vector<float> state() const {
        std::vector<float> betas;
        for (const std::size_t n : stepped_) betas.push_back(beta_[n]);
        return betas;
    }
    void returnTo(const std::vector<float>& state) { // of before
        for (std::size_t i = 0; i < stepped_.size(); ++i) set(stepped_[i], i < state.size() ? state[i] : 1.0f);
    }
    std::int64_t behind() const {
        return std::count_if(stepped_.begin(), stepped_.end(), [&](std::size_t n) { return beta_[n] < 1; });
    }

  private:
    // The front position of a fan now: inserted ones stay on the edge that they divide.
    Vec3 frontNow(std::size_t v) const {
        if (v < ahead_.size()) return ahead_[v].at(beta_[static_cast<std::size_t>(front_.corePoint[v])]);
        const Front::Inserted& i = front_.inserted[v - ahead_.size()];
        return i.frontAt(frontNow(static_cast<std::size_t>(i.ends[0])), frontNow(static_cast<std::size_t>(i.ends[1])), wall_[v].at(beta_[core_ + v]));
    }
    // f(node) for those on which the front position of an inserted fan hangs, with repeats.
    template <class F>
    void forNodesOf(std::size_t v, const F& f) const {
        if (v < ahead_.size()) return f(static_cast<std::size_t>(front_.corePoint[v]));
        f(core_ + v);
        for (const std::int32_t end : front_.inserted[v - ahead_.size()].ends) forNodesOf(static_cast<std::size_t>(end), f);
    }
    bool isTouched(std::size_t n) const { return (marks_[n] & touched) != 0; }
    bool frontTouched(std::size_t v) const {
        if (v < ahead_.size()) return isTouched(static_cast<std::size_t>(front_.corePoint[v]));
        const Front::Inserted& i = front_.inserted[v - ahead_.size()];
        return isTouched(core_ + v) || frontTouched(static_cast<std::size_t>(i.ends[0])) || frontTouched(static_cast<std::size_t>(i.ends[1]));
    }

    struct Follower { // an inserted fan whose front position hangs on a node
        std::size_t node, fan;
        friend auto operator<=>(const Follower&, const Follower&) = default;
    };

    const Front& front_;
    const MeshNodes& meshNodes_;
    LayerStack& layers_;
    std::size_t core_;
    RawVector<Path> behind_;             // as front.movedPoints
    RawVector<Path> ahead_;              // per fan that the lattice has
    RawVector<Path> wall_;               // per fan
    RawVector<Follower> followers_;      // sorted
    RawVector<float> bend_;              // per fan, of its column at the end of the fit; empty: all straight
    RawVector<float> beta_;              // per node
    enum Mark : std::uint8_t { stepped = 1, touched = 2 }; // back ever; set since nodes were placed last
    RawVector<std::uint8_t> marks_;      // per node
    std::vector<std::size_t> stepped_, touched_;
};

std::vector<std::int32_t> Nodes::place(RawVector<Vec3>& points) {
    std::vector<std::int32_t> moved;
    const auto put = [&](std::size_t p, const Vec3& to) {
        points[p] = to;
        moved.push_back(static_cast<std::int32_t>(p));
    };
    std::vector<std::size_t> fans; // that stand elsewhere now, or their front points
    for (const std::size_t n : touched_) {
        for (auto at = std::ranges::lower_bound(followers_, n, {}, &Follower::node); at != followers_.end() && at->node == n; ++at) fans.push_back(at->fan);
        if (n >= core_) {
            fans.push_back(n - core_);
            continue;
        }
        if (const std::int32_t i = meshNodes_.movedPlace(static_cast<std::int32_t>(n)); i >= 0) put(n, behind_[static_cast<std::size_t>(i)].at(beta_[n]));
        const auto [first, last] = meshNodes_.fansOf(static_cast<std::int32_t>(n));
        fans.insert(fans.end(), first, last);
    }
    sortUnique(fans);
    for (const std::size_t v : fans) {
        if (frontTouched(v)) put(static_cast<std::size_t>(front_.corePoint[v]), frontNow(v));
        const std::size_t first = core_ + layers_.pointOffset(v), n = static_cast<std::size_t>(layers_.pointsOf(v));
        placeLayers(layers_, v, frontNow(v), wall_[v].at(beta_[core_ + v]), &points[first]);
        for (std::size_t k = 0; k < n; ++k) moved.push_back(static_cast<std::int32_t>(first + k));
    }
    for (const std::size_t n : touched_) marks_[n] = stepped;
    touched_.clear();
    return moved;
}

void Nodes::store(Front& front) const {
    parallelFor(behind_.size(), [&](std::size_t i) { front.movedTo[i] = behind_[i].at(beta_[static_cast<std::size_t>(front.movedPoints[i])]); }, 2048);
    parallelFor(wall_.size(), [&](std::size_t v) {
        const Vec3 b = wall_[v].at(beta_[core_ + v]);
        front.front[v] = frontNow(v);
        front.mesh.set_point(FrontMesh::VertexHandle(static_cast<int>(v)), {b.x, b.y, b.z});
    }, 2048);
}

// One repair: the mesh, how far its nodes have gone, and what is wrong with it now.
class Retreat {
  public:
    Retreat(PolyMesh& mesh, const Rows& cellFaces, MeshFaults& faults, Nodes& nodes)
        : mesh_(mesh), cellFaces_(cellFaces), faults_(faults), nodes_(nodes), queued_(static_cast<std::size_t>(mesh.cells), 0) {}

    // The points of the cells step back, those around them follow, and the mesh is measured again there.
    void step(const std::vector<std::int32_t>& cells, float step);
    // All nodes to another state of before.
    void returnTo(const std::vector<float>& state);

  private:
    // f(node) for the nodes of a cell, with repeats.
    template <class F>
    void forNodes(std::int32_t cell, const F& f) const {
        for (std::int32_t face : cellFaces_[cell]) {
            for (std::int32_t p : mesh_.face(face)) {
                const std::size_t n = nodes_.of(p);
                f(n);
                if (nodes_.ofLayer(p)) f(nodes_.frontOf(n));
            }
        }
    }
    std::vector<std::int32_t> spread(std::vector<std::int32_t> cells);

    PolyMesh& mesh_;
    const Rows& cellFaces_;
    MeshFaults& faults_;
    Nodes& nodes_;
    std::vector<std::uint8_t> queued_; // per cell: in this step
    std::vector<std::int32_t> visited_; // in any
};

// Bounds the difference of beta inside cells, starting from cells whose points have just stepped back. Gives all cells
// that it looked at.
std::vector<std::int32_t> Retreat::spread(std::vector<std::int32_t> cells) {
    std::vector<std::int32_t> all;
    for (int ring = 0; ring < 4 && !cells.empty(); ++ring) {
        std::vector<std::int32_t> next;
        for (std::int32_t c : cells) {
            float low = 1;
            forNodes(c, [&](std::size_t n) { low = std::min(low, nodes_.beta(n)); });
            forNodes(c, [&](std::size_t n) { nodes_.set(n, std::min(nodes_.beta(n), low + float(slope))); });
            for (std::int32_t f : cellFaces_[c]) {
                if (f >= mesh_.internalFaces()) continue;
                const auto i = static_cast<std::size_t>(f);
                const std::int32_t other = mesh_.owner[i] == c ? mesh_.neighbour[i] : mesh_.owner[i];
                if (!queued_[static_cast<std::size_t>(other)]) queued_[static_cast<std::size_t>(other)] = 1, next.push_back(other);
            }
        }
        all.insert(all.end(), cells.begin(), cells.end());
        cells = std::move(next);
    }
    for (std::int32_t c : all) queued_[static_cast<std::size_t>(c)] = 0;
    for (std::int32_t c : cells) queued_[static_cast<std::size_t>(c)] = 0;
    return all;
}

void Retreat::step(const std::vector<std::int32_t>& cells, float step) {
    RawVector<std::size_t> stepping = collect<std::size_t>(cells.size(), [&](std::size_t i, const auto& put) { forNodes(cells[i], put); }, 512);
    tbb::parallel_sort(stepping); // each node steps back once
    stepping.erase(std::unique(stepping.begin(), stepping.end()), stepping.end());
    for (std::size_t n : stepping) nodes_.set(n, std::max(0.0f, nodes_.beta(n) - step));
    const std::vector<std::int32_t> seeds = spread(cells);
    visited_.insert(visited_.end(), seeds.begin(), seeds.end());
    faults_.update(nodes_.place(mesh_.points), seeds);
}

void Retreat::returnTo(const std::vector<float>& state) {
    nodes_.returnTo(state);
    const std::vector<std::int32_t> moved = nodes_.place(mesh_.points);
    if (moved.empty()) return; // it is that state already
    sortUnique(visited_);
    faults_.update(moved, visited_);
}

} // namespace

RetreatSummary retreatFromFaults(PolyMesh& mesh, const Rows& cellFaces, MeshFaults& faults, Front& front, const MeshNodes& meshNodes, const LatticeMesh& lattice,
                                 LayerStack& layers, double startThickness, RetreatFrom from) {
    RetreatSummary summary;
    Nodes nodes(front, meshNodes, lattice, layers, startThickness);
    Retreat retreat(mesh, cellFaces, faults, nodes);
    std::vector<std::int32_t> bad = faults.badCells();
    const auto makeValid = [&] {
        for (int round = 0; !bad.empty() && round < lastRound; ++round, ++summary.rounds) {
            retreat.step(bad, round < gentleRounds ? float(backward) : 1.0f);
            bad = faults.badCells();
        }
    };
    makeValid();
    FaultCount least;
    faults.poorCells(least);
    std::vector<float> best = nodes.state();
    const auto returnToBest = [&] {
        retreat.returnTo(best);
        bad = faults.badCells();
    };
    // The best state counts. Severe faults first: what mends them may leave layers thin beside a large cell, which is the
    // lesser evil.
    for (const bool severeOnly : {true, false}) {
        if (from == RetreatFrom::wrong || (from == RetreatFrom::severe && !severeOnly)) break;
        FaultCount count;
        std::vector<std::int32_t> poor = faults.poorCells(count, severeOnly);
        for (int round = 0; !poor.empty() && bad.empty() && round < qualityRounds; ++round, ++summary.rounds) {
            retreat.step(poor, float(qualityStep));
            bad = faults.badCells();
            makeValid();
            poor = faults.poorCells(count, severeOnly);
            if (!bad.empty() || !(count < least)) continue;
            least = count;
            best = nodes.state();
        }
        returnToBest();
    }
    summary.wrongCells = std::move(bad);
    nodes.store(front);
    summary.retracted = nodes.behind();
    return summary;
}

} // namespace i2b
