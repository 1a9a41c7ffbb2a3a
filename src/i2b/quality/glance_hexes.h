// As glance_quads.h, of cells with six quadrilaterals for faces.
#pragma once
#include "i2b/quality/lanes.h"

namespace i2b {

struct HexBounds {
    double smallVolume; // m^3
    double closedness, aspectRatio;
    double determinant; // by the inner faces
    double fullness;    // determinant by all faces: what is called so here to tell the two apart
};

struct HexBatch {
    // in, the faces in the order of the cell's row
    VecLanes point[6][4];
    Lanes side[6];     // 1: the cell owns the face, -1: it is the neighbour
    Lanes inner[6];    // 1: an inner face of the mesh, 0: of its boundary
    // out
    VecLanes centre;   // m
    Lanes volume;      // m^3
    Lanes determinant;
    Lanes surface;     // m^2, a sixth of the sums along the axes
    Lanes aspect;      // by the axes alone
};

struct HexExtremes {
    LaneExtremes volume, openness, determinant, fullness;
};

// Fills what comes out of the batch and adds to extremes; both hold for those lanes alone whose bit in the result is 0.
unsigned glanceAtHexes(HexBatch& batch, const HexBounds& bounds, HexExtremes& extremes);

} // namespace i2b
