#include "i2b/repair/repair.h"
#include "i2b/core/parallel.h"
#include "i2b/core/sort_unique.h"
#include "i2b/edit/last_resort.h"
#include "i2b/edit/poor_places.h"
#include "i2b/quality/dictionary_measure.h"
#include "i2b/quality/mesh_faults.h"
#include "i2b/repair/retreat.h"
#include "i2b/repair/step_back.h"
#include <algorithm>
#include <limits>

namespace i2b {
namespace {

constexpr int settleRounds = 3;
constexpr std::int64_t manyFaults = 200, fewFaults = 200;
constexpr int mendSweeps = 12;
constexpr int bendRounds = 3, thinPause = 4; // of columns bent anew, with sweeps between
constexpr int thinSweeps = 24;    // of thin layers: all of a column move as one
constexpr int wishSweeps = 2;
constexpr int pullSweeps = 3;
constexpr int flatSweeps = 12;
constexpr std::size_t fewFlat = 64; // faces of thin cells of a small determinant that nothing else helps
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
    std::vector<std::int32_t> cells;
    for (const std::int32_t f : faces) {
        cells.push_back(mesh.owner[static_cast<std::size_t>(f)]);
        if (f < mesh.internalFaces()) cells.push_back(mesh.neighbour[static_cast<std::size_t>(f)]);
    }
    std::erase_if(cells, [&](std::int32_t c) { return c < thinFrom; });
    sortUnique(cells);
    return cells;
}

// Determinants go with the height of thin cells: only those under the limit count where few are, and of these only those that the last
// resort would not help. Undone where that leaves as many of them, faces that do not divide among them.
void mendFlatCells(const PolyMesh& mesh, const Rows& cellFaces, const MeshFaults& faults, const DictionaryLimits& limits, Optimiser& optimiser) {
    const std::int32_t thinFrom = faults.thinFrom();
    if (thinFrom >= mesh.cells || !(DictionaryBounds(limits).determinant > 0)) return;
    const auto flatFaces = [&] { return facesOfFlatCells(mesh, cellFaces, thinFrom, limits.determinant, mostFlat); };
    const auto left = [&](const std::vector<std::int32_t>& flat) {
        std::vector<std::int32_t> all;
        std::ranges::set_union(flat, faults.undividedFaces(), std::back_inserter(all));
        return facesBeyondHelp(mesh, cellFaces, all, limits, thinFrom);
    };
    const std::vector<std::int32_t> flat = flatFaces();
    const std::vector<std::int32_t> before = flat.empty() ? flat : left(flat);
    if (before.empty() || before.size() > fewFlat) return;
    FaultCount was, now;
    faults.poorCells(was);
    optimiser.track();
    optimiser.mendFlatAt(thinCellsAt(mesh, before, thinFrom), flatSweeps);
    faults.poorCells(now);
    if (faults.badCells().empty() && now.all <= was.all && left(flatFaces()).size() < before.size()) optimiser.keep();
    else optimiser.undo();
}

} // namespace

