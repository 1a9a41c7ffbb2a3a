#include "i2b/program/generate.h"
#include "i2b/carve/carve.h"
#include "i2b/carve/flow_lookup.h"
#include "i2b/core/checksum.h"
#include "i2b/core/error.h"
#include "i2b/core/give_up.h"
#include "i2b/core/memory.h"
#include "i2b/core/parallel.h"
#include "i2b/edit/last_moves.h"
#include "i2b/edit/last_resort.h"
#include "i2b/geometry/features.h"
#include "i2b/geometry/rims.h"
#include "i2b/grid/build.h"
#include "i2b/grid/cut.h"
#include "i2b/grid/leaf_cell.h"
#include "i2b/paint/leaks.h"
#include "i2b/paint/paint.h"
#include "i2b/paint/touched_parts.h"
#include "i2b/program/mesh_limits.h"
#include "i2b/program/run_stage.h"
#include "i2b/program/walls.h"
#include "i2b/rims/close_rims.h"
#include "i2b/sizing/automatic.h"
#include "i2b/sizing/estimate.h"
#include <fmt/format.h>
#include <tbb/task_group.h>

namespace i2b {
namespace {

constexpr double usualRoom = 0.45; // of a cell, between front and wall

void refuseTooLarge(const Surface& surface, const SizeField& field, int layers, bool gridOnly) {
    const double need = estimateBytes(surface, field, layers, gridOnly);
    const auto have = static_cast<double>(availableBytes());
    if (need <= have) return;
    throw Error(ErrorKind::input, fmt::format("this mesh would need about {:.1f} GB of memory", need * 1e-9),
                fmt::format("{:.1f} GB are free", have * 1e-9),
                "give a larger --size, a smaller --box, or run it on a larger machine");
}

CellGrid gridOf(const Surface& surface, const SizeField& field, CutCells& cut) {
    const std::vector<CellLevel> atTarget = cutAtTargetLevels(surface, field);
    CellGrid grid = buildCellGrid(field, wantedCells(field, atTarget));
    cut = cutLeafCells(surface, field, grid, atTarget);
    return grid;
}

Regions regionsOf(const SurfaceIndex& index, const SizeField& field, const CellGrid& grid, const CutCells& cut, const DomainOptions& domain) {
    Regions regions = labelRegions(grid, cut);
    findTouchedParts(regions, index.surface(), field, grid, cut);
    chooseRegions(regions, grid, index, domain);
    return regions;
}

// Which gaps the flow comes to shows where all of them have cells small enough to enter: a grid that is painted and
// carved for that alone.
void addGapsInFlow(SizeField& field, const Surface& surface, const SurfaceIndex& index, const Options& options, const Context& context) {
    const std::vector<Gap> gaps = findGaps(field, index, options.size);
    if (gaps.empty()) return;
    SizeField everywhere = field;
    addGaps(everywhere, gaps, options.size);
    refuseTooLarge(surface, everywhere, 0, true);
    CutCells cut;
    const CellGrid grid = gridOf(surface, everywhere, cut);
    context.checkCancelled();
    const KeptCells kept = carve(grid, cut, regionsOf(index, everywhere, grid, cut, options.domain), index, options.fit);
    context.checkCancelled();
    const FlowLookup flow(grid, kept, index);
    std::vector<std::uint8_t> reached(gaps.size());
    parallelFor(gaps.size(), [&](std::size_t i) { reached[i] = flow.reaches(gaps[i].middle()); });
    std::vector<Gap> inFlow;
    for (std::size_t i = 0; i < gaps.size(); ++i) {
        if (reached[i]) inFlow.push_back(gaps[i]);
    }
    addGaps(field, inFlow, options.size);
}

// One note, however many parts.
void noteLeftOut(const std::vector<Region>& parts, std::vector<std::string>& notes) {
    if (parts.empty()) return;
    std::uint64_t cells = 0;
    for (const Region& part : parts) cells += part.cells;
    const Region& largest = *std::ranges::max_element(parts, {}, &Region::cells);
    notes.push_back(fmt::format("left out behind openings too narrow for cells: {} cells in {} place{}, the largest at ({:g} {:g} {:g}): give a smaller --size there to mesh them",
                                cells, parts.size(), parts.size() > 1 ? "s" : "", largest.seed.x, largest.seed.y, largest.seed.z));
}

// Refuses a mesh with cells where the flow must not come. Paint may come there where cells do not: through an opening no wider than one.
void refuseWhereKeptOut(const GridResult& r, std::vector<std::string>& notes) {
    const std::vector<Leak>& leaks = r.regions.leaks;
    for (auto first = leaks.begin(), next = first; first != leaks.end(); first = next) {
        next = std::find_if(first, leaks.end(), [&](const Leak& l) { return l.pair != first->pair; });
        if (!first->keepOut) continue;
        std::string opening;
        if (first->area > 0)
            opening = fmt::format("the widest of {} opening{}, {:.3g} m wide, at ({:.6g} {:.6g} {:.6g})", next - first, next - first > 1 ? "s" : "",
                                  first->width, first->place.x, first->place.y, first->place.z);
        const LeafCell beyond = *leafCellAt(r.grid, first->beyond); // the centre of one
        if (r.kept.levels[beyond.level]->isValueOn(toCoord(beyond.at)))
            throw Error(ErrorKind::input, first->text, opening,
                        first->area > 0 ? "close it, or give cells larger than it there; i2b regions lists all openings" : "give another place to keep out of");
        notes.push_back(fmt::format("{}, but cells do not: {}", first->text, opening));
    }
}

// places: ascending.
template <class T>
void dropPlaces(std::vector<T>& values, const std::vector<std::int32_t>& places) {
    if (values.empty() || places.empty()) return;
    std::size_t to = 0, next = 0;
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (next < places.size() && static_cast<std::size_t>(places[next]) == i) ++next;
        else values[to++] = values[i];
    }
    values.resize(to);
}

// Figures of the mesh as it is, and its checksum.
void measure(MeshResult& out, const DictionaryLimits& limits, bool keepCells, Context& context) {
    Checksum sum;
    const LoopFence fence;
    tbb::task_group beside; // one thread's work
    beside.run([&] {
        fence.enter();
        sum.add(out.mesh.checksum());
        fence.leave();
    });
    out.cells.wantsQuality = keepCells;
    out.report.quality = stage(
        context, "quality", [&] { return measureQuality(out.mesh, {}, limits, &out.cells); },
        [](const QualityReport& q) { return q.cells; });
    beside.wait();
    fence.join();
    out.report.checksum = sum.hex();
}

// Changes of cells may leave a few faces beyond the limits, or make them so: points around these move. Gives how many that helped.
std::int64_t moveAfterChanges(MeshResult& out, const DictionaryLimits& limits, Context& context) {
    const QualityReport& q = *out.report.quality;
    if (q.dictionaryFaces == 0 || q.dictionaryFaces > static_cast<std::int64_t>(q.dictionaryIds.size())) return 0;
    return stage(
        context, "last moves", [&] { return moveLastPoints(out.mesh, out.cells.faces, q.dictionaryIds, limits); }, [](std::int64_t helped) { return helped; });
}

// The mesh beside the geometry, and what there is of it.
void judge(MeshResult& out, const FeatureGraph& features, const FitSummary& fitted, const RepairSummary& repaired, bool keepCells, Context& context) {
    const SurfaceIndex& index = *out.cartesian->index;
    out.report.fit = stage(
        context, "fit quality",
        [&] {
            const FitReport fit = measureFit(out.mesh, out.cells.faces, index, features, {}, &out.wallNodes);
            // Wall points follow each other as the vertices of the front do.
            out.offCauses = settleCauses(out.wallNodes, fitted.offCauses, repaired.movedWalls);
            out.report.offGeometry = listOffPlaces(out.mesh, out.wallNodes, out.offCauses, index);
            return fit;
        },
        [](const FitReport& f) { return f.wallNodes; });
    if (!keepCells) out.cells = {};
    out.report.stages = context.stages();
    out.report.cells = out.mesh.cells;
    out.report.faces = out.mesh.faces();
    out.report.points = static_cast<std::int64_t>(out.mesh.points.size());
    out.report.patches = out.mesh.patches;
}

} // namespace

