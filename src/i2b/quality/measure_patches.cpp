// Patches as surfaces, zones, regions, and the directions that empty and wedge patches take out.
#include "i2b/core/collect.h"
#include "i2b/core/parallel_sort_unique.h"
#include "i2b/quality/measure_steps.h"
#include <algorithm>
#include <atomic>
#include <functional>
#include <numbers>
#include <set>
#include <tbb/parallel_sort.h>

namespace i2b {
namespace {

using Index = std::size_t;

// One use of an edge by a face of a patch.
struct EdgeUse {
    std::int32_t a, b, face; // a < b
    bool sameEdge(const EdgeUse& o) const { return a == o.a && b == o.b; }
    friend auto operator<=>(const EdgeUse&, const EdgeUse&) = default;
};

RawVector<EdgeUse> patchEdges(const PolyMesh& mesh, const Patch& patch) {
    RawVector<EdgeUse> uses(mesh.faceOffsets[Index(patch.start + patch.count)] -
                            mesh.faceOffsets[Index(patch.start)]);
    parallelFor(
        Index(patch.count),
        [&](Index i) {
            const Index f = Index(patch.start) + i;
            const std::span<const std::int32_t> v = mesh.face(static_cast<std::int32_t>(f));
            Index at = mesh.faceOffsets[f] - mesh.faceOffsets[Index(patch.start)];
            for (Index k = 0; k < v.size(); ++k) {
                const auto [lo, hi] = std::minmax(v[k], v[k + 1 == v.size() ? 0 : k + 1]);
                uses[at++] = {lo, hi, static_cast<std::int32_t>(f)};
            }
        },
        1024);
    tbb::parallel_sort(uses.begin(), uses.end());
    return uses;
}

std::vector<std::int32_t> patchPoints(const PolyMesh& mesh, const Patch& patch) {
    std::vector<std::int32_t> points(mesh.faceVertices.begin() + mesh.faceOffsets[Index(patch.start)],
                                     mesh.faceVertices.begin() +
                                         mesh.faceOffsets[Index(patch.start + patch.count)]);
    parallelSortUnique(points);
    return points;
}

// On a closed surface, where every edge has two faces: points whose faces do not all hang together through
// the edges at the point. Each edge links its two faces at both of its ends; the faces at a point make one
// ring when the links and the faces' corners form a single cycle.
RawVector<std::int32_t> pinchedPoints(const RawVector<EdgeUse>& uses) {
    struct Link {
        std::int32_t point, face, other;
    };
    RawVector<Link> links(uses.size() / 2 * 4);
    parallelFor(uses.size() / 2, [&](Index i) {
        const EdgeUse &use = uses[2 * i], &other = uses[2 * i + 1];
        links[4 * i] = {use.a, use.face, other.face}, links[4 * i + 1] = {use.a, other.face, use.face};
        links[4 * i + 2] = {use.b, use.face, other.face}, links[4 * i + 3] = {use.b, other.face, use.face};
    }, 4096);
    tbb::parallel_sort(links.begin(), links.end(), [](const Link& x, const Link& y) {
        return std::tie(x.point, x.face, x.other) < std::tie(y.point, y.face, y.other);
    });
    const auto isPinched = [&](Index i, Index j) {
        std::vector<std::int32_t> ring{links[i].face};
        for (Index k = 0; k < ring.size(); ++k)
            for (Index l = i; l < j; ++l)
                if (links[l].face == ring[k] && std::ranges::find(ring, links[l].other) == ring.end()) ring.push_back(links[l].other);
        return std::any_of(links.begin() + static_cast<std::ptrdiff_t>(i), links.begin() + static_cast<std::ptrdiff_t>(j),
                           [&](const Link& link) { return std::ranges::find(ring, link.face) == ring.end(); });
    };
    return collect<std::int32_t>(links.size(), [&](Index i, const auto& put) {
        if (i > 0 && links[i - 1].point == links[i].point) return;
        Index j = i + 1;
        while (j < links.size() && links[j].point == links[i].point) ++j;
        if (isPinched(i, j)) put(links[i].point);
    });
}

PatchQuality measurePatch(const PolyMesh& mesh, const Patch& patch, std::vector<std::int32_t>& nonManifold) {
    PatchQuality quality;
    quality.name = patch.name;
    quality.faces = patch.count;
    if (patch.count == 0) return quality;
    const std::vector<std::int32_t> points = patchPoints(mesh, patch);
    quality.points = static_cast<std::int64_t>(points.size());
    for (const std::int32_t p : points) quality.box.add(mesh.points[Index(p)]);
    const RawVector<EdgeUse> uses = patchEdges(mesh, patch);
    std::atomic<bool> isOpen = false;
    const RawVector<std::int32_t> shared = collect<std::int32_t>(uses.size(), [&](Index i, const auto& put) { // each edge at its first use
        if (i > 0 && uses[i - 1].sameEdge(uses[i])) return;
        Index j = i + 1;
        while (j < uses.size() && uses[j].sameEdge(uses[i])) ++j;
        if (j - i == 1) isOpen.store(true, std::memory_order_relaxed);
        if (j - i > 2) put(uses[i].a), put(uses[i].b);
    });
    nonManifold.insert(nonManifold.end(), shared.begin(), shared.end());
    const bool open = isOpen, over = !shared.empty();
    quality.topology = over   ? SurfaceTopology::sharedEdge
                       : open ? SurfaceTopology::open
                              : SurfaceTopology::closed;
    if (over || open) return quality;
    const RawVector<std::int32_t> pinched = pinchedPoints(uses);
    if (!pinched.empty()) quality.topology = SurfaceTopology::sharedPoint;
    nonManifold.insert(nonManifold.end(), pinched.begin(), pinched.end());
    return quality;
}

Vec3 absolute(const Vec3& a) { return {std::abs(a.x), std::abs(a.y), std::abs(a.z)}; }

// The mean normal of a wedge patch, and the plane's own: what the components of the former have over one
// half.
struct Wedge {
    Vec3 normal, centreNormal;
};
Wedge wedgeOf(const PolyMesh& mesh, const Patch& patch) {
    Wedge wedge;
    for (std::int32_t f = patch.start; f < patch.start + patch.count; ++f) {
        const Vec3 area = measureFace(mesh, f).area;
        wedge.normal += divided(area, norm(area) + 1e-300);
    }
    wedge.normal = divided(wedge.normal, patch.count);
    for (int k = 0; k < 3; ++k)
        wedge.centreNormal[k] =
            (wedge.normal[k] >= 0 ? 1 : -1) * (std::max(std::abs(wedge.normal[k]), 0.5) - 0.5);
    const double size = norm(wedge.centreNormal);
    wedge.centreNormal = size < 1e-150 ? Vec3{} : divided(wedge.centreNormal, size);
    return wedge;
}

void removeDirections(const Vec3& sum, std::array<int, 3>& directions) {
    const double size = norm(sum);
    if (size < 1e-150) return;
    const Vec3 unit = divided(sum, size);
    for (int k = 0; k < 3; ++k) directions[Index(k)] = unit[k] > 1e-6 ? 0 : 1;
}

} // namespace

void measurePatches(Measurement& m) {
    const PolyMesh& mesh = m.mesh;
    std::vector<std::int32_t> nonManifold;
    std::set<std::string> names;
    std::int32_t next = mesh.internalFaces();
    std::int64_t empty = 0;
    for (const Patch& patch : mesh.patches) {
        m.report.patches.push_back(measurePatch(mesh, patch, nonManifold));
        if (patch.start != next || !names.insert(patch.name).second) m.report.boundaryDefined = false;
        next += patch.count;
        if (patch.type == "empty") empty += patch.count;
    }
    m.report.emptyFacesDivide = mesh.cells == 0 || empty % mesh.cells == 0;
    std::sort(nonManifold.begin(), nonManifold.end());
    nonManifold.erase(std::unique(nonManifold.begin(), nonManifold.end()), nonManifold.end());
    for (const std::int32_t p : nonManifold) m.tallies.nonManifoldPoints.hit(p);
}

void measureZones(Measurement& m) {
    const PolyMesh& mesh = m.mesh;
    for (const CellZone& zone : mesh.zones) {
        ZoneQuality quality;
        quality.name = zone.name;
        quality.cells = static_cast<std::int64_t>(zone.cells.size());
        std::vector<bool> used(mesh.points.size(), false);
        for (const std::int32_t c : zone.cells) {
            quality.volume += m.moments[Index(c)].volume;
            for (const std::int32_t f : m.cellFaces[c])
                for (const std::int32_t p : mesh.face(f)) {
                    if (used[Index(p)]) continue;
                    used[Index(p)] = true;
                    ++quality.points;
                    quality.box.add(mesh.points[Index(p)]);
                }
        }
        m.report.zones.push_back(std::move(quality));
    }
}

void measureRegions(Measurement& m) {
    const PolyMesh& mesh = m.mesh;
    std::vector<std::int32_t> region = regionRoots(mesh); // becomes the number of the region
    const bool isOne = orderedReduce(region.size(), true, [&](Index begin, Index end) {
        return std::all_of(region.begin() + static_cast<std::ptrdiff_t>(begin), region.begin() + static_cast<std::ptrdiff_t>(end), [](std::int32_t root) { return root == 0; });
    }, std::logical_and<>());
    if (isOne && !region.empty()) {
        m.report.regions.emplace_back().cells = mesh.cells;
        return;
    }
    for (Index c = 0; c < region.size(); ++c) {
        const auto root = static_cast<Index>(region[c]);
        if (root == c) {
            region[c] = static_cast<std::int32_t>(m.report.regions.size());
            m.report.regions.emplace_back();
        } else {
            region[c] = region[root];
        }
        ++m.report.regions[Index(region[c])].cells;
    }
    if (m.report.regions.size() < 2) return;
    std::vector<std::int32_t> pointRegion(mesh.points.size(), -1);
    std::vector<std::uint8_t> several(mesh.points.size(), 0);
    for (std::int32_t f = mesh.internalFaces(); f < mesh.faces(); ++f) {
        const std::int32_t r = region[Index(mesh.owner[Index(f)])];
        for (const std::int32_t p : mesh.face(f)) {
            std::int32_t& first = pointRegion[Index(p)];
            if (first < 0) first = r;
            if (first == r) continue;
            several[Index(p)] = 1;
            m.report.regions[Index(first)].pointConnected = m.report.regions[Index(r)].pointConnected = true;
        }
    }
    m.tallies.multiRegionPoints = tallyMarks(several);
}

void measureDirections(Measurement& m) {
    const PolyMesh& mesh = m.mesh;
    QualityReport& r = m.report;
    Vec3 emptySum, wedgeSum, areaSum;
    bool anyEmpty = false, anyWedge = false;
    double areaSize = 0;
    for (const Patch& patch : mesh.patches) {
        if (patch.count == 0) continue;
        if (patch.type == "empty") {
            anyEmpty = true;
            Vec3 sum;
            for (std::int32_t f = patch.start; f < patch.start + patch.count; ++f)
                sum += absolute(measureFace(mesh, f).area);
            emptySum += sum;
        } else if (patch.type == "wedge") {
            anyWedge = true;
            const Wedge wedge = wedgeOf(mesh, patch);
            wedgeSum += absolute(wedge.centreNormal);
            r.wedges.push_back(
                {patch.name, std::acos(dot(wedge.centreNormal, wedge.normal)) * 180 / std::numbers::pi});
        }
    }
    if (anyEmpty) removeDirections(emptySum, r.solutionDirections);
    r.geometricDirections = r.solutionDirections;
    if (anyWedge) removeDirections(wedgeSum, r.geometricDirections);
    RawVector<Vec3> areas(Index(mesh.faces() - mesh.internalFaces()));
    parallelFor(areas.size(), [&](Index i) { areas[i] = measureFace(mesh, mesh.internalFaces() + static_cast<std::int32_t>(i)).area; }, 1024);
    for (const Vec3& area : areas) { // one after the other, as checkMesh does: what is left of the sum is rounding
        areaSum += area;
        areaSize += norm(area);
    }
    r.boundaryOpenness = divided(areaSum, areaSize + 1e-300);
}

void measureAlignment(Measurement& m) {
    const PolyMesh& mesh = m.mesh;
    const std::array<int, 3>& valid = m.report.geometricDirections;
    if (valid[0] + valid[1] + valid[2] == 3) return;
    // On a wedge mesh the edges of the wedge patches themselves may lean.
    std::vector<std::pair<std::int32_t, std::int32_t>> excused, edges;
    const auto each = [&](std::int32_t begin, std::int32_t end, const auto& body) {
        for (std::int32_t f = begin; f < end; ++f) {
            const std::span<const std::int32_t> v = mesh.face(f);
            for (Index i = 0; i < v.size(); ++i) body(v[i], v[i + 1 == v.size() ? 0 : i + 1]);
        }
    };
    if (valid != m.report.solutionDirections) {
        for (const Patch& patch : mesh.patches)
            if (patch.type == "wedge")
                each(patch.start, patch.start + patch.count, [&](std::int32_t a, std::int32_t b) {
                    excused.emplace_back(std::min(a, b), std::max(a, b));
                });
        std::sort(excused.begin(), excused.end());
    }
    each(0, mesh.faces(), [&](std::int32_t a, std::int32_t b) {
        if (a >= b) return;
        const Vec3 d = mesh.points[Index(b)] - mesh.points[Index(a)];
        const double length = norm(d);
        if (!(length > 1e-150)) return;
        const Vec3 unit = divided(d, length);
        int empty = 0, other = 0;
        for (int k = 0; k < 3; ++k)
            if (std::abs(unit[k]) > 1e-6) ++(valid[Index(k)] == 0 ? empty : other);
        if (empty == 0 || (empty == 1 && other == 0)) return;
        if (std::binary_search(excused.begin(), excused.end(), std::pair(a, b))) return;
        edges.emplace_back(a, b);
    });
    std::sort(edges.begin(), edges.end());
    edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
    m.report.misalignedEdges = static_cast<std::int64_t>(edges.size());
    std::vector<std::uint8_t> marks(mesh.points.size(), 0);
    for (const auto& [a, b] : edges) marks[Index(a)] = marks[Index(b)] = 1;
    m.tallies.nonAlignedEdges = tallyMarks(marks);
}

} // namespace i2b
