// Nearly all faces of a mesh are inner quadrilaterals with which nothing is wrong. Eight at a time are seen through here:
// of those that clearly pass every check only figures are kept (extremes, terms of means); the others are named, for the
// plain code to measure one by one.
#pragma once
#include "i2b/quality/lanes.h"

namespace i2b {

// What a face must keep clear of, on whichever side a check has its limit.
struct QuadBounds {
    double shortEdge2; // m^2
    double faceArea;   // m^2
    double flatness;
    double spread;     // least allowed sum of the areas of its triangles over that of the face
    double cosine;     // of the non-orthogonality
    double weight, ratio, skewness;
    double pyramid3;   // three times the volume of a face pyramid, m^3
    double tetShape;   // squared volume over the cubed squared longest edge of the tetrahedra of a face
    double twist, triangleTwist; // cosines
};

struct QuadBatch {
    // in
    VecLanes point[4];
    VecLanes own, nei;          // centres of the cells
    Lanes ownVolume, neiVolume; // m^3
    // out
    Lanes flat;                 // flatness
    Lanes ortho, weight, ratio; // as PairValues
    Lanes skewness;
};

struct QuadExtremes {
    LaneExtremes edge2, area, flatness, ortho, weight, ratio, skewness;
};

// Fills what comes out of the batch and adds to extremes; both hold for those lanes alone whose bit in the result is 0.
unsigned glanceAtQuads(QuadBatch& batch, const QuadBounds& bounds, QuadExtremes& extremes);

} // namespace i2b
