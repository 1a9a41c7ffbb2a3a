// How much of the lines at which the geometry folds little or not at all the wall has an edge along.
#include "i2b/core/collect.h"
#include "i2b/quality/line_capture.h"
#include <numbers>

namespace i2b {
namespace {

constexpr double overGeometry = 0.05;    // of h: a line drawn farther off the geometry is none of the wall's
constexpr double near = 0.1;             // of h: an edge of the wall so near to a line is the line's,
const double along = std::cos(30 * std::numbers::pi / 180); // if it turns from it by no more

struct Lines { // of a feature graph
    Surface segments;
    std::vector<std::uint8_t> isFaint;
    bool anyFaint = false;
};

Lines linesOf(const FeatureGraph& features) {
    Lines lines;
    for (const FeatureEdge& e : features.edges) {
        if (!(e.kinds & lineKinds)) continue;
        const bool isFaint = !(e.kinds & bitOf(EdgeKind::rim)) && double(e.angle) < sharpAngle;
        addSegment(lines.segments, features.points[e.a], features.points[e.b]);
        lines.isFaint.push_back(isFaint);
        lines.anyFaint = lines.anyFaint || isFaint;
    }
    return lines;
}

// Edges of the wall that a faint line comes near to.
Surface edgesNear(const PolyMesh& mesh, const Wall& wall, const Lines& lines, const SurfaceIndex& lineIndex) {
    const auto endsOf = [&](const WallEdge& e) { return std::pair{mesh.points[std::size_t(e.a)], mesh.points[std::size_t(e.b)]}; };
    const RawVector<std::size_t> kept = collect<std::size_t>(wall.edges.size(), [&](std::size_t i, const auto& put) {
        const WallEdge& e = wall.edges[i];
        if (i > 0 && wall.edges[i - 1].a == e.a && wall.edges[i - 1].b == e.b) return;
        const auto [a, b] = endsOf(e);
        const double reach = 0.5 * norm(b - a) + near * wall.faceH[std::size_t(e.face)] * 2; // the next face may be of larger cells
        if (lineIndex.closest((a + b) * 0.5, reach, [&](std::uint32_t line) { return lines.isFaint[line] != 0; })) put(i);
    }, 1024);
    Surface s;
    for (const std::size_t i : kept) {
        const auto [a, b] = endsOf(wall.edges[i]);
        addSegment(s, a, b);
    }
    return s;
}

Vec3 directionOf(const Surface& segments, std::uint32_t i) {
    const auto& t = segments.triangles[i];
    return normalized(segments.points[t[1]] - segments.points[t[0]]);
}

} // namespace

void measureFaintCapture(const PolyMesh& mesh, const Wall& wall, const SurfaceIndex& index, const FeatureGraph& features, FitReport& report) {
    const Lines lines = linesOf(features);
    if (!lines.anyFaint) return;
    const SurfaceIndex lineIndex(lines.segments);
    const Surface edges = edgesNear(mesh, wall, lines, lineIndex);
    const SurfaceIndex edgeIndex(edges);
    const auto counts = [&](const Vec3& p, std::uint32_t line, const WallPlace& at) {
        return lines.isFaint[line] != 0 && index.closest(p, overGeometry * at.h) && flowThatSees(wall, index, at, p);
    };
    const auto isCaptured = [&](const Vec3& p, std::uint32_t line, const WallPlace& at) {
        const Vec3 direction = directionOf(lines.segments, line);
        return bool(edgeIndex.closest(p, near * at.h, [&](std::uint32_t e) { return std::abs(dot(directionOf(edges, e), direction)) >= along; }));
    };
    const LineSamples n = captureLines(mesh, wall, lines.segments, lineIndex, counts, isCaptured);
    report.faintSamples = n.samples;
    report.faintCaptureFraction = n.captured();
}

} // namespace i2b
