#include "i2b/quality/sharp_samples.h"
#include "i2b/core/parallel.h"
#include "i2b/core/sort_unique.h"
#include <algorithm>
#include <cmath>
#include <tbb/parallel_sort.h>

namespace i2b {
namespace {

using Index = std::size_t;
constexpr int ringsBeside = 2; // of faces, whose edges may capture what lies at a face
constexpr double near = 5;     // of a face's longest edge: farther from sharp edges it has no part in what is captured

bool isNear(const PolyMesh& mesh, std::int32_t face, const SurfaceIndex& edges) {
    const auto points = mesh.face(face);
    const Vec3* from = &mesh.points[Index(points.back())];
    double longest = 0;
    for (const std::int32_t p : points) {
        longest = std::max(longest, norm2(mesh.points[Index(p)] - *from));
        from = &mesh.points[Index(p)];
    }
    return bool(edges.closest(*from, near * std::sqrt(longest)));
}

} // namespace

SharpSamples::SharpSamples(const PolyMesh& mesh, const Rows& cellFaces, const FeatureGraph& features, const SurfaceIndex& index, double h)
    : mesh_(mesh), edges_(sharpSurface(features, h, index)) {
    if (edges_.triangles.empty()) return;
    const SurfaceIndex edgeIndex(edges_);
    wall_ = collectWall(mesh, cellFaces, {}, [&](std::int32_t face) { return isNear(mesh, face, edgeIndex); });
    if (wall_.faces.empty()) return;
    ends_ = endsOf(mesh, wall_);
    const Surface creases = creaseSurface(mesh, wall_, ends_);
    const SurfaceIndex creaseIndex(creases);
    const auto isCaptured = [&](const Vec3& p, double h) { return bool(creaseIndex.closest(p, capturedWithin * h)); };
    const LineAsk counts = sharpThatCount(wall_, index, edges_);
    samples_ = captureLines(
                   mesh, wall_, edges_, edgeIndex, // the test of what counts takes longest
                   [&](const Vec3& p, std::uint32_t line, const WallPlace& at) { return isCaptured(p, at.h) || counts(p, line, at); },
                   [](const Vec3&, std::uint32_t, const WallPlace&) { return false; })
                   .lost;
    std::ranges::stable_sort(samples_, {}, [](const LostSample& s) { return s.at.face; });
    captured_.resize(samples_.size());
    parallelFor(samples_.size(), [&](Index i) { captured_[i] = isCaptured(samples_[i].point, samples_[i].at.h); }, 256);
    facesAt_.resize(2 * wall_.edges.size());
    parallelFor(wall_.edges.size(), [&](Index i) {
        const WallEdge& e = wall_.edges[i];
        facesAt_[2 * i] = {e.a, e.face}, facesAt_[2 * i + 1] = {e.b, e.face};
    }, 4096);
    tbb::parallel_sort(facesAt_);
    facesAt_.erase(std::unique(facesAt_.begin(), facesAt_.end()), facesAt_.end());
    std::sort(ends_.begin(), ends_.end());
}

SharpSamples::Faces SharpSamples::grown(Faces faces, int rings) const {
    sortUnique(faces);
    for (int ring = 0; ring < rings; ++ring) {
        Faces more;
        for (const std::int32_t f : faces) {
            for (const std::int32_t p : mesh_.face(meshFace(f))) {
                auto at = std::ranges::lower_bound(facesAt_, std::pair{p, std::int32_t(-1)});
                for (; at != facesAt_.end() && at->first == p; ++at) more.push_back(at->second);
            }
        }
        sortUnique(more);
        faces = std::move(more); // with all of before, as each has its own points
    }
    return faces;
}

std::vector<std::uint32_t> SharpSamples::at(const Faces& faces) const {
    std::vector<std::uint32_t> found;
    for (const std::int32_t f : faces) {
        const auto [first, last] = std::ranges::equal_range(samples_, f, {}, [](const LostSample& s) { return s.at.face; });
        for (auto s = first; s != last; ++s) found.push_back(static_cast<std::uint32_t>(s - samples_.begin()));
    }
    return found;
}

// Asked of the first of several edges between the same points.
bool SharpSamples::folds(std::size_t edge) const {
    const WallEdge& e = wall_.edges[edge];
    std::vector<Vec3> areas;
    for (Index i = edge; i < wall_.edges.size() && wall_.edges[i].a == e.a && wall_.edges[i].b == e.b; ++i) areas.push_back(measureFace(mesh_, meshFace(wall_.edges[i].face)).area);
    if (areas.size() == 1)
        for (auto end = std::ranges::lower_bound(ends_, edge, {}, &WallEnd::edge); end != ends_.end() && end->edge == edge; ++end)
            areas.push_back(measureFace(mesh_, end->face).area);
    for (Index i = 0; i < areas.size(); ++i)
        for (Index k = 0; k < i; ++k)
            if (isCrease(areas[i], areas[k])) return true;
    return false;
}

void SharpSamples::judge(const std::vector<std::uint32_t>& samples) {
    Faces faces;
    for (const std::uint32_t s : samples) faces.push_back(samples_[s].at.face);
    std::vector<std::size_t> edges;
    for (const std::int32_t f : grown(std::move(faces), ringsBeside)) {
        const auto points = mesh_.face(meshFace(f));
        for (Index k = 0; k < points.size(); ++k) {
            const auto [a, b] = std::minmax(points[k], points[(k + 1) % points.size()]);
            edges.push_back(static_cast<Index>(std::ranges::lower_bound(wall_.edges, WallEdge{a, b, -1}) - wall_.edges.begin()));
        }
    }
    sortUnique(edges);
    std::vector<std::uint8_t> isFold(edges.size());
    parallelFor(edges.size(), [&](Index i) { isFold[i] = folds(edges[i]); }, 256);
    Surface creases;
    for (Index i = 0; i < edges.size(); ++i)
        if (isFold[i]) addSegment(creases, mesh_.points[Index(wall_.edges[edges[i]].a)], mesh_.points[Index(wall_.edges[edges[i]].b)]);
    const SurfaceIndex creaseIndex(creases);
    parallelFor(samples.size(), [&](Index i) {
        const LostSample& s = samples_[samples[i]];
        captured_[samples[i]] = bool(creaseIndex.closest(s.point, capturedWithin * s.at.h));
    }, 256);
}

} // namespace i2b
