#include "i2b/geometry/feature_soup.h"
#include "i2b/core/bucket_sort.h"
#include "i2b/core/collect.h"
#include <algorithm>
#include <atomic>
#include <bit>
#include <functional>
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
RawVector<std::uint32_t> weldTargets(std::span<const Vec3> points, std::span<const std::uint32_t> used,
                                       double tolerance, const Box& bounds) {
    // Never so small that a cell's number overflows.
    const PointGrid grid{bounds.lo, std::max({4 * tolerance, 1e-15 * norm(bounds.extent()), 1e-300})};
    RawVector<HashedPoint> sorted(used.size());
    parallelFor(used.size(), [&](std::size_t i) {
        sorted[i] = {grid.at(points[used[i]]).hash(), used[i]};
    });
    const auto bits = static_cast<int>(std::bit_width(sorted.size() / 4));
    bucketSort(sorted, std::size_t(1) << bits, [&](const HashedPoint& h) { return static_cast<std::size_t>(bits == 0 ? 0 : h.hash >> (64 - bits)); });
    RawVector<std::uint32_t> nearest(points.size());
    parallelFor(nearest.size(), [&](std::size_t i) { nearest[i] = none; }, 4096);
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
        nearest[self] = best;
    });
    RawVector<std::uint32_t> target(points.size());
    parallelFor(target.size(), [&](std::size_t i) { // down the chain to one that is its own
        std::uint32_t t = nearest[i];
        while (t != none && nearest[t] != t) t = nearest[t];
        target[i] = t;
    }, 4096);
    return target;
}

struct SortedCorners {
    TriangleCorners corners;        // ascending
    std::uint32_t triangle; // in the surface
    friend auto operator<=>(const SortedCorners&, const SortedCorners&) = default;
};

// Numbers the welded points and turns targets into these numbers; gives how many come from the first `own` points.
std::size_t numberPoints(std::span<const Vec3> points, std::size_t own, RawVector<std::uint32_t>& target, FeatureSoup& soup) {
    const RawVector<std::uint32_t> roots = collect<std::uint32_t>(target.size(), [&](std::size_t i, const auto& put) {
        if (target[i] == i) put(static_cast<std::uint32_t>(i));
    });
    soup.points.resize(roots.size());
    RawVector<std::uint32_t> number(target.size()); // read of roots alone
    parallelFor(roots.size(), [&](std::size_t n) {
        soup.points[n] = points[roots[n]];
        number[roots[n]] = static_cast<std::uint32_t>(n);
    });
    parallelFor(target.size(), [&](std::size_t i) {
        if (target[i] != none) target[i] = number[target[i]];
    }, 4096);
    return static_cast<std::size_t>(std::lower_bound(roots.begin(), roots.end(), own) - roots.begin());
}

// Those of three different points, each set of points once.
void takeTriangles(const Surface& s, const RawVector<SortedCorners>& sorted, FeatureGraph& graph, FeatureSoup& soup) {
    const auto isPoor = [&](std::size_t i) { return sorted[i].corners[0] == sorted[i].corners[1] || sorted[i].corners[1] == sorted[i].corners[2]; };
    const RawVector<std::size_t> kept = collect<std::size_t>(sorted.size(), [&](std::size_t i, const auto& put) {
        if (!isPoor(i) && (i == 0 || sorted[i].corners != sorted[i - 1].corners)) put(i);
    });
    const auto poor = orderedReduce(sorted.size(), std::uint64_t(0), [&](std::size_t begin, std::size_t end) {
        std::uint64_t n = 0;
        for (std::size_t i = begin; i < end; ++i) n += isPoor(i);
        return n;
    }, std::plus<>());
    graph.degenerateTriangles += poor;
    graph.duplicateTriangles += sorted.size() - kept.size() - poor;
    soup.triangles.resize(kept.size()), soup.partOf.resize(kept.size());
    parallelFor(kept.size(), [&](std::size_t i) {
        soup.triangles[i] = sorted[kept[i]].corners;
        soup.partOf[i] = s.partOf.empty() ? 0 : s.partOf[sorted[kept[i]].triangle];
    });
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
    std::vector<std::uint8_t> isUsed(s.points.size());
    parallelFor(s.triangles.size(), [&](std::size_t t) {
        for (const std::uint32_t p : s.triangles[t]) std::atomic_ref(isUsed[p]).store(1, std::memory_order_relaxed);
    }, 4096);
    RawVector<std::uint32_t> used = collect<std::uint32_t>(isUsed.size(), [&](std::size_t i, const auto& put) {
        if (isUsed[i]) put(static_cast<std::uint32_t>(i));
    });
    const Box bounds = s.bounds();
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
    RawVector<std::uint32_t> target = weldTargets(points, used, graph.weldTolerance, bounds);
    graph.weldedPoints = numberPoints(points, s.points.size(), target, soup);
    takeLines(lines, std::span<const std::uint32_t>(target).subspan(s.points.size()), soup);

    RawVector<SortedCorners> sorted(s.triangles.size());
    parallelFor(sorted.size(), [&](std::size_t t) {
        const TriangleCorners& v = s.triangles[t];
        sorted[t] = {{target[v[0]], target[v[1]], target[v[2]]}, static_cast<std::uint32_t>(t)};
        std::sort(sorted[t].corners.begin(), sorted[t].corners.end());
    });
    bucketSort(sorted, soup.points.size(), [](const SortedCorners& c) { return std::size_t(c.corners[0]); });
    takeTriangles(s, sorted, graph, soup);
    return soup;
}

} // namespace i2b
