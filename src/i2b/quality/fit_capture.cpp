// How much of the geometry's sharp edges the wall has captured.
#include "i2b/core/collect.h"
#include "i2b/core/quantile.h"
#include "i2b/geometry/rims.h"
#include "i2b/quality/lost_edges.h"
#include <algorithm>
#include <array>
#include <numbers>

namespace i2b {
namespace {

constexpr double rimGap = 2;             // of h: a sheet beyond whose free edge something follows so near does not end there
constexpr double beside = 0.1;           // of h: what is seen so far to both sides of an edge says whether it folds

bool isSame(const WallEdge& e, const WallEdge& f) { return e.a == f.a && e.b == f.b; }

// m, n: area vectors of two faces at an edge, m^2.
bool isCrease(const Vec3& m, const Vec3& n) { return norm2(m) > 0 && norm2(n) > 0 && degreesBetween(m, n) > creaseAngle; }

// Of the wall's edges, those where two of its faces fold by more than the crease angle: places in wall.edges.
RawVector<std::size_t> foldsOf(const Wall& wall) {
    const std::vector<WallEdge>& edges = wall.edges;
    return collect<std::size_t>(edges.size(), [&](std::size_t i, const auto& put) {
        if (i > 0 && isSame(edges[i - 1], edges[i])) return; // told with the first
        bool folds = false;
        for (std::size_t end = i; end < edges.size() && isSame(edges[i], edges[end]); ++end)
            for (std::size_t k = i; k < end; ++k)
                folds |= isCrease(wall.shapes[static_cast<std::size_t>(edges[k].face)].area, wall.shapes[static_cast<std::size_t>(edges[end].face)].area);
        if (folds) put(i);
    }, 1024);
}

// The same of those where the wall ends at faces of the boundary that are none of it, as at a side of the domain: what stands on the
// ground has sharp edges there.
RawVector<std::size_t> foldsAtEnds(const PolyMesh& mesh, const Wall& wall) {
    const std::vector<WallEdge>& edges = wall.edges;
    const RawVector<std::size_t> ends = collect<std::size_t>(edges.size(), [&](std::size_t i, const auto& put) {
        if ((i == 0 || !isSame(edges[i - 1], edges[i])) && (i + 1 == edges.size() || !isSame(edges[i], edges[i + 1]))) put(i);
    }, 1024);
    if (ends.empty()) return {};
    const auto boundary = static_cast<std::size_t>(mesh.faces() - mesh.internalFaces());
    return collect<std::size_t>(boundary, [&](std::size_t i, const auto& put) {
        const std::int32_t f = mesh.internalFaces() + static_cast<std::int32_t>(i);
        if (std::binary_search(wall.faces.begin(), wall.faces.end(), f)) return;
        const auto face = mesh.face(f);
        for (std::size_t k = 0; k < face.size(); ++k) {
            const auto [a, b] = std::minmax(face[k], face[(k + 1) % face.size()]);
            const auto at = std::lower_bound(ends.begin(), ends.end(), WallEdge{a, b, -1}, [&](std::size_t end, const WallEdge& e) { return edges[end] < e; });
            if (at == ends.end() || edges[*at].a != a || edges[*at].b != b) continue;
            if (isCrease(wall.shapes[static_cast<std::size_t>(edges[*at].face)].area, measureFace(mesh, f).area)) put(*at);
        }
    }, 1024);
}

Surface creaseSurface(const PolyMesh& mesh, const Wall& wall) {
    Surface s;
    for (const RawVector<std::size_t>& folds : {foldsOf(wall), foldsAtEnds(mesh, wall)})
        for (const std::size_t i : folds)
            addSegment(s, mesh.points[static_cast<std::size_t>(wall.edges[i].a)], mesh.points[static_cast<std::size_t>(wall.edges[i].b)]);
    return s;
}

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

Surface sharpSurface(const FeatureGraph& features, const Wall& wall, const SurfaceIndex& index) {
    std::vector<std::uint8_t> rims(features.edges.size(), 0);
    if (features.rimEdges > 0) {
        std::vector<double> sizes = wall.faceH;
        rims = findRims(features, index, {}, rimGap * median(sizes));
    }
    Surface s;
    for (std::size_t i = 0; i < rims.size(); ++i) {
        const FeatureEdge& e = features.edges[i];
        const bool isCrease = (e.kinds & bitOf(EdgeKind::crease)) != 0; // may fold by 40 degrees to the last bit
        if ((e.angle >= sharpAngle && !isCrease) || rims[i]) addSegment(s, features.points[e.a], features.points[e.b]);
    }
    return s;
}

void measureCapture(const PolyMesh& mesh, const Wall& wall, const SurfaceIndex& index, const Surface& sharpEdges, const SurfaceIndex& sharp,
                    FitReport& report) {
    const Surface creases = creaseSurface(mesh, wall);
    const SurfaceIndex creaseIndex(creases);
    // An edge that ends inside another part is none that a wall could have, nor is one where the geometry goes straight on.
    const auto isReached = [&](const Vec3& p, std::uint32_t line, const WallPlace& at) {
        const auto& t = sharpEdges.triangles[line];
        const Vec3 tangent = normalized(sharpEdges.points[t[1]] - sharpEdges.points[t[0]]);
        const std::optional<Vec3> flow = flowThatSees(wall, index, at, p);
        return flow && foldsUnder(index, *flow, p, tangent, at.h);
    };
    const LineSamples n = captureLines(
        mesh, wall, sharpEdges, sharp, isReached,
        [&](const Vec3& p, std::uint32_t, const WallPlace& at) { return bool(creaseIndex.closest(p, 0.1 * at.h)); });
    report.featureSamples = n.samples;
    report.featureCaptureFraction = n.captured();
    std::vector<LostCause> causes(n.lost.size());
    parallelFor(causes.size(), [&](std::size_t i) { causes[i] = causeOf(n.lost[i], mesh, wall, sharpEdges); }, 64);
    report.lostEdges = gatherLostEdges(n.lost, causes, index);
}

} // namespace i2b
