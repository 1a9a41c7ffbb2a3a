// The edges of a welded soup and what they are. Private to features.cpp and its neighbours.
#pragma once
#include "i2b/geometry/feature_soup.h"
#include <cmath>
#include <numbers>

namespace i2b {

constexpr std::uint8_t bitOf(EdgeKind kind) { return static_cast<std::uint8_t>(kind); }

struct EdgeKey {
    std::uint32_t a, b; // a < b
    friend auto operator<=>(const EdgeKey&, const EdgeKey&) = default;
};
inline EdgeKey keyOf(std::uint32_t a, std::uint32_t b) { return a < b ? EdgeKey{a, b} : EdgeKey{b, a}; }

// Degrees by which what leaves a place along u fails to go straight on along v: 0 straight, 180 folded back. Of two
// triangles that leave their edge along u and v, the angle between their planes.
inline double fold(const Vec3& u, const Vec3& v) {
    return std::atan2(norm(cross(u, v)), -dot(u, v)) * (180 / std::numbers::pi);
}

// Steps 3 to 5 of features.cpp: every edge of the soup with its kinds and angle, those without a kind too; a < b,
// ascending. limit: degrees above which it is sharp. Counts in the graph the needles that it bridges.
std::vector<FeatureEdge> judgeEdges(const FeatureSoup& soup, double limit, FeatureGraph& graph);

} // namespace i2b
