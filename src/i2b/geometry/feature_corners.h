// Where the lines of a feature graph end, meet or turn. Private to features.cpp and its neighbours.
#pragma once
#include "i2b/geometry/features.h"
#include <cstdint>
#include <span>
#include <vector>

namespace i2b {

// Of the points, ascending; see FeatureGraph::corners. all: edges between the points, those without a kind too: a
// milder fold may continue a line. limit: degrees.
std::vector<std::uint32_t> findCorners(std::span<const Vec3> points, std::span<const FeatureEdge> all, double limit);

} // namespace i2b