std::unique_ptr<GridResult> generateGrid(const Options& options, Context& context, Road road) {
    auto out = std::make_unique<GridResult>();
    GridResult& r = *out;
    r.surface = stage(
        context, "read",
        [&] {
            const GeometryOptions& g = options.geometry;
            r.featureLines = readFeatureLines(g.featureLines, g.scale, r.notes.messages);
            return readSurface(g.files, g.scale, r.notes);
        },
        [](const Surface& s) { return s.triangles.size(); });
    r.index = stage(
        context, "index", [&] { return std::make_unique<SurfaceIndex>(r.surface); },
        [&](const auto&) { return r.surface.triangles.size(); });
    r.field = stage(
        context, "size", [&] { return makeSizeField(r.surface, options.size, options.domain, r.index.get()); },
        [](const SizeField& f) { return f.lattice.maxLevel + 1; });
    const LayerPlan plan = planOf(requestOf(options.layers), options.layers.unit);
    const int layerCells = wantedCells(plan, usualRoom * options.size.surface, options.size.surface); // with those over them
    refuseTooLarge(r.surface, r.field, layerCells, road != Road::mesh);
    if (options.size.curvature > 0 || options.size.gapCells > 0) {
        Stage timed(context, "automatic sizes");
        if (options.size.curvature > 0) addCurvature(r.field, r.surface, options.size, options.geometry.featureAngle);
        if (options.size.gapCells > 0) addGapsInFlow(r.field, r.surface, *r.index, options, context);
        timed.items = r.surface.triangles.size();
        refuseTooLarge(r.surface, r.field, layerCells, road != Road::mesh);
    }
    r.grid = stage(
        context, "grid", [&] { return gridOf(r.surface, r.field, r.cut); }, [](const CellGrid& g) { return g.cellCount(); });
    r.regions = stage(
        context, "paint", [&] { return regionsOf(*r.index, r.field, r.grid, r.cut, options.domain); },
        [](const Regions& regions) { return regions.table.size(); });
    if (!options.domain.keepOut.empty() || options.domain.seeds.size() > 1)
        r.regions.leaks = stage(
            context, "leaks", [&] { return findLeaks(r.regions, r.grid, *r.index, options.domain); },
            [](const std::vector<Leak>& leaks) { return leaks.size(); });
    if (road == Road::regions) return out;
    r.kept = stage(
        context, "carve", [&] { return carve(r.grid, r.cut, r.regions, *r.index, options.fit); },
        [](const KeptCells& k) { return k.cellCount(); });
    refuseWhereKeptOut(r, r.notes.messages);
    noteLeftOut(r.kept.leftOut, r.notes.messages);
    return out;
}