RepairSummary repair(PolyMesh& mesh, Front& front, const LatticeMesh& lattice, LayerStack& layers, double startThickness,
                     const WallGuide& guide, const DictionaryLimits& limits, bool mayThinLeave) {
    RepairSummary summary;
    summary.cellFaces = buildCellFaces(mesh);
    const Rows& cellFaces = summary.cellFaces;
    // Nodes off the wall do not mend thin layers: it takes whole columns.
    const bool thin = layers.areThin();
    const std::int32_t thinFrom = !layers.areFlat() ? mesh.cells : mesh.cells - static_cast<std::int32_t>(layers.cells());
    MeshFaults faults(mesh, cellFaces, strictLimits(limits), thinFrom);
    FaultCount poor;
    faults.poorCells(poor);
    summary.badCells = static_cast<std::int64_t>(faults.badCells().size());
    summary.poorFaces = poor.all;
    const std::vector<Vec3> walls = wallPositions(front);
    Optimiser optimiser(mesh, cellFaces, faults, front, layers, guide);
    const auto isClean = [&] {
        faults.poorCells(poor);
        return poor.all == 0 && faults.badCells().empty();
    };
    const auto stepBack = [&](RetreatFrom from) {
        RetreatSummary r = retreatFromFaults(mesh, cellFaces, faults, front, optimiser.nodes(), lattice, layers, startThickness, from);
        summary.rounds += r.rounds, summary.retracted += r.retracted;
        summary.wrongCells = std::move(r.wrongCells);
        summary.remaining = static_cast<std::int64_t>(summary.wrongCells.size());
    };
    // What single moves do not mend steps back; from there they may.
    const auto settle = [&] {
        constexpr std::int64_t any = std::numeric_limits<std::int64_t>::max();
        std::int64_t goOnBelow = any; // many faults that stay are given up
        for (int round = 0; round < settleRounds && !isClean() && (poor.all < goOnBelow || !faults.badCells().empty()); ++round) {
            goOnBelow = poor.all > manyFaults ? poor.all / 2 : any;
            const std::int64_t before = summary.moves;
            summary.moves += optimiser.mend(thin ? thinSweeps : mendSweeps);
            if (isClean()) return;
            if (thin) {
                for (int i = 0; i < bendRounds && optimiser.bend() > 0 && !isClean(); ++i) summary.moves += optimiser.mend(thinPause);
                if (isClean()) return;
                // A retreat makes columns no better: it takes whole regions off the wall.
                summary.moves += optimiser.mend(mendSweeps, true);
                if (isClean() || (summary.moves == before && faults.badCells().empty())) return;
            }
            stepBack(thin ? RetreatFrom::wrong : RetreatFrom::poor);
        }
    };
    settle();
    const auto noteMoved = [&] {
        for (std::size_t v = 0; v < walls.size(); ++v) summary.movedWalls.push_back(!(front.wall(v) == walls[v]));
    };
    if (summary.remaining > 0) {
        noteMoved();
        return summary;
    }
    summary.moves += optimiser.snapWished(wishSweeps);
    summary.moves += optimiser.pullIn(pullSweeps);
    settle();
    isClean();
    // Rather a few nodes off the wall than a face that spoils the solution.
    if (poor.severe > 0 && poor.severe <= fewFaults) {
        if (thin) stepBack(RetreatFrom::severe);
        summary.moves += optimiser.mend(mendSweeps, !thin);
        isClean();
    }
    optimiser.mendTets(tetSweeps);
    const auto findFolded = [&] {
        for (const std::int32_t f : faults.undividedFaces())
            if (mesh.owner[static_cast<std::size_t>(f)] >= thinFrom) summary.foldedCells.push_back(mesh.owner[static_cast<std::size_t>(f)]);
    };
    if (!mayThinLeave) {
        findFolded();
        if (!summary.foldedCells.empty() && summary.foldedCells.size() <= mostFolded) {
            noteMoved();
            return summary;
        }
        summary.foldedCells.clear();
    }
    const auto facesLeft = [&] {
        std::vector<std::int32_t> undivided = faults.undividedFaces();
        if (!mayThinLeave) std::erase_if(undivided, [&](std::int32_t f) { return mesh.owner[static_cast<std::size_t>(f)] >= thinFrom; });
        return undivided.empty() ? undivided : facesBeyondHelp(mesh, cellFaces, undivided, limits, thinFrom);
    };
    std::vector<std::int32_t> left = facesLeft();
    for (int round = 0; round < offRounds && !left.empty(); ++round) {
        optimiser.mendTetsOffWall(left, offSweeps);
        left = facesLeft();
    }
    // What helps one face may be in the way of another's help.
    for (int round = 0; round < backRounds && !left.empty(); ++round) {
        if (stepBackFrom(left, {mesh, cellFaces, faults, front, lattice, startThickness, limits}, optimiser) == 0) break;
        left = facesLeft();
    }
    mendFlatCells(mesh, cellFaces, faults, limits, optimiser);
    isClean();
    summary.poorRemaining = poor.all;
    summary.unmended = faults.poorFaces();
    findFolded();
    noteMoved();
    return summary;
}

} // namespace i2b
