// How much of the geometry's sharp edges the wall has captured.
#include "i2b/core/parallel.h"
#include "i2b/core/quantile.h"
#include "i2b/geometry/rims.h"
#include "i2b/quality/lost_edges.h"
#include "i2b/quality/sharp_samples.h"
#include "i2b/quality/wall_folds.h"
#include <algorithm>
#include <array>
#include <numbers>

namespace i2b {
namespace {

constexpr double rimGap = 2;             // of h: a sheet beyond whose free edge something follows so near does not end there
constexpr double beside = 0.1;           // of h: what is seen so far to both sides of an edge says whether it folds

// Does the geometry fold at an edge by more than a crease of the wall, as one sees it from the flow? Not where parts lie flush, or another
// one stands at its far side: from straight above, a little aside, it is seen to go on.
bool foldsUnder(const SurfaceIndex& index, const Vec3& flow, const Vec3& p, const Vec3& tangent, double h) {
    const Vec3 way = flow - p, up = way - tangent * dot(way, tangent), above = p + up, aside = cross(tangent, normalized(up)) * (beside * h);
    if (index.firstHit(flow, above)) return true;
    std::array<Vec3, 2> seen;
    for (const std::size_t side : {0u, 1u}) {
        const Vec3 ray = (p + aside * (side == 0 ? 1.0 : -1.0) - above) * 2;
        const SegmentHit hit = index.firstHit(above, above + ray);
        if (!hit) return true;
        seen[side] = above + ray * hit.t - p;
    }
    return 180 - degreesBetween(seen[0], seen[1]) > creaseAngle;
}

} // namespace

double degreesBetween(const Vec3& a, const Vec3& b) {
    return std::atan2(norm(cross(a, b)), dot(a, b)) * (180 / std::numbers::pi);
}

double sizeOfMost(const Wall& wall) {
    std::vector<double> sizes = wall.faceH;
    return median(sizes);
}

Surface sharpSurface(const FeatureGraph& features, double h, const SurfaceIndex& index) {
    std::vector<std::uint8_t> rims(features.edges.size(), 0);
    if (features.rimEdges > 0) rims = findRims(features, index, {}, rimGap * h);
    Surface s;
    for (std::size_t i = 0; i < rims.size(); ++i) {
        const FeatureEdge& e = features.edges[i];
        const bool isCrease = (e.kinds & bitOf(EdgeKind::crease)) != 0; // may fold by 40 degrees to the last bit
        if ((e.angle >= sharpAngle && !isCrease) || rims[i]) addSegment(s, features.points[e.a], features.points[e.b]);
    }
    return s;
}

LineAsk sharpThatCount(const Wall& wall, const SurfaceIndex& index, const Surface& sharpEdges) {
    return [&](const Vec3& p, std::uint32_t line, const WallPlace& at) {
        const auto& t = sharpEdges.triangles[line];
        const Vec3 tangent = normalized(sharpEdges.points[t[1]] - sharpEdges.points[t[0]]);
        const std::optional<Vec3> flow = flowThatSees(wall, index, at, p);
        return flow && foldsUnder(index, *flow, p, tangent, at.h);
    };
}

void measureCapture(const PolyMesh& mesh, const Wall& wall, const SurfaceIndex& index, const Surface& sharpEdges, const SurfaceIndex& sharp,
                    FitReport& report) {
    const Surface creases = creaseSurface(mesh, wall, endsOf(mesh, wall));
    const SurfaceIndex creaseIndex(creases);
    const LineSamples n = captureLines(
        mesh, wall, sharpEdges, sharp, sharpThatCount(wall, index, sharpEdges),
        [&](const Vec3& p, std::uint32_t, const WallPlace& at) { return bool(creaseIndex.closest(p, capturedWithin * at.h)); });
    report.featureSamples = n.samples;
    report.featureCaptureFraction = n.captured();
    std::vector<LostCause> causes(n.lost.size());
    parallelFor(causes.size(), [&](std::size_t i) { causes[i] = causeOf(n.lost[i], mesh, wall, sharpEdges); }, 64);
    report.lostEdges = gatherLostEdges(n.lost, causes, index);
}

} // namespace i2b
