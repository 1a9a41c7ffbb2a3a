#include "i2b/geometry/inspect.h"
#include "i2b/core/parallel.h"
#include <bit>
#include <cmath>
#include <tbb/combinable.h>

namespace i2b {
namespace {

struct PartSum {
    std::int32_t part = 0;
    Box box;
    double area = 0;
};

// One pass whatever the number of parts: each chunk gives a sum for every run of one part, joined in order.
void sumParts(const Surface& s, InspectReport& report) {
    constexpr std::size_t chunk = 4096;
    std::vector<std::vector<PartSum>> sums((s.triangles.size() + chunk - 1) / chunk);
    parallelChunks(s.triangles.size(), chunk, [&](std::size_t begin, std::size_t end, std::size_t c) {
        for (std::size_t t = begin; t != end; ++t) {
            if (sums[c].empty() || sums[c].back().part != s.partOf[t])
                sums[c].push_back({s.partOf[t], {}, 0});
            PartSum& sum = sums[c].back();
            const auto& v = s.triangles[t];
            for (const std::uint32_t i : v) sum.box.add(s.points[i]);
            sum.area += 0.5 * norm(cross(s.points[v[1]] - s.points[v[0]], s.points[v[2]] - s.points[v[0]]));
        }
    });
    for (const auto& chunkSums : sums)
        for (const PartSum& sum : chunkSums) {
            PartFigures& part = report.parts[static_cast<std::size_t>(sum.part)];
            part.box.add(sum.box);
            part.area += sum.area;
        }
    for (const PartFigures& part : report.parts) report.bounds.add(part.box), report.area += part.area;
}

float edgeLength(const Surface& s, std::size_t t, std::size_t k) {
    const auto& v = s.triangles[t];
    return static_cast<float>(norm(s.points[v[(k + 1) % 3]] - s.points[v[k]]));
}

// Counts keyOf(bits of the length) over all edges that accept() takes. Integers: the order of adding does not
// matter.
template <class Accept, class KeyOf>
std::vector<std::uint64_t> edgeHistogram(const Surface& s, const Accept& accept, const KeyOf& keyOf) {
    constexpr std::size_t bins = std::size_t{1} << 16;
    tbb::combinable<std::vector<std::uint64_t>> counts([] { return std::vector<std::uint64_t>(bins); });
    parallelChunks(s.triangles.size(), 1 << 14, [&](std::size_t begin, std::size_t end, std::size_t) {
        std::vector<std::uint64_t>& own = counts.local();
        for (std::size_t t = begin; t != end; ++t)
            for (std::size_t k = 0; k < 3; ++k) {
                const auto bits = std::bit_cast<std::uint32_t>(edgeLength(s, t, k));
                if (accept(bits)) ++own[keyOf(bits)];
            }
    });
    std::vector<std::uint64_t> total(bins);
    counts.combine_each([&](const std::vector<std::uint64_t>& own) {
        for (std::size_t i = 0; i < bins; ++i) total[i] += own[i];
    });
    return total;
}

// The bin that holds the item of this rank, which becomes its rank within the bin.
std::uint32_t binOf(const std::vector<std::uint64_t>& counts, std::uint64_t& rank) {
    std::uint32_t bin = 0;
    while (rank >= counts[bin]) rank -= counts[bin++];
    return bin;
}

// Floats that are not negative order as their bits do: the upper half is found first, then the lower, with no
// list.
double medianEdge(const Surface& s) {
    if (s.triangles.empty()) return 0;
    std::uint64_t rank = (3 * s.triangles.size() - 1) / 2;
    const auto upper = edgeHistogram(
        s, [](std::uint32_t) { return true; }, [](std::uint32_t bits) { return bits >> 16; });
    const std::uint32_t high = binOf(upper, rank);
    const auto lower = edgeHistogram(
        s, [&](std::uint32_t bits) { return bits >> 16 == high; },
        [](std::uint32_t bits) { return bits & 0xFFFFu; });
    return double(std::bit_cast<float>(high << 16 | binOf(lower, rank)));
}

void measureEdges(const Surface& s, InspectReport& report) {
    struct Range {
        double lo2 = std::numeric_limits<double>::infinity(), hi2 = 0;
    };
    const Range range = orderedReduce(
        s.triangles.size(), Range{},
        [&](std::size_t begin, std::size_t end) {
            Range r;
            for (std::size_t t = begin; t != end; ++t)
                for (std::size_t k = 0; k < 3; ++k) {
                    const auto& v = s.triangles[t];
                    const double l2 = norm2(s.points[v[(k + 1) % 3]] - s.points[v[k]]);
                    if (l2 > 0) r.lo2 = std::min(r.lo2, l2);
                    r.hi2 = std::max(r.hi2, l2);
                }
            return r;
        },
        [](const Range& a, const Range& b) {
            return Range{std::min(a.lo2, b.lo2), std::max(a.hi2, b.hi2)};
        });
    report.smallestEdge = range.hi2 > 0 ? std::sqrt(range.lo2) : 0;
    report.largestEdge = std::sqrt(range.hi2);
    report.medianEdge = medianEdge(s);
}

void takeFeatures(const FeatureGraph& f, InspectReport& report) {
    report.weldTolerance = f.weldTolerance;
    report.weldedPoints = f.weldedPoints;
    report.degenerateTriangles = f.degenerateTriangles;
    report.duplicateTriangles = f.duplicateTriangles;
    report.openEdges = f.openEdges;
    report.nonManifoldEdges = f.nonManifoldEdges;
    report.sharpEdges = f.sharpEdges;
    report.namedEdges = f.namedEdges;
    report.namedEdgeLength = f.namedEdgeLength;
    report.corners = f.corners.size();
    report.openEdgeLength = f.openEdgeLength;
    report.sharpEdgeLength = f.sharpEdgeLength;
    for (const FeatureEdge& e : f.edges) {
        report.partBorderEdges += (e.kinds & static_cast<std::uint8_t>(EdgeKind::partBorder)) != 0;
        if (e.kinds & static_cast<std::uint8_t>(EdgeKind::nonManifold))
            report.nonManifoldEdgeLength += norm(f.points[e.b] - f.points[e.a]);
    }
}

} // namespace

double suggestSize(double longestExtent, double medianEdge) {
    if (!(longestExtent > 0)) return 0;
    const double coarse = longestExtent / 128;
    const double detail = medianEdge > 0 ? std::min(medianEdge, coarse) : coarse;
    const double size = std::clamp(std::sqrt(coarse * detail), longestExtent / 1000, longestExtent / 50);
    // A part in 10^9 more, so that 0.2 stays 0.2 where rounding made it less.
    const double power = std::floor(std::log10(size * (1 + 1e-9)));
    const double mantissa = size * (1 + 1e-9) / std::pow(10, power);
    const double digit = mantissa >= 5 ? 5 : mantissa >= 2 ? 2 : 1;
    return power < 0 ? digit / std::pow(10, -power)
                     : digit * std::pow(10, power); // 0.02, not 0.020000000000000004
}

InspectReport inspect(const Surface& surface, const FeatureGraph& features) {
    InspectReport report;
    for (const Part& part : surface.parts)
        report.parts.push_back({part.name, part.file, part.triangles, {}, 0});
    report.triangles = surface.triangles.size();
    report.points = surface.points.size();
    report.segments = surface.segments.size();
    report.freePoints = surface.freePoints.size();
    sumParts(surface, report);
    measureEdges(surface, report);
    takeFeatures(features, report);
    const Vec3 extent = report.bounds.empty() ? Vec3{} : report.bounds.extent();
    report.suggestedSize = suggestSize(std::max({extent.x, extent.y, extent.z}), report.medianEdge);
    return report;
}

} // namespace i2b
