// Edges and corners of a dirty soup that a mesh should show: points are welded, repeated triangles dropped, then
// every edge is judged by the angle between its triangles, non-manifold edges too.
#pragma once
#include "i2b/core/vec.h"
#include "i2b/geometry/surface.h"
#include <array>
#include <cstdint>
#include <vector>

namespace i2b {

struct FeatureOptions {
    double angle = 40;        // degrees between the triangles' planes above which an edge is sharp; 180: none
    double weldTolerance = 0; // m; 0: 1e-6 of the diagonal of the bounds
};

enum class EdgeKind : std::uint8_t {
    sharp = 1,       // angle over the limit, at a manifold or a non-manifold edge
    free = 2,        // one triangle only: the border of an open sheet
    nonManifold = 4, // three or more triangles
    partBorder = 8   // triangles of different parts
};

struct FeatureEdge {
    std::uint32_t a = 0, b = 0; // into FeatureGraph::points
    std::uint8_t kinds = 0;     // EdgeKind bits
    float angle = 0;            // degrees, the largest among its triangles; 0 at a free edge
};

struct FeatureGraph {
    double weldTolerance = 0;               // m, the one used
    std::vector<Vec3> points;               // m, welded; only those that an edge uses
    std::vector<FeatureEdge> edges;         // a < b, ascending
    std::vector<std::uint32_t> corners;     // points where not exactly two sharp edges meet, or they turn over the angle
    // Counts over the whole welded soup, features or not.
    std::uint64_t weldedPoints = 0, duplicateTriangles = 0, degenerateTriangles = 0;
    std::uint64_t openEdges = 0, nonManifoldEdges = 0, sharpEdges = 0;
    double openEdgeLength = 0, sharpEdgeLength = 0; // m

    std::string validate() const;
    std::uint64_t checksum() const;
};

FeatureGraph buildFeatureGraph(const Surface& surface, const FeatureOptions& options);

} // namespace i2b
