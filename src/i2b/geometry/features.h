// Edges and corners of a dirty soup that a mesh should show: points are welded, repeated triangles dropped,
// then every edge is judged by the angle between its triangles, non-manifold edges too. The user may name further
// ones: lines from a file, all that bounds a part, the edges in a box.
#pragma once
#include "i2b/core/vec.h"
#include "i2b/geometry/feature_lines.h"
#include "i2b/geometry/surface.h"
#include "i2b/options.h"
#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace i2b {

// No fold over this is a crease, degrees. Where nothing is to be sharp, as the angle is 180, none at all is.
inline constexpr double mostCrease = 40;

struct FeatureOptions {
    double angle = 40;        // degrees between the triangles' planes above which an edge is sharp; 180: none
    double weldTolerance = 0; // m; 0: 1e-6 of the diagonal of the bounds
    // Names or regular expressions of parts whose free edges and borders to other parts are features at any angle.
    std::vector<std::string> parts = {};
    // Inside, all: the angle is boxAngle; none: it is 180, and parts name nothing. The last box that holds a place
    // decides there, and edges are cut where boxes end.
    std::vector<FeatureBox> boxes = {};
    FeatureLines lines = {}; // features wherever they are; no box takes them away
    double crease = 6;       // degrees; folds over it that are not sharp are creases
};

// What the options of a run ask for; lines: what their files hold.
FeatureOptions featureOptions(const GeometryOptions& geometry, const FeatureLines& lines);

inline constexpr double boxAngle = 1; // degrees; flat faces of single-precision triangles fold by less

enum class EdgeKind : std::uint8_t {
    sharp = 1,       // angle over the limit, at a manifold or a non-manifold edge
    free = 2,        // one triangle only: the border of an open sheet, or of a crack
    nonManifold = 4, // three or more triangles
    partBorder = 8,  // triangles of different parts
    named = 16,      // named by the user: a line from a file, or what bounds a named part
    rim = 32,        // free, and the sheet ends there in the open; see markRims() in rims.h
    crease = 64      // a milder fold that a mesh follows where nothing else is near
};

constexpr std::uint8_t bitOf(EdgeKind kind) { return static_cast<std::uint8_t>(kind); }

// The kinds that a mesh should have an edge along; the others are facts about the soup.
inline constexpr std::uint8_t lineKinds = bitOf(EdgeKind::sharp) | bitOf(EdgeKind::named) | bitOf(EdgeKind::rim);

struct FeatureEdge {
    std::uint32_t a = 0, b = 0; // into FeatureGraph::points
    std::uint8_t kinds = 0;     // EdgeKind bits
    // Degrees between the planes of its triangles, 0 flat, 180 folded back, whatever their orientation; 0 at
    // a free edge and at a named line off the triangles' edges. Of three and more the worst angle between any two
    // planes or, if larger, the fold of the triangle that no other continues.
    float angle = 0;
};

struct FeatureGraph {
    double weldTolerance = 0;       // m, the one used
    double crease = 0;              // degrees, over which a fold may be one
    std::vector<Vec3> points;       // m, welded; only those that an edge uses or that are corners
    std::vector<FeatureEdge> edges; // a < b, ascending
    // Points where not exactly two edges of lineKinds meet, or they turn over the angle, and the points of
    // FeatureLines; ascending. The end of a sharp line that a fold of at least half the angle continues is none:
    // there a bend fades, or a radius is tessellated unevenly. So is the end of a rim that goes on as a crack. The end
    // of a named line is a corner.
    std::vector<std::uint32_t> corners;
    // Counts over the whole welded soup, features or not. Degenerate: welded to two points or one, or lower
    // than the tolerance; such a needle's neighbours count as neighbours of each other.
    std::uint64_t weldedPoints = 0, duplicateTriangles = 0, degenerateTriangles = 0;
    std::uint64_t openEdges = 0, nonManifoldEdges = 0, sharpEdges = 0, namedEdges = 0, rimEdges = 0;
    double openEdgeLength = 0, sharpEdgeLength = 0, namedEdgeLength = 0, rimEdgeLength = 0; // m
    std::vector<std::string> notes; // one sentence each: what was named and is not there

    std::string validate() const;
    std::uint64_t checksum() const;
};

// options: validated; the expressions of parts are good.
FeatureGraph buildFeatureGraph(const Surface& surface, const FeatureOptions& options);

} // namespace i2b