MeshResult generate(const Options& options, Context& context) {
    MeshResult out;
    out.cartesian = generateGrid(options, context, Road::mesh);
    const GridResult& c = *out.cartesian;
    auto lattice = std::make_unique<LatticeMesh>(c.grid, c.kept);
    const FeatureGraph features = stage(
        context, "features",
        [&] {
            const FeatureOptions f = featureOptions(options.geometry, c.featureLines);
            FeatureGraph graph = buildFeatureGraph(c.surface, f);
            // A wall that comes as near to a rim leaves no row of uncut cells for a mesh to wrap round it.
            markRims(graph, *c.index, f, 2 * options.size.surface);
            return graph;
        },
        [](const FeatureGraph& f) { return f.edges.size(); });
    std::vector<std::string>& notes = out.cartesian->notes.messages;
    notes.insert(notes.end(), features.notes.begin(), features.notes.end());
    const WallPlans plans = plansOf(options.layers, c.surface.parts);
    notes.insert(notes.end(), plans.notes.begin(), plans.notes.end());
    const DictionaryLimits limits = meshLimits(options.quality, c.field.minSize, plans.plans);
    if (limits.pyramidVolume != options.quality.pyramidVolume)
        notes.push_back(fmt::format("the limit of min-pyramid-volume, {:g} m3, is for larger cells than these: {:.2g} m3 is taken", options.quality.pyramidVolume, limits.pyramidVolume));
    const DictionaryLimits fallback = meshLimits({}, c.field.minSize, plans.plans);
    Walls walls = makeWalls({c, *lattice, features, plans, options.fit, limits, fallback}, out.mesh, context);
    const DictionaryLimits& reached = walls.reach.limits;
    notes.insert(notes.end(), walls.reach.givenUp.begin(), walls.reach.givenUp.end());
    const std::int32_t thinFrom = walls.laid.stack.areFlat() ? static_cast<std::int32_t>(lattice->cellCount()) : out.mesh.cells;
    std::int64_t lastMoves = 0;
    const LastResort changed = stage(
        context, "last resort",
        [&] {
            const Rows& cellFaces = walls.repaired.cellFaces;
            lastMoves = moveLastPoints(out.mesh, cellFaces, facesBeyondHelp(out.mesh, cellFaces, walls.repaired.unmended, reached, thinFrom), reached);
            return changePoorPlaces(out.mesh, std::move(walls.repaired.cellFaces), walls.repaired.unmended, reached, thinFrom);
        },
        [&](const LastResort& l) { return l.changes.merged + l.changes.divided + lastMoves; });
    auto firstLayerCell = static_cast<std::int32_t>(lattice->cellCount());
    if (!changed.cellOf.empty()) firstLayerCell = 1 + *std::max_element(changed.cellOf.begin(), changed.cellOf.begin() + firstLayerCell);
    const ClosedRims rims = stage(
        context, "rims", [&] { return closeRims(out.mesh, walls.front, features, *c.index, reached, firstLayerCell); },
        [](const ClosedRims& r) { return static_cast<std::int64_t>(r.lostNodes.size()) + r.moved; });
    dropPlaces(walls.fitted.offCauses, rims.lostNodes), dropPlaces(walls.repaired.movedWalls, rims.lostNodes);
    out.report = reportOf(c, options, context);
    out.report.fitCutShort = walls.fitted.cutShort;
    out.report.changes = changed.changes;
    out.report.changes.joined = static_cast<std::int64_t>(rims.lostNodes.size());
    out.walls = measureLayers(walls.front, walls.laid.stack);
    settleCells(out.walls, walls.laid.stack, static_cast<std::int32_t>(lattice->cellCount()), changed.cellOf, changed.morePieces);
    dropFaces(out.walls, rims.lostFaces);
    renumber(out.walls, rims.cellOf);
    out.report.layers = summarize(out.walls, walls.front, c.surface.parts, options.layers.count);
    giveUp(out.walls.askedFirst, out.walls.askedThickness); // the report has them
    sortByCell(out.walls);
    for (const Patch& patch : out.mesh.patches)
        if (patch.type == "wall") out.report.wallFaces += patch.count;
    walls.front = {}, walls.laid = {}; // from here on the mesh speaks for itself
    lattice.reset();
    const bool keepCells = options.output.wants("vtu");
    measure(out, limits, keepCells, context);
    if (moveAfterChanges(out, limits, context) > 0) measure(out, limits, keepCells, context);
    judge(out, features, walls.fitted, walls.repaired, keepCells, context);
    return out;
}

std::vector<std::string> GridResult::allNotes() const {
    std::vector<std::string> all = notes.messages;
    all.insert(all.end(), field.notes.begin(), field.notes.end());
    return all;
}

RunReport reportOf(const GridResult& r, const Options& options, const Context& context) {
    RunReport report;
    report.files = options.geometry.files;
    report.triangles = r.surface.triangles.size();
    for (const Part& part : r.surface.parts) report.parts.push_back({part.name, part.triangles});
    report.surfaceSize = options.size.surface;
    report.minSize = r.field.minSize;
    report.maxSize = r.field.lattice.h(0);
    report.levels = r.field.lattice.maxLevel;
    report.stages = context.stages();
    report.cells = static_cast<std::int64_t>(r.grid.cellCount());
    report.regions = r.regions.table;
    report.leaks = r.regions.leaks;
    report.notes = r.allNotes();
    return report;
}

} // namespace i2b
