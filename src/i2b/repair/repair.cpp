#include "i2b/repair/repair.h"
#include "i2b/core/parallel.h"
#include "i2b/edit/last_resort.h"
#include "i2b/edit/poor_places.h"
#include "i2b/quality/dictionary_measure.h"
#include "i2b/quality/mesh_faults.h"
#include "i2b/repair/recapture.h"
#include "i2b/repair/retreat.h"
#include "i2b/repair/step_back.h"
#include <algorithm>
#include <limits>
#include <optional>

namespace i2b {
namespace {

constexpr int settleRounds = 3;
constexpr std::int64_t manyFaults = 200, fewFaults = 200;
constexpr int mendSweeps = 12;
constexpr int bendRounds = 3, thinPause = 4; // of columns bent anew, with sweeps between
constexpr int thinSweeps = 24;    // of thin layers: all of a column move as one
constexpr int keepSweeps = 8;     // the first of these, in which no face ceases to divide
constexpr int wishSweeps = 2;
constexpr int pullSweeps = 3;
constexpr int flatSweeps = 12;
constexpr int tetSweeps = 8, offSweeps = 16, offRounds = 2, backRounds = 3;

// A little inside those that the report judges by: checkMesh's, and the user's where they ask for more.
QualityLimits strictLimits(const DictionaryLimits& asked) {
    const DictionaryBounds bounds(asked);
    QualityLimits limits;
    limits.nonOrthogonality = 0.9923 * std::min(limits.nonOrthogonality, asked.nonOrthogonality);
    limits.boundarySkewness = 0.95 * std::min(limits.skewness, bounds.boundarySkewness);
    limits.skewness = 0.95 * std::min(limits.skewness, bounds.internalSkewness);
    limits.faceWeight = 1.1 * std::max(limits.faceWeight, bounds.faceWeight);
    limits.volumeRatio = 2 * std::max(limits.volumeRatio, bounds.volumeRatio);
    limits.determinant = 1.5 * std::max(limits.determinant, bounds.determinant);
    limits.tetQuality = 1.5 * std::max(0.0, bounds.tetQuality);
    if (asked.pyramidVolume > 0) limits.pyramidVolume = 1.05 * asked.pyramidVolume;
    return limits;
}

std::vector<Vec3> wallPositions(const Front& front) {
    std::vector<Vec3> positions(front.front.size());
    parallelFor(positions.size(), [&](std::size_t v) { positions[v] = front.wall(v); }, 4096);
    return positions;
}

std::vector<std::int32_t> thinCellsAt(const PolyMesh& mesh, const std::vector<std::int32_t>& faces, std::int32_t thinFrom) {
    std::vector<std::int32_t> cells = cellsBeside(mesh, faces);
    std::erase_if(cells, [&](std::int32_t c) { return c < thinFrom; });
    return cells;
}

// In a lattice of cubes, one of them beside four at most, no face has over 25.3 degrees, no skewness is over 1/3, no weight under 1/3, no
// ratio of volumes or determinant under 1/8: where the limits leave room for that only cells with a point that moves are looked at.
// Empty: all are.
std::vector<std::uint8_t> movable(const PolyMesh& mesh, const LatticeMesh& lattice, const Front& front, const QualityLimits& limits) {
    const double h = lattice.lattice().h(lattice.lattice().maxLevel);
    const bool hasRoom = limits.nonOrthogonality > 30 && std::min(limits.skewness, limits.boundarySkewness) > 0.5 && limits.faceWeight < 0.3 &&
                         limits.volumeRatio < 0.1 && limits.determinant < 0.1 && limits.tetQuality < 1e-6 && limits.pyramidVolume < 0.05 * h * h * h;
    if (!lattice.cubes() || !hasRoom) return {};
    return mayMove(front, mesh.points.size());
}

class Repairer {
  public:
    Repairer(PolyMesh& mesh, Front& front, const LatticeMesh& lattice, LayerStack& layers, double startThickness, const WallGuide& guide, const DictionaryLimits& limits)
        : mesh_(mesh), front_(front), lattice_(lattice), layers_(layers), startThickness_(startThickness), limits_(limits), walls_(wallPositions(front)), thin_(layers.areThin()),
          thinFrom_(!layers.areFlat() ? mesh.cells : mesh.cells - static_cast<std::int32_t>(layers.cells())), cellFaces_(buildCellFaces(mesh)),
          faults_(mesh, cellFaces_, strictLimits(limits), thinFrom_, movable(mesh, lattice, front, strictLimits(limits))), guide_(guide), optimiser_(mesh, cellFaces_, faults_, front, layers, guide) {}
    RepairSummary run(std::size_t mostFolded);

