#include "i2b/fit/fit.h"
#include "i2b/core/parallel.h"
#include "i2b/fit/corner.h"

namespace i2b {
namespace {

constexpr int rings = 2;             // of core points behind the front that move
constexpr double offTarget = 0.005;  // of h: a wall node farther from its target is worked on
constexpr double poorEnergy = 2.2;   // phi: nodes of such corners are worked on

// Nodes off their target or in a poor corner, and two rings around them.
std::vector<std::uint8_t> activeNodes(const Band& band, const SurfaceIndex& index, const std::vector<Vec3>& x) {
    std::vector<std::uint8_t> active(band.movable, 0);
    parallelFor(band.movable, [&](std::size_t n) {
        for (std::int32_t c : band.cornersOf[n]) {
            if (cornerEnergy(band.corners[static_cast<std::size_t>(c)], x) > poorEnergy) active[n] = 1;
        }
        if (n < band.walls && !active[n]) {
            const WallTarget t = wallTarget(index, band, n, x[static_cast<std::size_t>(band.frontNode[n])], x[n]);
            active[n] = t.found && norm(t.point - x[n]) > offTarget * band.h[n];
        }
    });
    for (int ring = 0; ring < 2; ++ring) {
        const std::vector<std::uint8_t> old = active;
        parallelFor(band.movable, [&](std::size_t n) {
            for (const BandEdge& e : band.edges[n]) {
                const auto b = static_cast<std::size_t>(e.b);
                if (b < band.movable && old[b]) active[n] = 1;
            }
        });
    }
    return active;
}

void store(const Band& band, const std::vector<Vec3>& x, Front& front) {
    for (std::size_t v = 0; v < band.walls; ++v) {
        front.mesh.set_point(FrontMesh::VertexHandle(static_cast<int>(v)), {x[v].x, x[v].y, x[v].z});
        front.front[v] = x[static_cast<std::size_t>(band.frontNode[v])];
    }
    front.movedPoints.clear();
    front.movedTo.clear();
    for (std::size_t n = band.walls + band.fronts; n < band.movable; ++n) {
        if (x[n] == band.start[n]) continue;
        front.movedPoints.push_back(band.corePoint[n - band.walls]);
        front.movedTo.push_back(x[n]);
    }
}

} // namespace

FitSummary fitFront(Front& front, const LatticeMesh& mesh, const SurfaceIndex& index, const FeatureGraph&,
                    const FitOptions& options, const Context& context) {
    FitSummary summary;
    const Band band = buildBand(mesh, front, rings);
    summary.wallNodes = band.walls;
    context.checkCancelled();
    const std::vector<Vec3> goal = goalPositions(band, index, options.sweeps);
    context.checkCancelled();
    std::vector<Vec3> x;
    const std::vector<double> alpha = blend(band, goal, x);
    for (std::size_t v = 0; v < band.walls; ++v) summary.blended += alpha[v] == 1;
    const std::vector<std::uint8_t> active = activeNodes(band, index, x);
    for (std::uint8_t a : active) summary.active += a;
    const EnergyOptions energy;
    minimiseEnergy(band, index, active, x, energy, context);
    snapExactly(band, index, x, energy.floor);
    store(band, x, front);
    return summary;
}

} // namespace i2b
