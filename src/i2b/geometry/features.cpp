// Steps, each the same on any number of threads (parallel loops write to their own slots, sorts have unique
// keys):
//   1. weld     points on a hash grid, each to the lowest-numbered one within the tolerance
//   2. clean    triangles over welded points; collapsed ones and all but the first of equals go
//   3. bridge   a needle lower than the tolerance has no plane: its long side is the chain of its two short
//   ones
//   4. sides    (edge, triangle, direction of the triangle away from the edge), sorted by edge
//   5. judge    each edge by the fold between the directions; then number what is kept, and find the corners
#include "i2b/geometry/features.h"
#include "i2b/core/checksum.h"
#include "i2b/core/parallel.h"
#include <algorithm>
#include <fmt/format.h>
#include <numbers>
#include <tbb/parallel_sort.h>

namespace i2b {
namespace {

constexpr std::uint32_t none = ~0u;
using Corners = std::array<std::uint32_t, 3>;

std::uint8_t bit(EdgeKind kind) { return static_cast<std::uint8_t>(kind); }

// ---- 1. weld
// ---------------------------------------------------------------------------------------------------

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
std::vector<std::uint32_t> weldTargets(const Surface& s, const std::vector<std::uint32_t>& used,
                                       double tolerance, const Box& bounds) {
    // Never so small that a cell's number overflows.
    const PointGrid grid{bounds.lo, std::max({4 * tolerance, 1e-15 * norm(bounds.extent()), 1e-300})};
    std::vector<HashedPoint> sorted(used.size());
    parallelFor(used.size(), [&](std::size_t i) {
        sorted[i] = {grid.at(s.points[used[i]]).hash(), used[i]};
    });
    tbb::parallel_sort(sorted);
    std::vector<std::uint32_t> target(s.points.size(), none);
    const double limit = tolerance * tolerance;
    parallelFor(sorted.size(), [&](std::size_t i) {
        const std::uint32_t self = sorted[i].point;
        const Vec3 p = s.points[self], r{tolerance, tolerance, tolerance};
        const GridCell lo = grid.at(p - r), hi = grid.at(p + r);
        std::uint32_t best = self;
        const auto look = [&](std::uint64_t hash, std::size_t from) {
            for (; from < sorted.size() && sorted[from].hash == hash && sorted[from].point < best; ++from)
                if (norm2(s.points[sorted[from].point] - p) <= limit) best = sorted[from].point;
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
    for (std::size_t i = 0; i < target.size();
         ++i) // ascending: a target's own target is already its last one
        if (target[i] != none) target[i] = target[target[i]];
    return target;
}

// ---- 2. clean
// --------------------------------------------------------------------------------------------------

struct Soup {
    std::vector<Vec3> points;       // welded
    std::vector<Corners> triangles; // of different points, each set of corners once
    std::vector<std::int32_t> partOf;
};

struct SortedCorners {
    Corners corners;        // ascending
    std::uint32_t triangle; // in the surface
    friend auto operator<=>(const SortedCorners&, const SortedCorners&) = default;
};

void numberPoints(const Surface& s, std::vector<std::uint32_t>& target, Soup& soup) {
    std::vector<std::uint32_t> number(target.size(), none);
    for (std::size_t i = 0; i < target.size(); ++i) {
        if (target[i] == none) continue;
        if (target[i] == i) {
            number[i] = static_cast<std::uint32_t>(soup.points.size());
            soup.points.push_back(s.points[i]);
        }
        target[i] = number[target[i]];
    }
}

Soup weld(const Surface& s, FeatureGraph& graph) {
    std::vector<bool> isUsed(s.points.size());
    for (const Corners& t : s.triangles)
        for (const std::uint32_t p : t) isUsed[p] = true;
    std::vector<std::uint32_t> used;
    Box bounds;
    for (std::uint32_t i = 0; i < isUsed.size(); ++i)
        if (isUsed[i]) used.push_back(i), bounds.add(s.points[i]);
    if (graph.weldTolerance <= 0 && !used.empty()) graph.weldTolerance = 1e-6 * norm(bounds.extent());

    Soup soup;
    std::vector<std::uint32_t> target = weldTargets(s, used, graph.weldTolerance, bounds);
    numberPoints(s, target, soup);
    graph.weldedPoints = soup.points.size();

    std::vector<SortedCorners> sorted(s.triangles.size());
    parallelFor(sorted.size(), [&](std::size_t t) {
        const Corners& v = s.triangles[t];
        sorted[t] = {{target[v[0]], target[v[1]], target[v[2]]}, static_cast<std::uint32_t>(t)};
        std::sort(sorted[t].corners.begin(), sorted[t].corners.end());
    });
    tbb::parallel_sort(sorted);
    for (std::size_t i = 0; i < sorted.size(); ++i) {
        const Corners& v = sorted[i].corners;
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

// ---- 3. bridge and 4. sides
// --------------------------------------------------------------------------------------

struct EdgeKey {
    std::uint32_t a, b; // a < b
    friend auto operator<=>(const EdgeKey&, const EdgeKey&) = default;
};
EdgeKey keyOf(std::uint32_t a, std::uint32_t b) { return a < b ? EdgeKey{a, b} : EdgeKey{b, a}; }

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
std::size_t needleApex(const Soup& soup, const Corners& t, double tolerance) {
    std::size_t apex = 0;
    double longest = -1;
    for (std::size_t k = 0; k < 3; ++k)
        if (const double l = norm2(soup.points[t[(k + 1) % 3]] - soup.points[t[(k + 2) % 3]]); l > longest)
            longest = l, apex = k;
    const Vec3 &a = soup.points[t[0]], &b = soup.points[t[1]], &c = soup.points[t[2]];
    return norm(cross(b - a, c - a)) <= tolerance * std::sqrt(longest) ? apex : 3;
}

// The side of a triangle along an edge, or along the chain that stands for it.
void addSides(const std::vector<Bridge>& bridges, Side side, int depth, std::vector<Side>& sides) {
    const auto found = std::lower_bound(bridges.begin(), bridges.end(), Bridge{side.edge, 0});
    if (depth == 0 || found == bridges.end() || found->edge != side.edge || found->middle == side.apex) {
        sides.push_back(side);
        return;
    }
    const EdgeKey edge = side.edge;
    side.edge = keyOf(edge.a, found->middle);
    addSides(bridges, side, depth - 1, sides);
    side.edge = keyOf(found->middle, edge.b);
    addSides(bridges, side, depth - 1, sides);
}

std::vector<Side> collectSides(const Soup& soup, FeatureGraph& graph) {
    std::vector<std::uint8_t> needle(soup.triangles.size());
    parallelFor(needle.size(), [&](std::size_t t) {
        needle[t] = static_cast<std::uint8_t>(needleApex(soup, soup.triangles[t], graph.weldTolerance));
    });
    std::vector<Bridge> bridges;
    for (std::size_t t = 0; t < needle.size(); ++t) {
        if (needle[t] == 3) continue;
        const Corners& v = soup.triangles[t];
        bridges.push_back({keyOf(v[(needle[t] + 1u) % 3], v[(needle[t] + 2u) % 3]), v[needle[t]]});
    }
    graph.degenerateTriangles += bridges.size();
    std::sort(bridges.begin(), bridges.end());
    std::vector<Side> sides;
    sides.reserve(3 * soup.triangles.size());
    for (std::size_t t = 0; t < needle.size(); ++t) {
        if (needle[t] != 3) continue;
        const Corners& v = soup.triangles[t];
        for (std::size_t k = 0; k < 3; ++k)
            addSides(bridges, {keyOf(v[k], v[(k + 1) % 3]), static_cast<std::uint32_t>(t), v[(k + 2) % 3]}, 8,
                     sides);
    }
    tbb::parallel_sort(sides);
    return sides;
}

// ---- 5. judge
// ----------------------------------------------------------------------------------------------------

// Degrees between the planes of two triangles that leave the edge along u and v: 0 flat, 180 folded back.
double fold(const Vec3& u, const Vec3& v) {
    return std::atan2(norm(cross(u, v)), -dot(u, v)) * (180 / std::numbers::pi);
}

// Of each triangle the fold to the one that continues it best; the largest of these. Two triangles: their
// fold.
double largestFold(const Soup& soup, const Side* sides, std::size_t n) {
    if (n < 2) return 0;
    const Vec3 a = soup.points[sides[0].edge.a], e = normalized(soup.points[sides[0].edge.b] - a);
    const auto direction = [&](std::size_t i) {
        const Vec3 d = soup.points[sides[i].apex] - a;
        return d - e * dot(d, e);
    };
    double largest = 0;
    for (std::size_t i = 0; i < n; ++i) {
        double best = 180;
        for (std::size_t j = 0; j < n; ++j) {
            if (j == i) continue;
            const double f = fold(direction(i), direction(j));
            best = std::min(best, f);
            if (n > 2) largest = std::max(largest, std::min(f, 180 - f));
        }
        largest = std::max(largest, best);
    }
    return largest;
}

FeatureEdge judge(const Soup& soup, const Side* sides, std::size_t n, double limit) {
    FeatureEdge edge{sides[0].edge.a, sides[0].edge.b, 0, 0};
    const double angle = largestFold(soup, sides, n);
    edge.angle = static_cast<float>(angle);
    if (angle > limit) edge.kinds |= bit(EdgeKind::sharp);
    if (n == 1) edge.kinds |= bit(EdgeKind::free);
    if (n > 2) edge.kinds |= bit(EdgeKind::nonManifold);
    for (std::size_t i = 1; i < n; ++i)
        if (soup.partOf[sides[i].triangle] != soup.partOf[sides[0].triangle])
            edge.kinds |= bit(EdgeKind::partBorder);
    return edge;
}

std::vector<FeatureEdge> judgeAll(const Soup& soup, const std::vector<Side>& sides, double limit) {
    std::vector<std::size_t> start;
    start.reserve(sides.size() / 2 + 1);
    for (std::size_t i = 0; i < sides.size(); ++i)
        if (i == 0 || sides[i].edge != sides[i - 1].edge) start.push_back(i);
    start.push_back(sides.size());
    std::vector<FeatureEdge> edges(start.size() - 1);
    parallelFor(edges.size(), [&](std::size_t i) {
        edges[i] = judge(soup, &sides[start[i]], start[i + 1] - start[i], limit);
    });
    return edges;
}

// What meets at a point, seen from it.
struct Meeting {
    std::uint32_t sharpEdges = 0;
    Vec3 first, second; // directions of two of them
    bool continued =
        false; // one sharp edge only, but a milder fold goes straight on: a bend that fades, no corner
};

// A tessellated radius folds by a little more here, a little less there than the limit. Its line is cut in
// pieces then, whose ends would make most of the corners of a curved body.
void markContinued(const Soup& soup, const std::vector<FeatureEdge>& all, double limit,
                   std::vector<Meeting>& meetings) {
    for (const FeatureEdge& e : all) {
        if ((e.kinds & bit(EdgeKind::sharp)) || e.angle < limit / 2) continue;
        const Vec3 d = normalized(soup.points[e.b] - soup.points[e.a]);
        for (const auto& [point, away] : {std::pair{e.a, d}, std::pair{e.b, -d}}) {
            Meeting& m = meetings[point];
            if (m.sharpEdges == 1 && fold(m.first, away) <= limit) m.continued = true;
        }
    }
}

// Of the soup's points, ascending.
std::vector<std::uint32_t> findCorners(const Soup& soup, const std::vector<FeatureEdge>& all, double limit) {
    std::vector<Meeting> meetings(soup.points.size());
    for (const FeatureEdge& e : all) {
        if (!(e.kinds & bit(EdgeKind::sharp))) continue;
        const Vec3 d = normalized(soup.points[e.b] - soup.points[e.a]);
        for (const auto& [point, away] : {std::pair{e.a, d}, std::pair{e.b, -d}}) {
            Meeting& m = meetings[point];
            (m.sharpEdges++ == 0 ? m.first : m.second) = away;
        }
    }
    markContinued(soup, all, limit, meetings);
    std::vector<std::uint32_t> corners;
    for (std::uint32_t i = 0; i < meetings.size(); ++i) {
        const Meeting& m = meetings[i];
        if (m.sharpEdges == 0 || m.continued) continue;
        if (m.sharpEdges != 2 || fold(m.first, m.second) > limit) corners.push_back(i);
    }
    return corners;
}

void keepFeatures(const Soup& soup, const std::vector<FeatureEdge>& all,
                  const std::vector<std::uint32_t>& corners, FeatureGraph& graph) {
    std::vector<std::uint32_t> number(soup.points.size(), none);
    for (const FeatureEdge& e : all) {
        const double length = norm(soup.points[e.b] - soup.points[e.a]);
        if (e.kinds & bit(EdgeKind::free)) ++graph.openEdges, graph.openEdgeLength += length;
        if (e.kinds & bit(EdgeKind::nonManifold)) ++graph.nonManifoldEdges;
        if (e.kinds & bit(EdgeKind::sharp)) ++graph.sharpEdges, graph.sharpEdgeLength += length;
        if (e.kinds != 0) number[e.a] = number[e.b] = 0;
    }
    for (std::size_t i = 0; i < number.size(); ++i) {
        if (number[i] == none) continue;
        number[i] = static_cast<std::uint32_t>(graph.points.size());
        graph.points.push_back(soup.points[i]);
    }
    for (FeatureEdge e : all) { // numbers ascend with the points: the order stays
        if (e.kinds == 0) continue;
        e.a = number[e.a];
        e.b = number[e.b];
        graph.edges.push_back(e);
    }
    for (const std::uint32_t c : corners) graph.corners.push_back(number[c]);
}

} // namespace

FeatureGraph buildFeatureGraph(const Surface& surface, const FeatureOptions& options) {
    FeatureGraph graph;
    graph.weldTolerance = options.weldTolerance;
    const Soup soup = weld(surface, graph);
    const std::vector<Side> sides = collectSides(soup, graph);
    const std::vector<FeatureEdge> all = judgeAll(soup, sides, options.angle);
    keepFeatures(soup, all, findCorners(soup, all, options.angle), graph);
    return graph;
}

std::string FeatureGraph::validate() const {
    for (std::size_t i = 0; i < points.size(); ++i)
        if (!isFinite(points[i])) return fmt::format("feature point {} is not finite", i);
    for (std::size_t i = 0; i < edges.size(); ++i) {
        const FeatureEdge& e = edges[i];
        if (e.a >= e.b || e.b >= points.size())
            return fmt::format("feature edge {} runs from point {} to {} of {}", i, e.a, e.b, points.size());
        if (e.kinds == 0 || e.kinds > 15) return fmt::format("feature edge {} has kinds {}", i, e.kinds);
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
         {weldedPoints, duplicateTriangles, degenerateTriangles, openEdges, nonManifoldEdges, sharpEdges})
        c.add(n);
    return c.value();
}

} // namespace i2b
