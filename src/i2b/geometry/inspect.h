// What a geometry holds, for `i2b inspect`: figures a person wants before choosing a size.
#pragma once
#include "i2b/geometry/features.h"
#include "i2b/geometry/surface.h"
#include <cstdint>
#include <string>
#include <vector>

namespace i2b {

struct PartFigures {
    std::string name, file;
    std::uint64_t triangles = 0;
    Box box;         // m; empty without triangles
    double area = 0; // m2
};

struct InspectReport {
    std::vector<PartFigures> parts; // as in Surface::parts
    std::uint64_t triangles = 0, points = 0, segments = 0, freePoints = 0;
    Box bounds;      // m, of all triangles
    double area = 0; // m2
    // Over the three edges of each triangle, so that an edge of two triangles counts twice; m. The smallest
    // is of those that have a length. The median is rounded to single precision.
    double smallestEdge = 0, medianEdge = 0, largestEdge = 0;
    // From the FeatureGraph, after welding by its tolerance.
    double weldTolerance = 0; // m
    std::uint64_t weldedPoints = 0, degenerateTriangles = 0, duplicateTriangles = 0;
    std::uint64_t openEdges = 0, nonManifoldEdges = 0, sharpEdges = 0, namedEdges = 0, partBorderEdges = 0, corners = 0;
    double openEdgeLength = 0, nonManifoldEdgeLength = 0, sharpEdgeLength = 0, namedEdgeLength = 0; // m
    double suggestedSize = 0; // m, d_int for a first mesh; see suggestSize()
};

InspectReport inspect(const Surface& surface, const FeatureGraph& features);

// A first d_int: between the longest extent / 128, which shows the whole, and the median edge, which shows
// the detail, their geometric mean; held within extent / 1000 and extent / 50 and rounded down to 1, 2 or 5
// times a power of ten.
double suggestSize(double longestExtent, double medianEdge);

// Lines of text for a terminal, each ending in a newline.
std::string format(const InspectReport& report);

} // namespace i2b
