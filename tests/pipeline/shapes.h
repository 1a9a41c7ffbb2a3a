// A table of shapes that each ask one thing of the wall: sharp convex and concave edges, narrow wedges, lines where
// parts cross, sheets and slabs thinner than a cell, cracks. Every shape lies within shapeRadius of the origin and is
// about 20 cells across at the sizes it is meant for.
#pragma once
#include "i2b/geometry/surface.h"
#include "i2b/options.h"
#include <array>
#include <string>
#include <vector>

namespace i2b::test {

inline constexpr double shapeRadius = 1;                              // m
inline constexpr std::array<double, 3> shapeSizes{0.1, 0.065, 0.04}; // m, cells at the wall

struct ShapeGeometry {
    Surface soup;                           // m
    // Sharp lines that the soup's triangles do not have as edges, m: where parts cross, the rims of sheets, the
    // middle of cracks.
    std::vector<std::array<Vec3, 2>> lines;
    // Of cracks the two rims: along any line of the three, but all along the one, an edge of the wall is as good. By crack,
    // in the order of lines; empty without cracks.
    std::vector<std::array<std::array<Vec3, 2>, 2>> rims;
    std::vector<Seed> seeds;                // where the flow has to be painted from
};

enum class Side : std::uint8_t { outside, inside, both }; // of the shape, that can be meshed

struct Shape {
    const char* name;
    Side sides;
    ShapeGeometry (*make)(double h); // h: cells at the wall, m, for those whose dimensions are given in cells
};

const std::vector<Shape>& shapes();

} // namespace i2b::test
