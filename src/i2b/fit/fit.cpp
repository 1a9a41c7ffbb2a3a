#include "i2b/fit/fit.h"
#include "i2b/core/parallel.h"
#include "i2b/fit/bends.h"
#include "i2b/fit/corner.h"
#include "i2b/fit/deepen.h"
#include "i2b/fit/folds.h"
#include "i2b/fit/insert.h"
#include "i2b/fit/off_wall.h"
#include "i2b/fit/store.h"
#include "i2b/fit/wall_views.h"
#include <algorithm>
#include <numeric>

namespace i2b {
namespace {

constexpr int rings = 2;             // of core points behind the front that move
constexpr double offTarget = 0.01;   // of h: a wall node farther from its target is worked on
constexpr double nearLine = 0.5;     // of h: a node with its goal so near a sharp edge is brought to the wall by the pulls, not at once,
constexpr double nearRim = 2;        // and one so near a rim, where both sides of a sheet want room around it
constexpr double unreached = 0.1;    // of h: a node farther from its feature is let go at the end
constexpr double unfinished = 0.05;  // of h: a wall node farther from its target after that goes on,
constexpr int finishingSweeps = 8;   // for so many sweeps at most
constexpr double poorEnergy = 2.6;   // phi: nodes of such corners are worked on

void grow(const Band& band, std::vector<std::uint8_t>& marked, int rings) {
    for (int ring = 0; ring < rings; ++ring) {
        const std::vector<std::uint8_t> old = marked;
        parallelFor(band.movable, [&](std::size_t n) {
            for (const BandEdge& e : band.edges[n]) {
                const auto b = static_cast<std::size_t>(e.b);
                if (b < band.movable && old[b]) marked[n] = 1;
            }
        });
    }
}

// How far a wall node is from where it should be: on the line or corner that it is snapped to, else on the surface.
double wayToGo(WallViews& views, const FeatureIndex& features, const Snap& snap, const Positions& x, std::size_t n) {
    if (snap.kind != SnapKind::none) return norm(snapLine(views.index(), features, snap, x[n], views.band().h[n]).point - x[n]);
    const WallTarget& t = views.target(n, x);
    return t.found ? norm(t.point - x[n]) : 0;
}

// Nodes off their target, snapped or in a poor corner, and those around them.
std::vector<std::uint8_t> activeNodes(WallViews& views, const FeatureIndex& features, const std::vector<Snap>& snaps, const Positions& x) {
    const Band& band = views.band();
    std::vector<std::uint8_t> active = nodesOfPoorCorners(band, x, poorEnergy);
    parallelFor(band.walls, [&](std::size_t n) {
        active[n] = active[n] || snaps[n].kind != SnapKind::none || wayToGo(views, features, snaps[n], x, n) > offTarget * band.h[n];
    });
    grow(band, active, 1);
    return active;
}

// Wall nodes at a sharp edge or a rim: the closest point says little of where they belong.
std::vector<std::uint8_t> nodesAtLines(const Band& band, const FeatureIndex& features, const Positions& x) {
    std::vector<std::uint8_t> atLine(band.walls);
    parallelFor(band.walls, [&](std::size_t n) {
        const FeatureIndex::Line line = features.closestLine(x[n], nearRim * band.h[n]);
        atLine[n] = line.found && (line.isRim || norm(line.point - x[n]) < nearLine * band.h[n]);
    });
    return atLine;
}

// Those of some wall nodes that are not where they should be, and may go on.
std::vector<std::uint32_t> unfinishedOf(WallViews& views, const FeatureIndex& features, const std::vector<Snap>& snaps, const Positions& x,
                                        const std::vector<std::uint32_t>& nodes) {
    const Band& band = views.band();
    std::vector<std::uint8_t> isOff(nodes.size(), 0);
    parallelFor(nodes.size(), [&](std::size_t i) {
        isOff[i] = wayToGo(views, features, snaps[nodes[i]], x, nodes[i]) > unfinished * band.h[nodes[i]];
    });
    std::vector<std::uint32_t> off;
    for (std::size_t i = 0; i < nodes.size(); ++i)
        if (isOff[i]) off.push_back(nodes[i]);
    return off;
}

// At lines and in narrow places nodes come a little way in a sweep: these, a few in a hundred, go on with those around them, with
// the weights of the last one. Gives whether all sweeps were within the budget.
bool finish(WallViews& views, const FeatureIndex& features, const std::vector<Snap>& snaps, Positions& x, const EnergyOptions& energy,
            const Context& context) {
    const Band& band = views.band();
    std::vector<std::uint32_t> off(band.walls);
    std::iota(off.begin(), off.end(), 0);
    for (int sweep = 0; sweep < finishingSweeps; ++sweep) {
        off = unfinishedOf(views, features, snaps, x, off);
        if (off.empty()) break;
        std::vector<std::uint8_t> around(band.movable, 0);
        for (const std::uint32_t n : off) around[n] = 1;
        grow(band, around, 1);
        if (!minimiseEnergy(views, features, snaps, around, x, energy, context)) return false;
    }
    return true;
}

std::vector<Front::Hanging> hangingPoints(const Band& band) {
    std::vector<Front::Hanging> hanging;
    const auto pointOf = [&](std::int32_t node) { return band.corePoint[static_cast<std::size_t>(node) - band.walls]; };
    for (std::size_t n = band.walls; n < band.walls + band.fronts; ++n) {
        const std::span<const std::int32_t> parents = band.parents[n]; // of the core's nodes these are of the core, too
        for (std::size_t i = 0; i + 1 < parents.size(); i += 2) {
            const std::int32_t a = pointOf(parents[i]), b = pointOf(parents[i + 1]);
            hanging.push_back({pointOf(static_cast<std::int32_t>(n)), {std::min(a, b), std::max(a, b)}});
        }
    }
    std::sort(hanging.begin(), hanging.end());
    return hanging;
}

// Lets go of nodes that could not come near the feature that they are held to: on the surface beside it they serve
// better.
void releaseUnreached(const Band& band, const SurfaceIndex& index, const FeatureIndex& features, const Positions& x, std::vector<Snap>& snaps) {
    parallelFor(band.walls, [&](std::size_t n) {
        if (snaps[n].kind == SnapKind::none || norm(snapLine(index, features, snaps[n], x[n], band.h[n]).point - x[n]) <= unreached * band.h[n]) return;
        snaps[n] = {};
    });
}

// Whether a face around node n has two other nodes that are held: n there too would make it flat.
bool hasLineBeside(const Front& front, const std::vector<Snap>& snaps, std::size_t n) {
    for (const auto face : front.mesh.vf_range(FrontMesh::VertexHandle(static_cast<int>(n)))) {
        int held = 0;
        for (const auto v : front.mesh.fv_range(face)) held += static_cast<std::size_t>(v.idx()) != n && snaps[static_cast<std::size_t>(v.idx())].kind != SnapKind::none;
        if (held >= 2) return true;
    }
    return false;
}

// Nodes that should be on a feature besides, and vertices where edges still cross one.
void seekOnce(Front& front, WallViews& views, const FeatureIndex& features, Positions& x, std::vector<Snap>& snaps, FitSummary& summary) {
    const Band& band = views.band();
    summary.wishes = snaps;
    snapToFeatures(views, front, features, x, summary.wishes);
    snapFolds(band, front, views.index(), features, x, summary.wishes);
    summary.inserted = insertVertices(front, views, features, x, snaps, summary.wishes);
    summary.wishes.resize(snaps.size());
    parallelFor(band.walls, [&](std::size_t n) {
        if (summary.wishes[n].kind != SnapKind::none || hasLineBeside(front, snaps, n)) return;
        if (const FeatureIndex::Line line = lineUpon(features, x[n], band.h[n]); line.found) summary.wishes[n] = {SnapKind::line, line.point, line.tangent};
    });
    for (std::size_t n = 0; n < band.walls; ++n) {
        if (snaps[n].kind != SnapKind::none) summary.wishes[n] = {};
    }
    for (const Front::Inserted& i : front.inserted) {
        for (std::int32_t end : i.ends) summary.wishes[static_cast<std::size_t>(end)] = {};
    }
}

// The nodes on their way to the closest points of the wall, as far as the corners stay good.
Positions projected(Band& band, const SurfaceIndex& index, const FeatureIndex& features, int sweeps, const Context& context, FitSummary& summary) {
    const Positions start = startPositions(band, index);
    const Positions goal = goalPositions(band, index, start, sweeps);
    context.checkCancelled();
    Positions x;
    const RawVector<double> alpha = blend(band, start, goal, x, {nodesAtLines(band, features, goal)});
    for (std::size_t v = 0; v < band.walls; ++v) summary.blended += alpha[v] == 1;
    return x;
}

} // namespace

FitSummary fitFront(Front& front, const LatticeMesh& mesh, const SurfaceIndex& index, const FeatureGraph& graph,
                    const FitOptions& options, const Context& context, const RoomOfWalls& room) {
    FitSummary summary;
    EnergyOptions energy;
    energy.budget = Budget(options.seconds);
    Band band = buildBand(mesh, front, rings, room.most);
    summary.wallNodes = band.walls;
    front.hanging = hangingPoints(band);
    context.checkCancelled();
    const FeatureIndex features(graph);
    Positions x = projected(band, index, features, options.sweeps, context, summary);

    WallViews views(band, index);
    std::vector<Snap> snaps(band.walls);
    std::vector<std::uint8_t> active = activeNodes(views, features, snaps, x);
    const auto pull = [&](std::vector<double> weights) {
        energy.wallWeights = std::move(weights);
        if (!minimiseEnergy(views, features, snaps, active, x, energy, context)) summary.cutShort = true;
    };
    const auto snap = [&] {
        if (!options.features || energy.budget.isOver()) return false;
        snapToFeatures(views, front, features, x, snaps);
        snapFolds(band, front, index, features, x, snaps);
        return true;
    };
    const auto snapAndSplit = [&] {
        if (!snap()) return;
        store(band, x, front);
        const std::size_t split = splitAlongFeatures(front, band, index, features, x, snaps);
        summary.split += split;
        if (split > 0) renewPrisms(band, front);
    };
    pull({10, 100});
    snap();
    active = activeNodes(views, features, snaps, x);
    pull({1e3});
    snapAndSplit();
    active = activeNodes(views, features, snaps, x);
    pull({1e5});
    snapAndSplit(); // what has come into view since
    const std::vector<std::uint8_t> late = activeNodes(views, features, snaps, x); // those worked on go on too: more room
    for (std::size_t n = 0; n < band.movable; ++n) active[n] = active[n] || late[n];
    pull({1e6});
    if (!finish(views, features, snaps, x, energy, context)) summary.cutShort = true;
    if (options.features) releaseUnreached(band, index, features, x, snaps);
    snapExactly(views, features, snaps, x, energy);
    summary.offCauses = findOffCauses(band, index, features, snaps, x, energy);
    for (const Snap& s : snaps) summary.snapped += s.kind != SnapKind::none;
    for (std::uint8_t a : active) summary.active += a;
    store(band, x, front);
    context.checkCancelled();
    if (energy.budget.isOver()) summary.cutShort = summary.cutShort || wantsDepth(room);
    else if (deepen(front, mesh, index, room)) takeStored(band, front, x);
    if (options.features) seekOnce(front, views, features, x, snaps, summary);
    if (options.features) summary.split += cutAcrossBends(front, index);
    summary.snaps = std::move(snaps);
    return summary;
}

} // namespace i2b
