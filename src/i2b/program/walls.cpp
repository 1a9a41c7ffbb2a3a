#include "i2b/program/walls.h"
#include "i2b/assemble/assemble.h"
#include "i2b/core/error.h"
#include "i2b/program/run_stage.h"
#include <algorithm>
#include <fmt/format.h>

namespace i2b {
namespace {

constexpr int mostCuts = 4;   // rounds of cutting walls under cells that cannot be made valid,
constexpr int foldedCuts = 2; // or under thin ones with a face that does not divide:
constexpr std::size_t fewFolded = 1000;  // of so few again, it is cheaper to move nodes off the wall
constexpr std::size_t mostFolded = 2000; // or so many
constexpr double mostFoldedShare = 0.01; // of all layer cells: where more are, their height asks for it
constexpr int mostTries = 3;  // further ones, without cuts of the fit around such cells
constexpr int wrongRings = 3; // of cells around them

void requireValid(const std::string& fault, const char* what) {
    if (!fault.empty())
        throw Error(ErrorKind::internal, fmt::format("{}: {}", what, fault), "", "please report the case");
}

// Assembles and repairs; where layer cells cannot be made valid, or some of their faces do not divide, the wall under them is cut
// and all is done again.
RepairSummary assembleAndRepair(const WallInput& in, Walls& walls, PolyMesh& mesh, Context& context) {
    const GridResult& c = in.cartesian;
    LayerStack& layers = walls.laid.stack;
    const FeatureIndex lines(in.features, Creases::leftOut);
    const bool seeksEdges = in.fit.features && !walls.fitted.cutShort;
    const WallGuide guide{*c.index, lines, walls.fitted.snaps, walls.fitted.wishes, seeksEdges ? &in.features : nullptr};
    const AssembleInput parts{in.lattice, c.kept, walls.front, layers, c.surface.parts};
    mesh = stage(
        context, "assemble", [&] { return assemble(parts); }, [](const PolyMesh& m) { return m.cells; });
    return stage(
        context, "repair",
        [&] {
            walls.reach = limitsInReach(mesh, in.limits, in.fallback);
            const std::size_t most = std::max(mostFolded, static_cast<std::size_t>(mostFoldedShare * static_cast<double>(layers.cells())));
            const auto repaired = [&](std::size_t mostToCut) {
                return repair(mesh, walls.front, in.lattice, layers, startThickness, guide, walls.reach.limits, mostToCut);
            };
            const auto core = static_cast<std::int32_t>(in.lattice.cellCount());
            RepairSummary r = repaired(most);
            const auto isFolded = [&] { return !r.foldedCells.empty() && r.foldedCells.size() <= most; };
            for (int round = 0; (r.remaining > 0 || isFolded()) && round < mostCuts; ++round) {
                const bool wasWrong = r.remaining > 0;
                const std::vector<std::uint8_t> moved = std::move(r.movedWalls);
                const bool isCut = cutUnderWrong(walls.front, layers, in.plans, *c.index, core, wasWrong ? r.wrongCells : r.foldedCells);
                if (isCut) mesh = assemble(parts);
                else if (wasWrong) break;
                const bool again = isCut && (wasWrong ? round + 1 < mostCuts : round + 1 < foldedCuts && r.foldedCells.size() > fewFolded);
                r = repaired(again ? most : 0);
                for (std::size_t v = 0; v < moved.size(); ++v) r.movedWalls[v] |= moved[v];
                if (!again && r.remaining == 0) break;
            }
            return r;
        },
        [](const RepairSummary& r) { return r.retracted; });
}

// wholeOwners: core cells, ascending, whose faces are not cut.
Walls tryWalls(const WallInput& in, std::vector<std::int32_t> wholeOwners, PolyMesh& mesh, Context& context) {
    const SurfaceIndex& index = *in.cartesian.index;
    Walls walls;
    walls.front = stage(
        context, "front", [&] { return buildFront(in.lattice, startThickness); },
        [](const Front& f) { return f.ownerCell.size(); });
    requireValid(walls.front.validate(), "front");
    walls.front.whole = std::move(wholeOwners);
    walls.fitted = stage(
        context, "fit",
        [&] { return fitFront(walls.front, in.lattice, index, in.features, in.fit, context, roomWanted(in.plans)); },
        [](const FitSummary& s) { return s.wallNodes; });
    assignParts(walls.front, index);
    walls.laid = stage(
        context, "layers", [&] { return layOn(walls.front, in.plans, index); }, [](const LaidLayers& l) { return l.stack.cells(); });
    walls.repaired = assembleAndRepair(in, walls, mesh, context);
    const std::vector<std::uint8_t>& laid = walls.laid.movedWalls;
    for (std::size_t v = 0; v < laid.size() && v < walls.repaired.movedWalls.size(); ++v) walls.repaired.movedWalls[v] |= laid[v];
    return walls;
}

// Core cells at or near the wrong cells, with those of before: ascending.
std::vector<std::int32_t> ownersAround(const PolyMesh& mesh, const Walls& walls, std::int32_t core) {
    std::vector<std::uint8_t> wrong(static_cast<std::size_t>(mesh.cells), 0);
    for (const std::int32_t cell : walls.repaired.wrongCells) wrong[static_cast<std::size_t>(cell)] = 1;
    for (int ring = 0; ring < wrongRings; ++ring) {
        const std::vector<std::uint8_t> old = wrong;
        for (std::size_t f = 0; f < static_cast<std::size_t>(mesh.internalFaces()); ++f) {
            const auto a = static_cast<std::size_t>(mesh.owner[f]), b = static_cast<std::size_t>(mesh.neighbour[f]);
            if (old[a] || old[b]) wrong[a] = wrong[b] = 1;
        }
    }
    std::vector<std::int32_t> owners = walls.front.whole;
    for (std::int32_t cell = 0; cell < mesh.cells; ++cell) {
        if (!wrong[static_cast<std::size_t>(cell)]) continue;
        owners.push_back(cell < core ? cell : walls.front.ownerCell[walls.laid.stack.faceOfCell(static_cast<std::size_t>(cell - core))]);
    }
    std::sort(owners.begin(), owners.end());
    owners.erase(std::unique(owners.begin(), owners.end()), owners.end());
    return owners;
}

} // namespace

Walls makeWalls(const WallInput& in, PolyMesh& mesh, Context& context) {
    const auto core = static_cast<std::int32_t>(in.lattice.cellCount());
    Walls walls = tryWalls(in, {}, mesh, context);
    for (int again = 1; walls.repaired.remaining > 0 && again <= mostTries; ++again) {
        std::vector<std::int32_t> whole = again < mostTries ? ownersAround(mesh, walls, core) : walls.front.ownerCell;
        walls = tryWalls(in, std::move(whole), mesh, context);
    }
    if (walls.repaired.remaining > 0)
        throw Error(ErrorKind::internal, fmt::format("{} cells could not be made valid", walls.repaired.remaining), "", "please report the case");
    return walls;
}

} // namespace i2b
