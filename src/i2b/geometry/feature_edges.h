// The edges of a welded soup and what they are. Private to features.cpp and its neighbours.
#pragma once
#include "i2b/core/raw_vector.h"
#include "i2b/geometry/feature_soup.h"
#include <cmath>
#include <numbers>

namespace i2b {

// Degrees by which what leaves a place along u fails to go straight on along v: 0 straight, 180 folded back. Of two
// triangles that leave their edge along u and v, the angle between their planes.
inline double fold(const Vec3& u, const Vec3& v) {
    return std::atan2(norm(cross(u, v)), -dot(u, v)) * (180 / std::numbers::pi);
}

// Degrees over which a fold is sharp, and else a crease.
struct FoldLimits { double sharp, crease; };
std::uint8_t kindOfFold(double fold, const FoldLimits& limits);
inline constexpr std::uint8_t foldKinds = bitOf(EdgeKind::sharp) | bitOf(EdgeKind::crease);

// Steps 3 to 5 of features.cpp: every edge of the soup with its kinds and angle, those without a kind too; a < b,
// ascending. isNamed: per part, whether its free edges and borders are named.
// Counts in the graph the needles that it bridges.
RawVector<FeatureEdge> judgeEdges(const FeatureSoup& soup, const FoldLimits& limits, const std::vector<bool>& isNamed,
                                    FeatureGraph& graph);

} // namespace i2b
