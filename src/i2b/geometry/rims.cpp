#include "i2b/geometry/rims.h"
#include "i2b/core/parallel.h"
#include "i2b/geometry/feature_corners.h"
#include "i2b/geometry/named_features.h"
#include <algorithm>
#include <array>
#include <optional>

namespace i2b {
namespace {

constexpr double wedge = 0.5;       // cosine of half its angle
constexpr std::size_t mostLooks = 8; // along an edge
constexpr std::array<double, 3> nearToFar{0.03, 0.2, 1}; // of the gap

struct Section { // of a triangle and the plane across the edge, from its middle; m
    Vec3 a, b;
};

// p: the corners seen from a point of the edge, which runs along unit e.
std::optional<Section> sectionOf(const std::array<Vec3, 3>& p, const Vec3& e) {
    std::array<Vec3, 6> at;
    std::size_t n = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        const Vec3 &a = p[k], &b = p[(k + 1) % 3];
        const double sa = dot(a, e), sb = dot(b, e);
        if (sa == 0) at[n++] = a;
        if ((sa < 0 && sb > 0) || (sa > 0 && sb < 0)) at[n++] = a + (b - a) * (sa / (sa - sb));
    }
    if (n == 0) return {};
    // More than two only where the triangle lies in the plane: its longest side stands for it.
    Section longest{at[0], at[0]};
    for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = i + 1; j < n; ++j)
            if (norm2(at[j] - at[i]) > norm2(longest.b - longest.a)) longest = {at[i], at[j]};
    return longest;
}

// The part within radius of the origin.
std::optional<Section> clip(const Section& s, double radius) {
    const Vec3 d = s.b - s.a;
    const double dd = norm2(d), ad = dot(s.a, d), outside = norm2(s.a) - radius * radius;
    if (dd == 0) return outside <= 0 ? std::optional(s) : std::nullopt;
    const double root = ad * ad - dd * outside;
    if (root < 0) return {};
    const double from = std::max(0.0, (-ad - std::sqrt(root)) / dd), to = std::min(1.0, (-ad + std::sqrt(root)) / dd);
    if (from > to) return {};
    return Section{s.a + d * from, s.a + d * to};
}

// Looks at a soup across its free edges.
class Look {
  public:
    Look(const SurfaceIndex& index, double gap, double touch) : index_(index), gap_(gap), touch_(touch) {}

    // Nothing continues the sheet at m on an edge along unit e. What does is most often near: that is looked at first.
    bool endsFreely(const Vec3& m, const Vec3& e) const {
        const Vec3 inwards = inwardsAt(m, e);
        if (inwards == Vec3{}) return false;
        // The wedge is convex: what has both ends in it lies in it.
        const auto inWedge = [&](const Vec3& p) { return norm(p) <= touch_ || dot(p, inwards) >= wedge * norm(p); };
        const auto continues = [&](std::uint32_t t) {
            const std::optional<Section> s = sectionAt(t, m, e);
            return s && !(inWedge(s->a) && inWedge(s->b));
        };
        return std::none_of(nearToFar.begin(), nearToFar.end(), [&](double share) { return index_.any(around(m, share * gap_), continues); });
    }

  private:
    static Box around(const Vec3& m, double r) { return {m - Vec3{r, r, r}, m + Vec3{r, r, r}}; }

    // Along the sheet: of the triangle that ends at m. None where there is no such triangle.
    Vec3 inwardsAt(const Vec3& m, const Vec3& e) const {
        Vec3 inwards;
        for (const std::uint32_t t : index_.candidates(around(m, touch_))) {
            const std::optional<Section> s = sectionAt(t, m, e);
            if (!s) continue;
            for (const auto& [end, other] : {std::pair{s->a, s->b}, std::pair{s->b, s->a}})
                if (norm(end) <= touch_ && norm2(other) > norm2(inwards)) inwards = other;
        }
        return norm(inwards) > touch_ ? normalized(inwards) : Vec3{};
    }

    std::optional<Section> sectionAt(std::uint32_t triangle, const Vec3& m, const Vec3& e) const {
        const Surface& surface = index_.surface();
        const auto& v = surface.triangles[triangle];
        const auto section = sectionOf({surface.points[v[0]] - m, surface.points[v[1]] - m, surface.points[v[2]] - m}, e);
        return section ? clip(*section, gap_) : std::nullopt;
    }

    const SurfaceIndex& index_;
    double gap_, touch_; // m
};

bool isRim(const FeatureGraph& graph, const FeatureEdge& edge, const Look& look, double gap) {
    const Vec3 a = graph.points[edge.a], d = graph.points[edge.b] - a;
    const double length = norm(d);
    const auto looks = static_cast<std::size_t>(std::clamp(std::ceil(length / gap), 1.0, double(mostLooks)));
    std::size_t free = 0;
    for (std::size_t k = 0; k < looks; ++k)
        free += look.endsFreely(a + d * ((double(k) + 0.5) / double(looks)), d / length);
    return 2 * free > looks;
}

void addRimCorners(FeatureGraph& graph, double limit) {
    std::vector<bool> onRim(graph.points.size());
    for (const FeatureEdge& e : graph.edges)
        if (e.kinds & bitOf(EdgeKind::rim)) onRim[e.a] = onRim[e.b] = true;
    // Elsewhere the graph lacks the milder folds that tell where a bend fades.
    std::vector<std::uint32_t> corners = findCorners(graph.points, graph.edges, limit);
    std::erase_if(corners, [&](std::uint32_t c) { return !onRim[c]; });
    addCorners(corners, graph.corners);
}

} // namespace

std::vector<std::uint8_t> findRims(const FeatureGraph& graph, const SurfaceIndex& index, const FeatureOptions& options, double gap) {
    std::vector<std::uint8_t> rims(graph.edges.size(), 0);
    gap = std::max(gap, 10 * graph.weldTolerance);
    if (!(gap > 0)) return rims;
    const Look look(index, gap, 4 * graph.weldTolerance); // welding moves a point by up to twice the tolerance
    parallelFor(
        rims.size(),
        [&](std::size_t i) {
            const FeatureEdge& edge = graph.edges[i];
            if (!(edge.kinds & bitOf(EdgeKind::free))) return;
            const Vec3 middle = (graph.points[edge.a] + graph.points[edge.b]) * 0.5;
            rims[i] = angleAt(options, middle) < 180 && isRim(graph, edge, look, gap);
        },
        16);
    return rims;
}

void markRims(FeatureGraph& graph, const SurfaceIndex& index, const FeatureOptions& options, double gap) {
    const std::vector<std::uint8_t> rims = findRims(graph, index, options, gap);
    for (std::size_t i = 0; i < rims.size(); ++i)
        if (rims[i]) graph.edges[i].kinds |= bitOf(EdgeKind::rim);
    for (const FeatureEdge& e : graph.edges)
        if (e.kinds & bitOf(EdgeKind::rim))
            ++graph.rimEdges, graph.rimEdgeLength += norm(graph.points[e.b] - graph.points[e.a]);
    addRimCorners(graph, options.angle);
}

} // namespace i2b
