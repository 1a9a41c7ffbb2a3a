// How much of the geometry's sharp edges the wall has captured.
#include "i2b/quality/line_capture.h"
#include <algorithm>
#include <array>
#include <numbers>

namespace i2b {
namespace {

constexpr std::array overWall{0.3, 1.0}; // of h: an edge seen from neither height over the wall is hidden,
constexpr double hiddenBy = 0.05;        // of h: if it lies so far behind what is seen

// Edges of the wall where two of its faces fold by more than the crease angle.
Surface creaseSurface(const PolyMesh& mesh, const Wall& wall) {
    Surface s;
    for (std::size_t i = 0, end = 0; i < wall.edges.size(); i = end) {
        const WallEdge& e = wall.edges[i];
        bool folded = false;
        for (end = i; end < wall.edges.size() && wall.edges[end].a == e.a && wall.edges[end].b == e.b; ++end)
            for (std::size_t k = i; k < end; ++k) {
                const Vec3& m = wall.shapes[static_cast<std::size_t>(wall.edges[k].face)].area;
                const Vec3& n = wall.shapes[static_cast<std::size_t>(wall.edges[end].face)].area;
                folded |= norm2(m) > 0 && norm2(n) > 0 && degreesBetween(m, n) > creaseAngle;
            }
        if (folded)
            addSegment(s, mesh.points[static_cast<std::size_t>(e.a)],
                       mesh.points[static_cast<std::size_t>(e.b)]);
    }
    return s;
}

} // namespace

double degreesBetween(const Vec3& a, const Vec3& b) {
    return std::atan2(norm(cross(a, b)), dot(a, b)) * (180 / std::numbers::pi);
}

Surface sharpSurface(const FeatureGraph& features) {
    Surface s;
    for (const FeatureEdge& e : features.edges)
        if (e.angle >= sharpAngle) addSegment(s, features.points[e.a], features.points[e.b]);
    return s;
}

void measureCapture(const PolyMesh& mesh, const Wall& wall, const SurfaceIndex& index, const Surface& sharpEdges, const SurfaceIndex& sharp,
                    FitReport& report) {
    const Surface creases = creaseSurface(mesh, wall);
    const SurfaceIndex creaseIndex(creases);
    // An edge that ends inside another part is none that a wall could have.
    const auto isReached = [&](const Vec3& p, std::uint32_t, const WallPlace& at) {
        return std::any_of(overWall.begin(), overWall.end(), [&](double height) { return isSeenFrom(index, flowOver(wall, at, height * at.h), p, hiddenBy * at.h); });
    };
    const LineSamples n = captureLines(
        mesh, wall, sharpEdges, sharp, isReached,
        [&](const Vec3& p, std::uint32_t, const WallPlace& at) { return bool(creaseIndex.closest(p, 0.1 * at.h)); });
    report.featureSamples = n.samples;
    if (n.samples > 0) report.featureCaptureFraction = static_cast<double>(n.captured) / static_cast<double>(n.samples);
}

} // namespace i2b
