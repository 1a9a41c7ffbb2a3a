#include "i2b/core/parallel.h"
#include "i2b/quality/border_lines.h"
#include "i2b/quality/line_capture.h"
#include <algorithm>
#include <atomic>
#include <unordered_map>

namespace i2b {
namespace {

constexpr double touching = 0.01; // of h: parts so near to each other touch
constexpr double inwards = 0.3;   // of the way to the face's centre
constexpr double overWall = 0.3;  // of h: from so far over the wall a border must be seen

// The part behind each face of the wall; -1 where its patch is not named after one.
std::vector<std::int32_t> partsOf(const PolyMesh& mesh, const Wall& wall, const Surface& surface) {
    std::unordered_map<std::string, std::int32_t> named;
    for (std::size_t i = 0; i < surface.parts.size(); ++i) named.emplace(surface.parts[i].name, static_cast<std::int32_t>(i));
    std::vector<std::int32_t> parts(wall.faces.size(), -1);
    for (const Patch& patch : mesh.patches) {
        const auto part = named.find(patch.name);
        if (part == named.end()) continue;
        const auto first = std::lower_bound(wall.faces.begin(), wall.faces.end(), patch.start);
        for (auto f = first; f != wall.faces.end() && *f < patch.start + patch.count; ++f) parts[std::size_t(f - wall.faces.begin())] = part->second;
    }
    return parts;
}

// Edges between patches of two parts.
BorderLines patchEdges(const PolyMesh& mesh, const Wall& wall, const std::vector<std::int32_t>& partOf) {
    BorderLines borders;
    borders.lines.parts = {Part{"patches", "", 0}};
    for (std::size_t i = 0; i + 1 < wall.edges.size(); ++i) {
        const WallEdge &e = wall.edges[i], &other = wall.edges[i + 1];
        if (e.a != other.a || e.b != other.b) continue;
        const auto parts = std::minmax(partOf[std::size_t(e.face)], partOf[std::size_t(other.face)]);
        if (parts.first < 0 || parts.first == parts.second) continue;
        addSegment(borders.lines, mesh.points[std::size_t(e.a)], mesh.points[std::size_t(e.b)]);
        borders.parts.push_back({parts.first, parts.second});
    }
    return borders;
}

// Triangles about h/2 and less from wall faces that have more than one part so near; a few faces that follow each other,
// and lie close together, ask as one.
std::vector<std::uint8_t> nearBorders(const PolyMesh& mesh, const Wall& wall, const SurfaceIndex& index) {
    const Surface& surface = index.surface();
    std::vector<std::uint8_t> marked(surface.triangles.size(), 0);
    constexpr std::size_t together = 4;
    parallelChunks(wall.faces.size(), together, [&](std::size_t begin, std::size_t end, std::size_t) {
        Box box{wall.shapes[begin].centre, wall.shapes[begin].centre};
        for (std::size_t i = begin; i < end; ++i) {
            const Vec3 room = Vec3{1, 1, 1} * (0.5 * wall.faceH[i]); // samples farther off do not count
            for (const std::int32_t v : mesh.face(wall.faces[i])) {
                const Vec3& p = mesh.points[std::size_t(v)];
                box = {cwiseMin(box.lo, p - room), cwiseMax(box.hi, p + room)};
            }
        }
        std::int32_t first = -1;
        const auto isOther = [&](std::uint32_t t) {
            if (first < 0) first = surface.partOf[t];
            return surface.partOf[t] != first;
        };
        if (!index.any(box, isOther)) return;
        index.any(box, [&](std::uint32_t t) {
            std::atomic_ref(marked[t]).store(1, std::memory_order_relaxed);
            return false;
        });
    });
    return marked;
}

} // namespace

void measurePartBorders(const PolyMesh& mesh, const SurfaceIndex& index, const std::vector<std::string>& names, FitReport& report) {
    if (index.surface().parts.size() < 2) return;
    const Wall wall = collectWall(mesh, names);
    if (wall.faces.empty()) return;
    const BorderLines patches = patchEdges(mesh, wall, partsOf(mesh, wall, index.surface()));
    if (patches.parts.empty()) return;
    std::vector<double> sizes = wall.faceH;
    std::nth_element(sizes.begin(), sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2), sizes.end());
    const BorderLines borders = borderLines(index, nearBorders(mesh, wall, index), touching * sizes[sizes.size() / 2]);
    const SurfaceIndex lineIndex(borders.lines), patchIndex(patches.lines);
    const auto isSeen = [&](const Vec3& p, std::uint32_t, const WallPlace& at) {
        const FaceShape& face = wall.shapes[std::size_t(at.face)]; // over its inside: over its rim may be another part
        const Vec3 flow = at.point + (face.centre - at.point) * inwards - normalized(face.area) * (overWall * at.h);
        const double far = norm(p - flow);
        return far > 0 && !index.firstHit(flow, p, 1 - touching * at.h / far);
    };
    const auto isCaptured = [&](const Vec3& p, std::uint32_t line, const WallPlace& at) {
        return bool(patchIndex.closest(p, 0.1 * at.h, [&](std::uint32_t e) { return patches.parts[e] == borders.parts[line]; }));
    };
    const LineSamples n = captureLines(mesh, wall, borders.lines, lineIndex, isSeen, isCaptured);
    report.borderSamples = n.samples;
    if (n.samples > 0) report.partBorderFraction = static_cast<double>(n.captured) / static_cast<double>(n.samples);
}

} // namespace i2b
