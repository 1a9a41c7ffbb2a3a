// One mesh of a test shape, in a pose that a seed gives, and what its wall came to.
#pragma once
#include "i2b/assemble/poly_mesh.h"
#include "i2b/quality/fit_report.h"
#include "i2b/quality/quality_report.h"
#include "pipeline/shapes.h"

namespace i2b::test {

struct ShapeRun {
    std::string fault;     // "" or why there is no valid mesh: what generate() threw, or the first thing wrong
    PolyMesh mesh;
    QualityReport quality;
    FitReport fit;         // against the soup's own sharp edges and the shape's lines
    // Samples of fit's capture over those that all sharp lines have room for. Falls where lines cannot be resolved or lie
    // hidden in another part, which is the shape's doing; and where the wall stays over h / 2 away, which is the mesh's.
    double sampled = 0;
};

// Turned and shifted against the lattice at random: the same pose for the same shape and seed.
ShapeGeometry posed(const Shape& shape, double h, unsigned seed);

// Meshes one side of it (not Side::both) with cells of h metres at the wall, one layer. Writes and removes one
// temporary STL file.
ShapeRun meshShape(const Shape& shape, Side side, double h, unsigned seed);

// What plain checkMesh says no to, that is without -allTopology and -allGeometry: "" or the names of the checks.
std::string plainFailures(const QualityReport& quality);

} // namespace i2b::test
