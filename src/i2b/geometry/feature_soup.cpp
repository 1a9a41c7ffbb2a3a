#include "i2b/geometry/feature_soup.h"
#include "i2b/core/bucket_sort.h"
#include <algorithm>
#include <bit>
#include <span>

namespace i2b {
namespace {

constexpr std::uint32_t none = ~0u;

struct GridCell {
    std::int64_t x, y, z;
    std::uint64_t hash() const { // collisions are harmless: distances decide
        std::uint64_t h = static_cast<std::uint64_t>(x) * 0x9E3779B97F4A7C15u;
        h = (h ^ (h >> 29)) + static_cast<std::uint64_t>(y) * 0xC2B2AE3D27D4EB4Fu;
        h = (h ^ (h >> 31)) * 0x165667B19E3779F9u + static_cast<std::uint64_t>(z) * 0xBF58476D1CE4E5B9u;
        return h ^ (h >> 32);
    }
};

struct HashedPoint {
    std::uint64_t hash;
    std::uint32_t point;
    friend bool operator<(const HashedPoint& a, const HashedPoint& b) {
        return a.hash != b.hash ? a.hash < b.hash : a.point < b.point;
    }
};

struct PointGrid {
    Vec3 origin;
    double cell = 0; // m, several tolerances: a point's surroundings are mostly one cell
    GridCell at(const Vec3& p) const {
        const auto f = [&](double x) { return static_cast<std::int64_t>(std::floor(x / cell)); };
        return {f(p.x - origin.x), f(p.y - origin.y), f(p.z - origin.z)};
    }
};

// The lowest-numbered point within the tolerance of each used point (itself, if none is lower).
std::vector<std::uint32_t> weldTargets(std::span<const Vec3> points, const std::vector<std::uint32_t>& used,
                                       double tolerance, const Box& bounds) {
    // Never so small that a cell's number overflows.
    const PointGrid grid{bounds.lo, std::max({4 * tolerance, 1e-15 * norm(bounds.extent()), 1e-300})};
    std::vector<HashedPoint> sorted(used.size());
    parallelFor(used.size(), [&](std::size_t i) {
        sorted[i] = {grid.at(points[used[i]]).hash(), used[i]};
    });
    const auto bits = static_cast<int>(std::bit_width(sorted.size() / 4));
    bucketSort(sorted, std::size_t(1) << bits, [&](const HashedPoint& h) { return static_cast<std::size_t>(bits == 0 ? 0 : h.hash >> (64 - bits)); });
    std::vector<std::uint32_t> target(points.size(), none);
    const double limit = tolerance * tolerance;
    parallelFor(sorted.size(), [&](std::size_t i) {
        const std::uint32_t self = sorted[i].point;
        const Vec3 p = points[self], r{tolerance, tolerance, tolerance};
        const GridCell lo = grid.at(p - r), hi = grid.at(p + r);
        std::uint32_t best = self;
        const auto look = [&](std::uint64_t hash, std::size_t from) {
            for (; from < sorted.size() && sorted[from].hash == hash && sorted[from].point < best; ++from)
                if (norm2(points[sorted[from].point] - p) <= limit) best = sorted[from].point;
        };
        for (std::int64_t x = lo.x; x <= hi.x; ++x)
            for (std::int64_t y = lo.y; y <= hi.y; ++y)
                for (std::int64_t z = lo.z; z <= hi.z; ++z) {
                    const std::uint64_t hash = GridCell{x, y, z}.hash();
                    std::size_t from = i; // in the own cell the first is rarely far back
                    if (hash == sorted[i].hash)
                        while (from > 0 && sorted[from - 1].hash == hash) --from;
                    else
                        from = static_cast<std::size_t>(
                            std::lower_bound(sorted.begin(), sorted.end(), HashedPoint{hash, 0}) -
                            sorted.begin());
                    look(hash, from);
                }
        target[self] = best;
    });
    // Ascending: a target's own target is already its last one.
    for (std::size_t i = 0; i < target.size(); ++i)
        if (target[i] != none) target[i] = target[target[i]];
    return target;
}

struct SortedCorners {
    TriangleCorners corners;        // ascending
    std::uint32_t triangle; // in the surface
    friend auto operator<=>(const SortedCorners&, const SortedCorners&) = default;
};

// Numbers the welded points and turns targets into these numbers; gives how many come from the first `own` points.
std::size_t numberPoints(std::span<const Vec3> points, std::size_t own, std::vector<std::uint32_t>& target,
                         FeatureSoup& soup) {
    std::vector<std::uint32_t> number(target.size(), none);
    std::size_t count = 0;
    for (std::size_t i = 0; i < target.size(); ++i) {
        if (target[i] == none) continue;
        if (target[i] == i) {
            number[i] = static_cast<std::uint32_t>(soup.points.size());
            soup.points.push_back(points[i]);
            if (i < own) ++count;
        }
        target[i] = number[target[i]];
    }
    return count;
}

// target: of the lines' points.
void takeLines(const FeatureLines& lines, std::span<const std::uint32_t> target, FeatureSoup& soup) {
    for (const auto& [a, b] : lines.segments)
        if (target[a] != target[b]) soup.lines.push_back(keyOf(target[a], target[b]));
    std::sort(soup.lines.begin(), soup.lines.end());
    soup.lines.erase(std::unique(soup.lines.begin(), soup.lines.end()), soup.lines.end());
    for (const std::uint32_t p : lines.corners) soup.corners.push_back(target[p]);
}

} // namespace

FeatureSoup weldSoup(const Surface& s, const FeatureLines& lines, FeatureGraph& graph) {
    std::vector<bool> isUsed(s.points.size());
    for (const TriangleCorners& t : s.triangles)
        for (const std::uint32_t p : t) isUsed[p] = true;
    std::vector<std::uint32_t> used;
    Box bounds;
    for (std::uint32_t i = 0; i < isUsed.size(); ++i)
        if (isUsed[i]) used.push_back(i), bounds.add(s.points[i]);
    if (graph.weldTolerance <= 0 && !used.empty()) graph.weldTolerance = 1e-6 * norm(bounds.extent());

    std::span<const Vec3> points = s.points;
    std::vector<Vec3> joined;
    if (!lines.points.empty()) { // else a large soup is not copied
        joined = s.points;
        joined.insert(joined.end(), lines.points.begin(), lines.points.end());
        for (std::size_t i = s.points.size(); i < joined.size(); ++i) used.push_back(static_cast<std::uint32_t>(i));
        points = joined;
    }
    FeatureSoup soup;
    std::vector<std::uint32_t> target = weldTargets(points, used, graph.weldTolerance, bounds);
    graph.weldedPoints = numberPoints(points, s.points.size(), target, soup);
    takeLines(lines, std::span(target).subspan(s.points.size()), soup);

    std::vector<SortedCorners> sorted(s.triangles.size());
    parallelFor(sorted.size(), [&](std::size_t t) {
        const TriangleCorners& v = s.triangles[t];
        sorted[t] = {{target[v[0]], target[v[1]], target[v[2]]}, static_cast<std::uint32_t>(t)};
        std::sort(sorted[t].corners.begin(), sorted[t].corners.end());
    });
    bucketSort(sorted, soup.points.size(), [](const SortedCorners& s) { return std::size_t(s.corners[0]); });
    for (std::size_t i = 0; i < sorted.size(); ++i) {
        const TriangleCorners& v = sorted[i].corners;
        if (v[0] == v[1] || v[1] == v[2]) {
            ++graph.degenerateTriangles;
        } else if (i > 0 && v == sorted[i - 1].corners) {
            ++graph.duplicateTriangles;
        } else {
            soup.triangles.push_back(v);
            soup.partOf.push_back(s.partOf.empty() ? 0 : s.partOf[sorted[i].triangle]);
        }
    }
    return soup;
}

} // namespace i2b
