// First steps towards a feature graph: points welded, triangles that say nothing new dropped. Private to features.cpp
// and its neighbours.
#pragma once
#include "i2b/geometry/features.h"
#include <array>
#include <cstdint>
#include <vector>

namespace i2b {

using TriangleCorners = std::array<std::uint32_t, 3>;

struct FeatureSoup {
    std::vector<Vec3> points;               // m, welded
    std::vector<TriangleCorners> triangles; // of different points, each set of corners once
    std::vector<std::int32_t> partOf;       // per triangle
};

// Steps 1 and 2 of features.cpp. Settles graph.weldTolerance and counts in the graph what it welds and drops.
FeatureSoup weldSoup(const Surface& surface, FeatureGraph& graph);

} // namespace i2b
