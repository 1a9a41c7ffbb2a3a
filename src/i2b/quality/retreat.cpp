#include "i2b/quality/retreat.h"
#include "i2b/core/parallel.h"
#include "i2b/core/raw_vector.h"
#include <algorithm>

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
    Nodes(const Front& front, const LatticeMesh& lattice, LayerStack& layers, double thickness)
        : front_(front), layers_(layers), core_(static_cast<std::size_t>(front.corePoints) + front.inserted.size()) {
        const RawVector<Vec3> start = lattice.latticePoints();
        const auto startOf = [&](std::int32_t point) { return start[static_cast<std::size_t>(point)]; };
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
        beta.assign(core_ + fans, 1.0f);
        touched_.assign(beta.size(), 0);
        for (const Column& c : layers.columns) bend_.push_back(c.bend);
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
        if (beta[n] == value) return;
        beta[n] = value;
        touched_[n] = 1;
        // The wall's normals are those of the fit: at the start columns are straight.
        if (n >= core_ && !bend_.empty()) layers_.columns[n - core_].bend = bend_[n - core_] * value;
    }
    // Puts the mesh points of all nodes set since the last time where they belong; gives their numbers.
    std::vector<std::int32_t> place(RawVector<Vec3>& points);
    void store(Front& front) const;

    std::vector<float> beta; // per node; to be changed by set()

  private:
    // The front position of a fan now: inserted ones stay on the edge that they divide.
    Vec3 frontNow(std::size_t v) const {
        if (v < ahead_.size()) return ahead_[v].at(beta[static_cast<std::size_t>(front_.corePoint[v])]);
        const Front::Inserted& i = front_.inserted[v - ahead_.size()];
        return i.frontAt(frontNow(static_cast<std::size_t>(i.ends[0])), frontNow(static_cast<std::size_t>(i.ends[1])), wall_[v].at(beta[core_ + v]));
    }
    bool frontTouched(std::size_t v) const {
        if (v < ahead_.size()) return touched_[static_cast<std::size_t>(front_.corePoint[v])] != 0;
        const Front::Inserted& i = front_.inserted[v - ahead_.size()];
        return touched_[core_ + v] != 0 || frontTouched(static_cast<std::size_t>(i.ends[0])) || frontTouched(static_cast<std::size_t>(i.ends[1]));
    }

    const Front& front_;
    LayerStack& layers_;
    std::size_t core_;
    RawVector<Path> behind_;             // as front.movedPoints
    RawVector<Path> ahead_;              // per fan that the lattice has
    RawVector<Path> wall_;               // per fan
    std::vector<float> bend_;              // per fan, of its column at the end of the fit; empty: all straight
    std::vector<std::uint8_t> touched_;    // per node
};

std::vector<std::int32_t> Nodes::place(RawVector<Vec3>& points) {
    std::vector<std::int32_t> moved;
    const auto put = [&](std::size_t p, const Vec3& to) {
        points[p] = to;
        moved.push_back(static_cast<std::int32_t>(p));
    };
    for (std::size_t i = 0; i < behind_.size(); ++i) {
        const auto p = static_cast<std::size_t>(front_.movedPoints[i]);
        if (touched_[p]) put(p, behind_[i].at(beta[p]));
    }
    for (std::size_t v = 0; v < wall_.size(); ++v) {
        const auto p = static_cast<std::size_t>(front_.corePoint[v]);
        const bool frontMoves = frontTouched(v);
        if (frontMoves) put(p, frontNow(v));
        if (!frontMoves && !touched_[core_ + v]) continue;
        const std::size_t first = core_ + layers_.pointOffset(v), n = static_cast<std::size_t>(layers_.pointsOf(v));
        placeLayers(layers_, v, frontNow(v), wall_[v].at(beta[core_ + v]), &points[first]);
        for (std::size_t k = 0; k < n; ++k) moved.push_back(static_cast<std::int32_t>(first + k));
    }
    std::fill(touched_.begin(), touched_.end(), std::uint8_t(0));
    return moved;
}

