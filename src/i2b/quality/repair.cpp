#include "i2b/quality/repair.h"
#include "i2b/core/parallel.h"
#include "i2b/quality/mesh_geometry.h"
#include "i2b/quality/quality_report.h"
#include <algorithm>

namespace i2b {
namespace {

constexpr double stepBack = 0.35; // of the way from start to fit, a round
constexpr double slope = 0.34;    // largest difference between points of one cell
constexpr int gentleRounds = 12;  // then the points of a bad cell go back whole
constexpr int lastRound = 40;
constexpr int qualityRounds = 14;
constexpr double qualityStep = 0.2;
constexpr double flat = 1e-9;     // a pyramid below this part of its cell's size counts as wrong

// The nodes that the fit has placed: core points, then the wall point of each fan.
class Nodes {
  public:
    Nodes(const Front& front, const LatticeMesh& lattice, const LayerStack& layers, double thickness)
        : core_(static_cast<std::size_t>(lattice.pointCount())), layers_(static_cast<std::size_t>(layers.count)),
          start(lattice.latticePoints()) {
        for (std::size_t v = 0; v < front.front.size(); ++v) {
            const std::array<std::int8_t, 3>& d = front.direction[v];
            const Vec3 f = start[static_cast<std::size_t>(front.corePoint[v])];
            start.push_back(f + Vec3{double(d[0]), double(d[1]), double(d[2])} * (thickness * front.h[v]));
        }
        fitted = start;
        corePoint_.assign(front.corePoint.begin(), front.corePoint.end());
        for (std::size_t i = 0; i < front.movedPoints.size(); ++i) fitted[static_cast<std::size_t>(front.movedPoints[i])] = front.movedTo[i];
        for (std::size_t v = 0; v < front.front.size(); ++v) {
            const auto& p = front.mesh.point(FrontMesh::VertexHandle(static_cast<int>(v)));
            fitted[static_cast<std::size_t>(front.corePoint[v])] = front.front[v];
            fitted[core_ + v] = {p[0], p[1], p[2]};
        }
        beta.assign(start.size(), 1.0f);
    }
    // Of a mesh point; the points of a layer belong to the fan.
    std::size_t of(std::int32_t point) const {
        const auto p = static_cast<std::size_t>(point);
        return p < core_ ? p : core_ + (p - core_) / layers_;
    }
    // The place of a layer point hangs on the front point of its fan too, which its cell may not have.
    bool ofLayer(std::int32_t point) const { return static_cast<std::size_t>(point) >= core_; }
    std::size_t frontOf(std::size_t node) const { return static_cast<std::size_t>(corePoint_[node - core_]); }
    Vec3 place(std::size_t n) const { return beta[n] == 1.0f ? fitted[n] : start[n] + (fitted[n] - start[n]) * double(beta[n]); }
    void store(Front& front) const {
        for (std::size_t i = 0; i < front.movedPoints.size(); ++i) front.movedTo[i] = place(static_cast<std::size_t>(front.movedPoints[i]));
        for (std::size_t v = 0; v < front.front.size(); ++v) {
            const Vec3 b = place(core_ + v);
            front.front[v] = place(static_cast<std::size_t>(front.corePoint[v]));
            front.mesh.set_point(FrontMesh::VertexHandle(static_cast<int>(v)), {b.x, b.y, b.z});
        }
    }

  private:
    std::size_t core_, layers_;
    std::vector<std::int32_t> corePoint_;