  private:
    bool isClean() {
        faults_.poorCells(poor_);
        return poor_.all == 0 && faults_.badCells().empty();
    }
    void stepBack(RetreatFrom from);
    void settle();
    void mendSevere();
    void mendLastFaces(bool mayThinLeave);
    bool mendFlatCells();
    std::vector<std::int32_t> foldedCells() const;
    RepairSummary finish();

    PolyMesh& mesh_;
    Front& front_;
    const LatticeMesh& lattice_;
    LayerStack& layers_;
    double startThickness_;
    const DictionaryLimits& limits_;
    std::vector<Vec3> walls_; // m, where they were
    bool thin_;               // nodes off the wall do not mend thin layers: it takes whole columns
    std::int32_t thinFrom_;
    Rows cellFaces_;
    MeshFaults faults_;
    FaultCount poor_;         // when isClean() was last asked
    const WallGuide& guide_;
    Optimiser optimiser_;
    RepairSummary summary_;
};

void Repairer::stepBack(RetreatFrom from) {
    RetreatSummary r = retreatFromFaults(mesh_, cellFaces_, faults_, front_, optimiser_.nodes(), lattice_, layers_, startThickness_, from);
    summary_.rounds += r.rounds, summary_.retracted += r.retracted;
    summary_.wrongCells = std::move(r.wrongCells);
    summary_.remaining = static_cast<std::int64_t>(summary_.wrongCells.size());
}

// What single moves do not mend steps back; from there they may.
void Repairer::settle() {
    constexpr std::int64_t any = std::numeric_limits<std::int64_t>::max();
    std::int64_t goOnBelow = any; // many faults that stay are given up
    for (int round = 0; round < settleRounds && !isClean() && (poor_.all < goOnBelow || !faults_.badCells().empty()); ++round) {
        goOnBelow = poor_.all > manyFaults ? poor_.all / 2 : any;
        const std::int64_t before = summary_.moves;
        summary_.moves += optimiser_.mend(thin_ ? thinSweeps : mendSweeps);
        if (isClean()) return;
        for (int i = 0; thin_ && i < bendRounds && optimiser_.bend() > 0 && !isClean(); ++i) summary_.moves += optimiser_.mend(thinPause);
        if (isClean()) return;
        // A few wall nodes off the geometry rather than a retreat, which takes whole regions off it and makes their columns no better.
        summary_.moves += optimiser_.mend(mendSweeps, true);
        if (isClean() || (thin_ && summary_.moves == before && faults_.badCells().empty())) return;
        stepBack(thin_ || round + 1 < settleRounds ? RetreatFrom::wrong : RetreatFrom::poor);
    }
}

// Rather a few nodes off the wall than a face that spoils the solution.
void Repairer::mendSevere() {
    isClean();
    if (poor_.severe == 0 || poor_.severe > fewFaults) return;
    if (thin_) stepBack(RetreatFrom::severe);
    summary_.moves += optimiser_.mend(mendSweeps, !thin_);
}

// Faces that nothing else makes divide into tetrahedra. Where many faces are beyond other limits for good, these are not worth as much.
void Repairer::mendLastFaces(bool mayThinLeave) {
    isClean();
    if (poor_.all > fewFaults) return;
    const auto facesLeft = [&] {
        std::vector<std::int32_t> undivided = faults_.undividedFaces();
        if (!mayThinLeave) std::erase_if(undivided, [&](std::int32_t f) { return mesh_.owner[static_cast<std::size_t>(f)] >= thinFrom_; });
        return undivided.empty() ? undivided : facesBeyondHelp(mesh_, cellFaces_, undivided, limits_, thinFrom_);
    };
    std::vector<std::int32_t> left = facesLeft();
    for (int round = 0; round < offRounds && !left.empty(); ++round) {
        optimiser_.mendTetsOffWall(left, offSweeps);
        left = facesLeft();
    }
    if (!faults_.countsThinUndivided()) return; // a few beside so many are not worth the nodes that this takes off the wall
    // What helps one face may be in the way of another's help.
    for (int round = 0; round < backRounds && !left.empty(); ++round) {
        if (stepBackFrom(left, {mesh_, cellFaces_, faults_, front_, lattice_, startThickness_, limits_}, optimiser_) == 0) break;
        left = facesLeft();
    }
}

// Determinants go with the height of thin cells: only those under the limit count where few are, and of these only those that the last
// resort would not help. Undone where that leaves as many of them, faces that do not divide among them. Gives whether anything moved.
bool Repairer::mendFlatCells() {
    if (thinFrom_ >= mesh_.cells || !(DictionaryBounds(limits_).determinant > 0)) return false;
    const auto flatFaces = [&] { return facesOfFlatCells(mesh_, cellFaces_, thinFrom_, limits_.determinant); };
    const auto left = [&](const std::vector<std::int32_t>& flat) {
        std::vector<std::int32_t> all;
        std::ranges::set_union(flat, faults_.undividedFaces(), std::back_inserter(all));
        return facesBeyondHelp(mesh_, cellFaces_, all, limits_, thinFrom_);
    };
    const std::optional<std::vector<std::int32_t>> flat = flatFaces();
    if (!flat || flat->empty()) return false;
    const std::vector<std::int32_t> before = left(*flat);
    if (before.empty()) return false;
    FaultCount was, now;
    faults_.poorCells(was);
    optimiser_.track();
    optimiser_.mendFlatAt(thinCellsAt(mesh_, before, thinFrom_), flatSweeps);
    optimiser_.mend(mendSweeps); // what that has made poor
    faults_.poorCells(now);
    const std::optional<std::vector<std::int32_t>> after = flatFaces();
    const bool isBetter = faults_.badCells().empty() && now.all <= was.all && after && left(*after).size() < before.size();
    isBetter ? optimiser_.keep() : optimiser_.undo();
    return isBetter;
}

std::vector<std::int32_t> Repairer::foldedCells() const {
    std::vector<std::int32_t> cells;
    for (const std::int32_t f : faults_.undividedFaces())
        if (mesh_.owner[static_cast<std::size_t>(f)] >= thinFrom_) cells.push_back(mesh_.owner[static_cast<std::size_t>(f)]);
    return cells;
}

RepairSummary Repairer::finish() {
    isClean();
    summary_.poorRemaining = poor_.all;
    for (std::size_t v = 0; v < walls_.size(); ++v) summary_.movedWalls.push_back(!(front_.wall(v) == walls_[v]));
    summary_.cellFaces = std::move(cellFaces_);
    return std::move(summary_);
}

RepairSummary Repairer::run(std::size_t mostFolded) {
    isClean();
    summary_.badCells = static_cast<std::int64_t>(faults_.badCells().size());
    summary_.poorFaces = poor_.all;
    if (thin_ && faults_.countsThinUndivided()) summary_.moves += optimiser_.mendKeepingTets(keepSweeps);
    settle();
    if (summary_.remaining > 0) return finish();
    summary_.moves += optimiser_.snapWished(wishSweeps);
    summary_.moves += optimiser_.pullIn(pullSweeps);
    settle();
    mendSevere();
    optimiser_.mendTets(tetSweeps);
    summary_.foldedCells = foldedCells();
    if (!summary_.foldedCells.empty() && summary_.foldedCells.size() <= mostFolded) return finish();
    const bool mayThinLeave = mostFolded == 0;
    mendLastFaces(mayThinLeave);
    if (mendFlatCells()) mendLastFaces(mayThinLeave); // what is left of them may be faces that do not divide
    if (guide_.graph) recapture(mesh_, cellFaces_, faults_, front_, guide_, optimiser_);
    summary_.foldedCells = foldedCells();
    summary_.unmended = faults_.poorFaces();
    return finish();
}

} // namespace

RepairSummary repair(PolyMesh& mesh, Front& front, const LatticeMesh& lattice, LayerStack& layers, double startThickness,
                     const WallGuide& guide, const DictionaryLimits& limits, std::size_t mostFolded) {
    return Repairer(mesh, front, lattice, layers, startThickness, guide, limits).run(mostFolded);
}

} // namespace i2b
