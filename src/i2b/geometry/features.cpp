// Steps, each the same on any number of threads (parallel loops write to their own slots, sorts have unique keys):
//   1. weld     points on a hash grid, each to the lowest-numbered one within the tolerance      feature_soup.cpp
//   2. clean    triangles over welded points; collapsed ones and all but the first of equals go
//   3. bridge   a needle lower than the tolerance has no plane: its long side is the chain       feature_edges.cpp
//               of its two short ones
//   4. sides    (edge, triangle, direction of the triangle away from the edge), sorted by edge
//   5. judge    each edge by the fold between the directions
//   6. name     the lines from files; inside boxes the edges that boxes ask for                  named_features.cpp
//   7. corners  where lines end, meet or turn                                                    feature_corners.cpp
//   8. keep     and number what is of any kind
#include "i2b/geometry/features.h"
#include "i2b/core/checksum.h"
#include "i2b/core/collect.h"
#include "i2b/geometry/feature_corners.h"
#include "i2b/geometry/feature_edges.h"
#include "i2b/geometry/named_features.h"
#include <algorithm>
#include <fmt/format.h>

namespace i2b {
namespace {

// Facts about the soup, before boxes cut its edges.
void countFaults(const FeatureSoup& soup, const RawVector<FeatureEdge>& all, FeatureGraph& graph) {
    struct Faults {
        std::uint64_t open = 0, nonManifold = 0;
        double openLength = 0;
    };
    const Faults faults = orderedReduce(all.size(), Faults{}, [&](std::size_t begin, std::size_t end) {
        Faults f;
        for (std::size_t i = begin; i < end; ++i) {
            const FeatureEdge& e = all[i];
            if (e.kinds & bitOf(EdgeKind::free)) ++f.open, f.openLength += norm(soup.points[e.b] - soup.points[e.a]);
            if (e.kinds & bitOf(EdgeKind::nonManifold)) ++f.nonManifold;
        }
        return f;
    }, [](const Faults& a, const Faults& b) { return Faults{a.open + b.open, a.nonManifold + b.nonManifold, a.openLength + b.openLength}; });
    graph.openEdges += faults.open, graph.nonManifoldEdges += faults.nonManifold, graph.openEdgeLength += faults.openLength;
}

void countLines(FeatureGraph& graph) {
    for (const FeatureEdge& e : graph.edges) {
        const double length = norm(graph.points[e.b] - graph.points[e.a]);
        if (e.kinds & bitOf(EdgeKind::sharp)) ++graph.sharpEdges, graph.sharpEdgeLength += length;
        if (e.kinds & bitOf(EdgeKind::named)) ++graph.namedEdges, graph.namedEdgeLength += length;
    }
}

void keepFeatures(const FeatureSoup& soup, const RawVector<FeatureEdge>& all, const std::vector<std::uint32_t>& corners, FeatureGraph& graph) {
    const RawVector<FeatureEdge> kept = collect<FeatureEdge>(all.size(), [&](std::size_t i, const auto& put) {
        if (all[i].kinds != 0) put(all[i]);
    });
    std::vector<std::uint32_t> numberOf(soup.points.size(), 0); // first whether a point is used, then how many used ones are before it
    for (const std::uint32_t c : corners) numberOf[c] = 1;
    for (const FeatureEdge& e : kept) numberOf[e.a] = numberOf[e.b] = 1;
    const RawVector<std::uint32_t> used = collect<std::uint32_t>(numberOf.size(), [&](std::size_t p, const auto& put) {
        if (numberOf[p] != 0) put(static_cast<std::uint32_t>(p));
    });
    exclusiveScan(numberOf);
    graph.points.resize(used.size());
    parallelFor(used.size(), [&](std::size_t i) { graph.points[i] = soup.points[used[i]]; }, 4096);
    graph.edges.resize(kept.size());
    parallelFor(kept.size(), [&](std::size_t i) { // they ascend with the points: the order stays
        FeatureEdge& e = graph.edges[i] = kept[i];
        e.a = numberOf[e.a], e.b = numberOf[e.b];
    }, 4096);
    for (const std::uint32_t c : corners) graph.corners.push_back(numberOf[c]);
}

} // namespace

FeatureOptions featureOptions(const GeometryOptions& geometry, const FeatureLines& lines) {
    return {geometry.featureAngle, 0, geometry.featureParts, geometry.featureBoxes, lines, geometry.creaseAngle};
}

FeatureGraph buildFeatureGraph(const Surface& surface, const FeatureOptions& options) {
    FeatureGraph graph;
    graph.weldTolerance = options.weldTolerance, graph.crease = options.crease;
    FeatureSoup soup = weldSoup(surface, options.lines, graph);
    RawVector<FeatureEdge> all =
        judgeEdges(soup, {options.angle, options.crease}, namedParts(surface.parts, options.parts, graph.notes), graph);
    countFaults(soup, all, graph);
    addLines(soup, all);
    applyBoxes(options.boxes, graph.weldTolerance, soup, all);
    std::vector<std::uint32_t> corners = findCorners(soup.points, all, options.angle);
    addCorners(soup.corners, corners);
    keepFeatures(soup, all, corners, graph);
    countLines(graph);
    noteFarLines(surface, options.lines, graph.notes);
    return graph;
}

std::string FeatureGraph::validate() const {
    for (std::size_t i = 0; i < points.size(); ++i)
        if (!isFinite(points[i])) return fmt::format("feature point {} is not finite", i);
    for (std::size_t i = 0; i < edges.size(); ++i) {
        const FeatureEdge& e = edges[i];
        if (e.a >= e.b || e.b >= points.size())
            return fmt::format("feature edge {} runs from point {} to {} of {}", i, e.a, e.b, points.size());
        if (e.kinds == 0 || e.kinds > 127) return fmt::format("feature edge {} has kinds {}", i, e.kinds);
        if (!(e.angle >= 0 && e.angle <= 180)) return fmt::format("feature edge {} has angle {}", i, e.angle);
        if (i > 0 && !(std::pair{edges[i - 1].a, edges[i - 1].b} < std::pair{e.a, e.b}))
            return fmt::format("feature edge {} is out of order", i);
    }
    for (std::size_t i = 0; i < corners.size(); ++i) {
        if (corners[i] >= points.size()) return fmt::format("feature corner {} is point {}", i, corners[i]);
        if (i > 0 && corners[i] <= corners[i - 1]) return fmt::format("feature corner {} is out of order", i);
    }
    return "";
}

std::uint64_t FeatureGraph::checksum() const {
    Checksum c;
    c.add(std::span<const Vec3>(points));
    c.add(edges.size());
    for (const FeatureEdge& e : edges) { // not as bytes: the struct has padding
        c.add(e.a);
        c.add(e.b);
        c.add(e.kinds);
        c.add(e.angle);
    }
    c.add(std::span<const std::uint32_t>(corners));
    for (const std::uint64_t n :
         {weldedPoints, duplicateTriangles, degenerateTriangles, openEdges, nonManifoldEdges, sharpEdges,
          namedEdges, rimEdges})
        c.add(n);
    return c.value();
}

} // namespace i2b
