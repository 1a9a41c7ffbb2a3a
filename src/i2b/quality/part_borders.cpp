#include "i2b/core/parallel.h"
#include "i2b/core/quantile.h"
#include "i2b/quality/border_lines.h"
#include "i2b/quality/line_capture.h"
#include <algorithm>
#include <atomic>
#include <numbers>
#include <unordered_map>

namespace i2b {
namespace {

constexpr double touching = 0.01; // of h: parts so near to each other touch
constexpr double overWall = 0.3;  // of h: from so far over the wall a border must be seen
constexpr double beside = 0.1;    // of h: so far from a border the flow looks for what lies at its two sides
constexpr int looks = 60;         // of a round about a border

using Corners = std::array<Vec3, 3>;

Corners cornersOf(const Surface& s, std::uint32_t t) {
    const auto& v = s.triangles[t];
    return {s.points[v[0]], s.points[v[1]], s.points[v[2]]};
}

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

// What a border parts, in the plane across it:
//
//        flow      from the flow's side the look goes round the border both ways until it meets geometry, here at o. All
//      ..   ..     parts that touch there are one side: of two sheets upon each other the mesh can show only one.
//   __o__\/__o__
using Side = std::vector<std::int32_t>; // parts, ascending

bool has(const Side& side, std::int32_t part) { return std::binary_search(side.begin(), side.end(), part); }

class Sides {
  public:
    // Of a place on a border along a unit tangent, seen from a place in the flow. h: m.
    Sides(const SurfaceIndex& index, const Vec3& place, const Vec3& tangent, const Vec3& flow, double h);
    bool areOf(const std::array<std::int32_t, 2>& parts) const {
        return (has(side_[0], parts[0]) && has(side_[1], parts[1])) || (has(side_[0], parts[1]) && has(side_[1], parts[0]));
    }
    // Whether a part goes on from one side to the other.
    bool share() const {
        return std::any_of(side_[0].begin(), side_[0].end(), [&](std::int32_t part) { return has(side_[1], part); });
    }

  private:
    std::array<Side, 2> side_;
};

Side partsAt(const SurfaceIndex& index, const Vec3& p, double tolerance) {
    const Surface& s = index.surface();
    const Vec3 room{tolerance, tolerance, tolerance};
    Side side;
    index.any({p - room, p + room}, [&](std::uint32_t t) {
        const Corners corners = cornersOf(s, t);
        if (norm(closestPointOnTriangle(p, corners[0], corners[1], corners[2]) - p) <= tolerance) side.push_back(s.partOf[t]);
        return false;
    });
    std::sort(side.begin(), side.end());
    side.erase(std::unique(side.begin(), side.end()), side.end());
    return side;
}

Sides::Sides(const SurfaceIndex& index, const Vec3& place, const Vec3& tangent, const Vec3& flow, double h) {
    const Vec3 way = flow - place, u = normalized(way - tangent * dot(way, tangent)), v = cross(tangent, u);
    for (std::size_t i = 0; i < 2; ++i) {
        Vec3 last = place + u * (beside * h);
        for (int k = 1; k < looks; ++k) {
            const double angle = (i == 0 ? 2 : -2) * std::numbers::pi * k / looks;
            const Vec3 next = place + (u * std::cos(angle) + v * std::sin(angle)) * (beside * h);
            if (const SegmentHit hit = index.firstHit(last, next)) {
                side_[i] = partsAt(index, last + (next - last) * hit.t, touching * h);
                break;
            }
            last = next;
        }
    }
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

void measurePartBorders(const PolyMesh& mesh, const Rows& cellFaces, const SurfaceIndex& index, const std::vector<std::string>& names, FitReport& report) {
    if (index.surface().parts.size() < 2) return;
    const Wall wall = collectWall(mesh, cellFaces, names);
    if (wall.faces.empty()) return;
    const BorderLines patches = patchEdges(mesh, wall, partsOf(mesh, wall, index.surface()));
    if (patches.parts.empty()) return;
    std::vector<double> sizes = wall.faceH;
    const BorderLines borders = borderLines(index, nearBorders(mesh, wall, index), touching * median(sizes));
    const SurfaceIndex lineIndex(borders.lines), patchIndex(patches.lines);
    const auto flowAt = [&](const WallPlace& at) { return flowOver(wall, at, overWall * at.h); };
    const auto sidesAt = [&](const Vec3& p, std::uint32_t line, const WallPlace& at) {
        const auto& t = borders.lines.triangles[line];
        return Sides(index, p, normalized(borders.lines.points[t[1]] - borders.lines.points[t[0]]), flowAt(at), at.h);
    };
    const auto isSeen = [&](const Vec3& p, std::uint32_t line, const WallPlace& at) {
        if (!isSeenFrom(index, flowAt(at), p, touching * at.h)) return false;
        const Sides sides = sidesAt(p, line, at);
        return sides.areOf(borders.parts[line]) && !sides.share();
    };
    const auto isCaptured = [&](const Vec3& p, std::uint32_t line, const WallPlace& at) {
        const Sides sides = sidesAt(p, line, at);
        return bool(patchIndex.closest(p, 0.1 * at.h, [&](std::uint32_t e) { return sides.areOf(patches.parts[e]); }));
    };
    const LineSamples n = captureLines(mesh, wall, borders.lines, lineIndex, isSeen, isCaptured);
    report.borderSamples = n.samples;
    report.partBorderFraction = n.captured();
}

} // namespace i2b
