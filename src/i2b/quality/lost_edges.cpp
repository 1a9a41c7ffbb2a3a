#include "i2b/quality/lost_edges.h"
#include "i2b/core/parallel.h"
#include "i2b/paint/union_find.h"
#include <algorithm>
#include <cmath>

namespace i2b {
namespace {

using Index = std::size_t;
constexpr double together = 0.5; // of h: samples so near to each other lie in one place
constexpr double spacing = 0.25; // of h: what one sample stands for
constexpr double nearWall = 0.1; // of h: farther from the wall than this, an edge is not in it
constexpr double beside = 0.1;   // sine: what is over the rim of a face, level with it, is not before it
constexpr double along = 0.9;    // cosine: an edge of the wall that follows a line

LostCause causeOfMost(const std::vector<std::uint32_t>& samples, const std::vector<LostCause>& causes) {
    std::array<int, lostCauses> times{};
    for (const std::uint32_t s : samples) ++times[Index(causes[s])];
    return static_cast<LostCause>(std::ranges::max_element(times) - times.begin());
}

} // namespace

LostCause causeOf(const LostSample& sample, const PolyMesh& mesh, const Wall& wall, const Surface& lines) {
    const WallPlace& at = sample.at;
    const Vec3 off = sample.point - at.point, out = normalized(wall.shapes[Index(at.face)].area);
    if (at.distance > nearWall * at.h) return dot(off, out) > -beside * norm(off) ? LostCause::bridged : LostCause::leftOut;
    const auto& line = lines.triangles[sample.line];
    const Vec3 tangent = normalized(lines.points[line[1]] - lines.points[line[0]]);
    const auto face = mesh.face(wall.faces[Index(at.face)]);
    for (Index i = 0; i < face.size(); ++i) {
        const Vec3 &a = mesh.points[Index(face[i])], &b = mesh.points[Index(face[(i + 1) % face.size()])];
        if (norm(closestPointOnTriangle(sample.point, a, b, b) - sample.point) <= nearWall * at.h && std::abs(dot(normalized(b - a), tangent)) > along) return LostCause::shallow;
    }
    return LostCause::crossed;
}

LostEdges gatherLostEdges(const std::vector<LostSample>& samples, const std::vector<LostCause>& causes, const SurfaceIndex& index, std::size_t most) {
    LostEdges lost;
    if (samples.empty()) return lost;
    Surface points;
    for (const LostSample& sample : samples) addSegment(points, sample.point, sample.point);
    const SurfaceIndex near(points);
    UnionFind sets(samples.size());
    parallelFor(samples.size(), [&](Index i) {
        const Vec3 &p = samples[i].point, reach = Vec3{1, 1, 1} * (together * samples[i].at.h);
        near.any({p - reach, p + reach}, [&](std::uint32_t other) {
            if (other != i && norm(samples[other].point - p) <= together * samples[i].at.h) sets.join(static_cast<std::uint32_t>(i), other);
            return false;
        });
    }, 64);
    struct Place { std::vector<std::uint32_t> samples; double length = 0; };
    std::vector<Place> places;
    std::vector<std::int32_t> number(samples.size(), -1); // of the place, at its lowest sample
    for (Index i = 0; i < samples.size(); ++i) {
        std::int32_t& place = number[sets.find(static_cast<std::uint32_t>(i))];
        if (place < 0) place = static_cast<std::int32_t>(places.size()), places.emplace_back();
        places[Index(place)].samples.push_back(static_cast<std::uint32_t>(i));
        places[Index(place)].length += spacing * samples[i].at.h;
        lost.lengthOf[Index(causes[i])] += spacing * samples[i].at.h;
    }
    std::ranges::stable_sort(places, std::greater{}, &Place::length);
    lost.total = static_cast<std::int64_t>(places.size());
    for (Index i = 0; i < std::min(most, places.size()); ++i) {
        LostEdge edge;
        edge.length = places[i].length;
        edge.at = samples[places[i].samples[places[i].samples.size() / 2]].point;
        edge.cause = causeOfMost(places[i].samples, causes);
        for (const std::uint32_t s : places[i].samples) edge.box.add(samples[s].point);
        if (const ClosestPoint c = index.closest(edge.at)) edge.part = index.surface().parts[index.surface().partOf[c.triangle]].name;
        lost.first.push_back(std::move(edge));
    }
    return lost;
}

} // namespace i2b
