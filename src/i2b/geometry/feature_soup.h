// First steps towards a feature graph: points welded, triangles that say nothing new dropped. Private to features.cpp
// and its neighbours.
#pragma once
#include "i2b/core/raw_vector.h"
#include "i2b/geometry/features.h"
#include <array>
#include <cstdint>
#include <vector>

namespace i2b {

using TriangleCorners = std::array<std::uint32_t, 3>;

struct EdgeKey {
    std::uint32_t a, b; // a < b
    friend auto operator<=>(const EdgeKey&, const EdgeKey&) = default;
};
inline EdgeKey keyOf(std::uint32_t a, std::uint32_t b) { return a < b ? EdgeKey{a, b} : EdgeKey{b, a}; }

struct FeatureSoup {
    RawVector<Vec3> points;                 // m, welded: those of triangles, then those of lines alone
    RawVector<TriangleCorners> triangles;   // of different points, each set of corners once
    RawVector<std::int32_t> partOf;         // per triangle
    std::vector<EdgeKey> lines;             // of FeatureLines, without those of no length; each once, ascending
    std::vector<std::uint32_t> corners;     // of FeatureLines
};

// Steps 1 and 2 of features.cpp. Settles graph.weldTolerance and counts in the graph what it welds and drops. A line's
// point goes to the triangles' point within the tolerance; the triangles are welded as if there were no lines.
FeatureSoup weldSoup(const Surface& surface, const FeatureLines& lines, FeatureGraph& graph);

} // namespace i2b