void Nodes::store(Front& front) const {
    parallelFor(behind_.size(), [&](std::size_t i) { front.movedTo[i] = behind_[i].at(beta[static_cast<std::size_t>(front.movedPoints[i])]); }, 2048);
    parallelFor(wall_.size(), [&](std::size_t v) {
        const Vec3 b = wall_[v].at(beta[core_ + v]);
        front.front[v] = frontNow(v);
        front.mesh.set_point(FrontMesh::VertexHandle(static_cast<int>(v)), {b.x, b.y, b.z});
    }, 2048);
}

// One repair: the mesh, how far its nodes have gone, and what is wrong with it now.
class Retreat {
  public:
    Retreat(PolyMesh& mesh, const Rows& cellFaces, MeshFaults& faults, Nodes& nodes)
        : mesh_(mesh), cellFaces_(cellFaces), faults_(faults), nodes_(nodes), visited_(static_cast<std::size_t>(mesh.cells), 0),
          queued_(static_cast<std::size_t>(mesh.cells), 0) {}

    // The points of the cells step back, those around them follow, and the mesh is measured again there.
    void step(const std::vector<std::int32_t>& cells, float step);
    // All nodes to another state of before.
    void restore(const std::vector<float>& beta);

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
    std::vector<std::uint8_t> visited_, queued_; // per cell: in any step; in this one
};

// Bounds the difference of beta inside cells, starting from cells whose points have just stepped back. Gives all cells
// that it looked at.
std::vector<std::int32_t> Retreat::spread(std::vector<std::int32_t> cells) {
    std::vector<std::int32_t> all;
    for (int ring = 0; ring < 4 && !cells.empty(); ++ring) {
        std::vector<std::int32_t> next;
        for (std::int32_t c : cells) {
            float low = 1;
            forNodes(c, [&](std::size_t n) { low = std::min(low, nodes_.beta[n]); });
            forNodes(c, [&](std::size_t n) { nodes_.set(n, std::min(nodes_.beta[n], low + float(slope))); });
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
    std::vector<std::size_t> stepping; // each node steps back once
    for (std::int32_t c : cells) forNodes(c, [&](std::size_t n) { stepping.push_back(n); });
    std::sort(stepping.begin(), stepping.end());
    stepping.erase(std::unique(stepping.begin(), stepping.end()), stepping.end());
    for (std::size_t n : stepping) nodes_.set(n, std::max(0.0f, nodes_.beta[n] - step));
    const std::vector<std::int32_t> seeds = spread(cells);
    for (std::int32_t c : seeds) visited_[static_cast<std::size_t>(c)] = 1;
    faults_.update(nodes_.place(mesh_.points), seeds);
}

void Retreat::restore(const std::vector<float>& beta) {
    for (std::size_t n = 0; n < beta.size(); ++n) nodes_.set(n, beta[n]);
    std::vector<std::int32_t> seeds;
    for (std::size_t c = 0; c < visited_.size(); ++c) {
        if (visited_[c]) seeds.push_back(static_cast<std::int32_t>(c));
    }
    faults_.update(nodes_.place(mesh_.points), seeds);
}

} // namespace

RetreatSummary retreatFromFaults(PolyMesh& mesh, const Rows& cellFaces, MeshFaults& faults, Front& front, const LatticeMesh& lattice, LayerStack& layers,
                                 double startThickness, RetreatFrom from) {
    RetreatSummary summary;
    Nodes nodes(front, lattice, layers, startThickness);
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
    std::vector<float> best = nodes.beta;
    const auto returnToBest = [&] {
        if (best == nodes.beta) return;
        retreat.restore(best);
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
            best = nodes.beta;
        }
        returnToBest();
    }
    summary.wrongCells = std::move(bad);
    nodes.store(front);
    for (const float beta : nodes.beta) summary.retracted += beta < 1;
    return summary;
}

} // namespace i2b
