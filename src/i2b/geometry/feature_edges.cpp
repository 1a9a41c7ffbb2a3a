#include "i2b/geometry/feature_edges.h"
#include "i2b/core/bucket_sort.h"
#include "i2b/core/collect.h"
#include <algorithm>

namespace i2b {
namespace {

// The long side of a needle, and the point that lies on it.
struct Bridge {
    EdgeKey edge;
    std::uint32_t middle;
    friend auto operator<=>(const Bridge&, const Bridge&) = default;
};

struct Side {
    EdgeKey edge;
    std::uint32_t triangle, apex; // apex: the corner that tells the direction away from the edge
    friend auto operator<=>(const Side&, const Side&) = default;
};

// The corner opposite to the longest side if it is nearer to that side than the tolerance, else 3.
std::size_t needleApex(const FeatureSoup& soup, const TriangleCorners& t, double tolerance) {
    std::size_t apex = 0;
    double longest = -1;
    for (std::size_t k = 0; k < 3; ++k)
        if (const double l = norm2(soup.points[t[(k + 1) % 3]] - soup.points[t[(k + 2) % 3]]); l > longest)
            longest = l, apex = k;
    const Vec3 &a = soup.points[t[0]], &b = soup.points[t[1]], &c = soup.points[t[2]];
    return norm(cross(b - a, c - a)) <= tolerance * std::sqrt(longest) ? apex : 3;
}

// The side of a triangle along an edge, or along the chain that stands for it.
template <class Put>
void addSides(const RawVector<Bridge>& bridges, Side side, int depth, const Put& put) {
    const auto found = std::lower_bound(bridges.begin(), bridges.end(), Bridge{side.edge, 0});
    if (depth == 0 || found == bridges.end() || found->edge != side.edge || found->middle == side.apex) {
        put(side);
        return;
    }
    const EdgeKey edge = side.edge;
    side.edge = keyOf(edge.a, found->middle);
    addSides(bridges, side, depth - 1, put);
    side.edge = keyOf(found->middle, edge.b);
    addSides(bridges, side, depth - 1, put);
}

RawVector<Side> collectSides(const FeatureSoup& soup, FeatureGraph& graph) {
    std::vector<std::uint8_t> needle(soup.triangles.size());
    parallelFor(needle.size(), [&](std::size_t t) {
        needle[t] = static_cast<std::uint8_t>(needleApex(soup, soup.triangles[t], graph.weldTolerance));
    });
    RawVector<Bridge> bridges = collect<Bridge>(needle.size(), [&](std::size_t t, const auto& put) {
        const TriangleCorners& v = soup.triangles[t];
        if (needle[t] != 3) put({keyOf(v[(needle[t] + 1u) % 3], v[(needle[t] + 2u) % 3]), v[needle[t]]});
    });
    graph.degenerateTriangles += bridges.size();
    std::sort(bridges.begin(), bridges.end());
    RawVector<Side> sides = collect<Side>(needle.size(), [&](std::size_t t, const auto& put) {
        if (needle[t] != 3) return;
        const TriangleCorners& v = soup.triangles[t];
        for (std::size_t k = 0; k < 3; ++k)
            addSides(bridges, {keyOf(v[k], v[(k + 1) % 3]), static_cast<std::uint32_t>(t), v[(k + 2) % 3]}, 8, put);
    });
    bucketSort(sides, soup.points.size(), [](const Side& s) { return std::size_t(s.edge.a); });
    return sides;
}

// Of each triangle the fold to the one that continues it best; the largest of these. Two triangles: their fold.
double largestFold(const FeatureSoup& soup, const Side* sides, std::size_t n) {
    if (n < 2) return 0;
    const Vec3 a = soup.points[sides[0].edge.a], e = normalized(soup.points[sides[0].edge.b] - a);
    const auto direction = [&](std::size_t i) {
        const Vec3 d = soup.points[sides[i].apex] - a;
        return d - e * dot(d, e);
    };
    if (n == 2) return fold(direction(0), direction(1));
    double largest = 0;
    for (std::size_t i = 0; i < n; ++i) {
        double best = 180;
        for (std::size_t j = 0; j < n; ++j) {
            if (j == i) continue;
            const double f = fold(direction(i), direction(j));
            best = std::min(best, f);
            largest = std::max(largest, std::min(f, 180 - f));
        }
        largest = std::max(largest, best);
    }
    return largest;
}

FeatureEdge judge(const FeatureSoup& soup, const Side* sides, std::size_t n, const FoldLimits& limits,
                  const std::vector<bool>& isNamed) {
    FeatureEdge edge{sides[0].edge.a, sides[0].edge.b, 0, 0};
    const double angle = largestFold(soup, sides, n);
    edge.angle = static_cast<float>(angle);
    bool border = false, named = false;
    for (std::size_t i = 0; i < n; ++i) {
        const std::int32_t part = soup.partOf[sides[i].triangle];
        border = border || part != soup.partOf[sides[0].triangle];
        named = named || (static_cast<std::size_t>(part) < isNamed.size() && isNamed[static_cast<std::size_t>(part)]);
    }
    edge.kinds |= kindOfFold(angle, limits);
    if (n == 1) edge.kinds |= bitOf(EdgeKind::free);
    if (n > 2) edge.kinds |= bitOf(EdgeKind::nonManifold);
    if (border) edge.kinds |= bitOf(EdgeKind::partBorder);
    if (named && (border || n == 1)) edge.kinds |= bitOf(EdgeKind::named);
    return edge;
}

} // namespace

std::uint8_t kindOfFold(double fold, const FoldLimits& limits) {
    if (fold > limits.sharp) return bitOf(EdgeKind::sharp);
    return limits.sharp < 180 && fold > limits.crease && fold <= mostCrease ? bitOf(EdgeKind::crease) : 0;
}

RawVector<FeatureEdge> judgeEdges(const FeatureSoup& soup, const FoldLimits& limits, const std::vector<bool>& isNamed,
                                    FeatureGraph& graph) {
    const RawVector<Side> sides = collectSides(soup, graph);
    const RawVector<std::size_t> start = collect<std::size_t>(sides.size() + 1, [&](std::size_t i, const auto& put) {
        if (i == 0 || i == sides.size() || sides[i].edge != sides[i - 1].edge) put(i);
    });
    RawVector<FeatureEdge> edges(start.size() - 1);
    parallelFor(edges.size(), [&](std::size_t i) {
        edges[i] = judge(soup, &sides[start[i]], start[i + 1] - start[i], limits, isNamed);
    });
    return edges;
}

} // namespace i2b