  public:
    std::vector<Vec3> start, fitted;
    std::vector<float> beta;
};

std::vector<std::int32_t> badCells(const PolyMesh& mesh, const Rows& cellFaces) {
    const MeshGeometry g = measureGeometry(mesh, cellFaces);
    std::vector<std::uint8_t> bad(static_cast<std::size_t>(mesh.cells), 0);
    parallelFor(bad.size(), [&](std::size_t c) {
        const auto cell = static_cast<std::int32_t>(c);
        bool wrong = !(g.cellVolume[c] > 0);
        for (std::int32_t f : cellFaces[cell]) {
            const auto i = static_cast<std::size_t>(f);
            const Vec3 arm = g.faceCentre[i] - g.cellCentre[c];
            const double sign = mesh.owner[i] == cell ? 1 : -1;
            wrong = wrong || !(sign * dot(g.faceArea[i], arm) > flat * norm(g.faceArea[i]) * norm(arm));
        }
        bad[c] = wrong;
    });
    std::vector<std::int32_t> cells;
    for (std::size_t c = 0; c < bad.size(); ++c) {
        if (bad[c]) cells.push_back(static_cast<std::int32_t>(c));
    }
    return cells;
}

// f(node) for the nodes of a cell, with repeats.
template <class F>
void forNodes(const PolyMesh& mesh, const Rows& cellFaces, const Nodes& nodes, std::int32_t cell, const F& f) {
    for (std::int32_t face : cellFaces[cell]) {
        for (std::int32_t p : mesh.face(face)) {
            f(nodes.of(p));
            if (nodes.ofLayer(p)) f(nodes.frontOf(nodes.of(p)));
        }
    }
}

// Cells at both sides of faces beyond the limits, and cells of small determinant.
std::vector<std::int32_t> poorCells(const PolyMesh& mesh, std::int64_t& faults) {
    QualityLimits limits; // a little inside those that the report judges by
    limits.nonOrthogonality = 68;
    limits.skewness = 3.8;
    limits.faceWeight = 0.055;
    limits.volumeRatio = 0.02;
    limits.determinant = 0.0015;
    const QualityReport report = measureQuality(mesh, limits);
    std::vector<std::int32_t> cells;
    faults = 0;
    for (const QualityCheck& check : report.checks) {
        const bool ofFaces = check.name == "nonOrthoFaces" || check.name == "skewFaces" || check.name == "lowWeightFaces" || check.name == "lowVolRatioFaces";
        if (!ofFaces && check.name != "underdeterminedCells") continue;
        faults += check.count;
        for (std::int32_t id : check.ids) {
            cells.push_back(ofFaces ? mesh.owner[static_cast<std::size_t>(id)] : id);
            if (ofFaces && id < mesh.internalFaces()) cells.push_back(mesh.neighbour[static_cast<std::size_t>(id)]);
        }
    }
    std::sort(cells.begin(), cells.end());
    cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
    return cells;
}

// Bounds the difference of beta inside cells, starting from cells whose points have just stepped back.
void spread(const PolyMesh& mesh, const Rows& cellFaces, Nodes& nodes, std::vector<std::int32_t> cells) {
    std::vector<std::uint8_t> queued(static_cast<std::size_t>(mesh.cells), 0);
    for (int ring = 0; ring < 4 && !cells.empty(); ++ring) {
        std::vector<std::int32_t> next;
        for (std::int32_t c : cells) {
            float low = 1;
            forNodes(mesh, cellFaces, nodes, c, [&](std::size_t n) { low = std::min(low, nodes.beta[n]); });
            forNodes(mesh, cellFaces, nodes, c, [&](std::size_t n) { nodes.beta[n] = std::min(nodes.beta[n], low + float(slope)); });
            for (std::int32_t f : cellFaces[c]) {
                if (f >= mesh.internalFaces()) continue;
                const auto i = static_cast<std::size_t>(f);
                const std::int32_t other = mesh.owner[i] == c ? mesh.neighbour[i] : mesh.owner[i];
                if (!queued[static_cast<std::size_t>(other)]) queued[static_cast<std::size_t>(other)] = 1, next.push_back(other);
            }
        }
        cells = std::move(next);
    }
}

// The points of the cells step back, and the front and the mesh follow.
void retreat(const std::vector<std::int32_t>& cells, float step, PolyMesh& mesh, const Rows& cellFaces, Nodes& nodes, Front& front,
             const LatticeMesh& lattice, const LayerStack& layers) {
    std::vector<std::uint8_t> done(nodes.beta.size(), 0); // each node steps back once a round
    for (std::int32_t c : cells) {
        forNodes(mesh, cellFaces, nodes, c, [&](std::size_t n) {
            if (done[n]) return;
            done[n] = 1;
            nodes.beta[n] = std::max(0.0f, nodes.beta[n] - step);
        });
    }
    spread(mesh, cellFaces, nodes, cells);
    nodes.store(front);
    placePoints(lattice, front, layers, mesh.points);
}

} // namespace

RepairSummary repair(PolyMesh& mesh, Front& front, const LatticeMesh& lattice, const LayerStack& layers, double startThickness) {
    RepairSummary summary;
    const Rows cellFaces = buildCellFaces(mesh);
    std::vector<std::int32_t> bad = badCells(mesh, cellFaces);
    summary.badCells = static_cast<std::int64_t>(bad.size());
    std::vector<std::int32_t> poor = bad.empty() ? poorCells(mesh, summary.poorFaces) : bad;
    if (poor.empty()) return summary;
    Nodes nodes(front, lattice, layers, startThickness);
    const auto makeValid = [&] {
        for (int round = 0; !bad.empty() && round < lastRound; ++round, ++summary.rounds) {
            retreat(bad, round < gentleRounds ? float(stepBack) : 1.0f, mesh, cellFaces, nodes, front, lattice, layers);
            bad = badCells(mesh, cellFaces);
        }
    };
    if (!bad.empty()) {
        makeValid();
        poor = poorCells(mesh, summary.poorFaces);
    }
    // Retreat for quality as long as it helps; the best state counts.
    summary.poorRemaining = summary.poorFaces;
    std::vector<float> best = nodes.beta;
    for (int round = 0; !poor.empty() && bad.empty() && round < qualityRounds; ++round, ++summary.rounds) {
        retreat(poor, float(qualityStep), mesh, cellFaces, nodes, front, lattice, layers);
        bad = badCells(mesh, cellFaces);
        makeValid();
        std::int64_t faults = 0;
        poor = poorCells(mesh, faults);
        if (!bad.empty() || faults >= summary.poorRemaining) continue;
        summary.poorRemaining = faults;
        best = nodes.beta;
    }
    if (best != nodes.beta) {
        nodes.beta = best;
        nodes.store(front);
        placePoints(lattice, front, layers, mesh.points);
        bad = badCells(mesh, cellFaces);
    }
    for (float b : nodes.beta) summary.retracted += b < 1;
    summary.remaining = static_cast<std::int64_t>(bad.size());
    return summary;
}

} // namespace i2b
