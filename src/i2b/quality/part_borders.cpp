#include "i2b/core/parallel.h"
#include "i2b/quality/fit_report.h"
#include "i2b/quality/mesh_geometry.h"
#include <algorithm>
#include <tbb/parallel_sort.h>
#include <unordered_map>

namespace i2b {
namespace {

struct PatchEdge {
    std::int32_t a, b, face, part; // a < b: points; face of the mesh; part of the geometry
    friend auto operator<=>(const PatchEdge&, const PatchEdge&) = default;
};

// Edges of the faces of patches that are named after parts, sorted.
std::vector<PatchEdge> edgesOfParts(const PolyMesh& mesh, const Surface& surface) {
    std::unordered_map<std::string, std::int32_t> partOf;
    for (std::size_t i = 0; i < surface.parts.size(); ++i) partOf.emplace(surface.parts[i].name, static_cast<std::int32_t>(i));
    std::vector<PatchEdge> edges;
    for (const Patch& patch : mesh.patches) {
        const auto part = partOf.find(patch.name);
        if (patch.type != "wall" || part == partOf.end()) continue;
        for (std::int32_t f = patch.start; f < patch.start + patch.count; ++f) {
            const auto face = mesh.face(f);
            for (std::size_t k = 0; k < face.size(); ++k) {
                const auto [a, b] = std::minmax(face[k], face[(k + 1) % face.size()]);
                edges.push_back({a, b, f, part->second});
            }
        }
    }
    tbb::parallel_sort(edges);
    return edges;
}

} // namespace

void measurePartBorders(const PolyMesh& mesh, const SurfaceIndex& index, FitReport& report) {
    const std::vector<PatchEdge> edges = edgesOfParts(mesh, index.surface());
    std::vector<std::size_t> borders; // the first of two sides of different parts
    for (std::size_t i = 0; i + 1 < edges.size(); ++i) {
        if (edges[i].a == edges[i + 1].a && edges[i].b == edges[i + 1].b && edges[i].part != edges[i + 1].part) borders.push_back(i);
    }
    constexpr int samples = 4;
    const auto nearestPart = [&](const Vec3& q) {
        const ClosestPoint c = index.closest(q);
        return c ? static_cast<std::int32_t>(index.surface().partOf[c.triangle]) : -1;
    };
    const auto onBorder = [&](std::size_t i) {
        const PatchEdge &first = edges[i], &second = edges[i + 1];
        const Vec3 &a = mesh.points[static_cast<std::size_t>(first.a)], &b = mesh.points[static_cast<std::size_t>(first.b)];
        const FaceShape one = measureFace(mesh, first.face), other = measureFace(mesh, second.face);
        const double reach = 0.1 * (norm(b - a) + std::sqrt(norm(one.area)) + std::sqrt(norm(other.area))) / 3;
        const Vec3 along = normalized(b - a);
        std::int64_t count = 0;
        for (int k = 0; k < samples; ++k) {
            const Vec3 p = a + (b - a) * ((k + 0.5) / samples);
            const auto beside = [&](const FaceShape& face) {
                const Vec3 way = face.centre - p;
                return p + normalized(way - along * dot(way, along)) * reach;
            };
            count += nearestPart(beside(one)) == first.part && nearestPart(beside(other)) == second.part;
        }
        return count;
    };
    const std::int64_t near = orderedReduce(
        borders.size(), std::int64_t(0),
        [&](std::size_t begin, std::size_t end) {
            std::int64_t n = 0;
            for (std::size_t i = begin; i < end; ++i) n += onBorder(borders[i]);
            return n;
        },
        [](std::int64_t x, std::int64_t y) { return x + y; }, 256);
    report.borderSamples = samples * static_cast<std::int64_t>(borders.size());
    if (report.borderSamples > 0) report.partBorderFraction = static_cast<double>(near) / static_cast<double>(report.borderSamples);
}

} // namespace i2b
