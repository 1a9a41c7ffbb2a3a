#include "i2b/core/parallel.h"
#include "i2b/quality/fit_wall.h"

namespace i2b {
namespace {

// Gives the distance of each node, in h.
std::vector<double> measureNodes(const PolyMesh& mesh, const Wall& wall, const SurfaceIndex& index, FitReport& report) {
    std::vector<double> distance(wall.nodes.size());
    parallelFor(wall.nodes.size(), [&](std::size_t i) {
        const Vec3& p = mesh.points[static_cast<std::size_t>(wall.nodes[i])];
        distance[i] = index.closest(p).distance / wall.nodeH[i];
    });
    std::int64_t within0001 = 0, within001 = 0, within01 = 0;
    for (std::size_t i = 0; i < distance.size(); ++i) {
        within0001 += distance[i] <= 0.001;
        within001 += distance[i] <= onGeometry;
        within01 += distance[i] <= 0.1;
        if (i > 0 && distance[i] <= report.maxDistanceInH) continue;
        report.maxDistanceInH = distance[i];
        report.farthest = mesh.points[static_cast<std::size_t>(wall.nodes[i])];
    }
    const auto n = static_cast<double>(distance.size());
    report.wallNodesWithin0001h = static_cast<double>(within0001) / n;
    report.wallNodesOnGeometryFraction = static_cast<double>(within001) / n;
    report.wallNodesWithin01h = static_cast<double>(within01) / n;
    return distance;
}

// Unit normal of the geometry at its point closest to q: of the nearest triangle that has one.
Vec3 normalUnder(const SurfaceIndex& index, const ClosestPoint& c, const Vec3& q) {
    if (const Vec3 n = index.normal(c.triangle); norm2(n) > 0) return n;
    const ClosestPoint other = index.closest(q, std::numeric_limits<double>::infinity(),
                                             [&](std::uint32_t t) { return norm2(index.normal(t)) > 0; });
    return other ? index.normal(other.triangle) : Vec3{};
}

// Gives, per face, whether it is tilted by over 45 degrees.
std::vector<std::uint8_t> measureFaces(const Wall& wall, const SurfaceIndex& index, const SurfaceIndex& sharp, FitReport& report) {
    std::vector<std::uint8_t> tilted(wall.faces.size(), 0);
    struct Sums {
        double distance = 0;
        std::int64_t smooth = 0, tilted = 0, tilted45 = 0;
    };
    const auto body = [&](std::size_t begin, std::size_t end) {
        Sums s;
        for (std::size_t i = begin; i < end; ++i) {
            const Vec3 centre = wall.shapes[i].centre, normal = normalized(wall.shapes[i].area);
            const ClosestPoint c = index.closest(centre);
            s.distance += c.distance / wall.faceH[i];
            if (sharp.closest(centre, wall.faceH[i])) continue;
            ++s.smooth;
            const Vec3 under = normalUnder(index, c, centre);
            double angle = degreesBetween(normal, under);
            if (norm2(normal) == 0 || norm2(under) == 0) angle = 0;
            angle = std::min(angle, 180 - angle);
            s.tilted += angle > 25;
            tilted[i] = angle > 45;
            s.tilted45 += tilted[i];
        }
        return s;
    };
    const auto join = [](const Sums& a, const Sums& b) {
        return Sums{a.distance + b.distance, a.smooth + b.smooth, a.tilted + b.tilted,
                    a.tilted45 + b.tilted45};
    };
    const Sums s = orderedReduce(wall.faces.size(), Sums{}, body, join, 512);
    report.meanDistanceInH = s.distance / static_cast<double>(wall.faces.size());
    if (s.smooth == 0) return tilted;
    report.tiltedFaceFraction = static_cast<double>(s.tilted) / static_cast<double>(s.smooth);
    report.tilted45FaceFraction = static_cast<double>(s.tilted45) / static_cast<double>(s.smooth);
    return tilted;
}

} // namespace

FitReport measureFit(const PolyMesh& mesh, const Rows& cellFaces, const SurfaceIndex& index, const FeatureGraph& features,
                     const std::vector<std::string>& patches, WallNodes* nodes) {
    FitReport report;
    Wall wall = collectWall(mesh, cellFaces, patches);
    report.wallFaces = static_cast<std::int64_t>(wall.faces.size());
    report.wallNodes = static_cast<std::int64_t>(wall.nodes.size());
    if (wall.faces.empty() || index.surface().triangles.empty()) return report;

    const Surface sharpEdges = sharpSurface(features, sizeOfMost(wall), index);
    const SurfaceIndex sharp(sharpEdges);
    std::vector<double> distance = measureNodes(mesh, wall, index, report);
    const std::vector<std::uint8_t> tilted = measureFaces(wall, index, sharp, report);
    if (!sharpEdges.triangles.empty()) measureCapture(mesh, wall, index, sharpEdges, sharp, report);
    measureFaintCapture(mesh, wall, index, features, report);
    if (!nodes) return report;
    nodes->distanceInH = std::move(distance);
    nodes->tilted.assign(wall.nodes.size(), 0);
    for (std::size_t i = 0; i < wall.faces.size(); ++i) {
        if (!tilted[i]) continue;
        for (const std::int32_t v : mesh.face(wall.faces[i])) nodes->tilted[nodePlace(wall, v)] = 1;
    }
    nodes->points = std::move(wall.nodes);
    return report;
}

} // namespace i2b
