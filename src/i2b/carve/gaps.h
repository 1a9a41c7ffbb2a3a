// Gaps of about a cell between walls are entered in part and bridged in part: where the lattice happens to put centres into
// the middle, cells come back as passages do (passages.h), beside them none does, and every face between the two has no
// wall to go to. So more cells are given back, with less room than others, where that leaves fewer such faces: the least
// number of them is a minimum cut through the cells of the gaps.
#pragma once
#include "i2b/carve/room.h"

namespace i2b {

struct GapOptions {
    double least = 0.05;   // of h: least distance from a given cell's centre to the geometry
    double ample = 0.2;    // of h: cells with so much room cost nothing
    double squeezed = 2;   // faces that a cell without any room must spare
    double ahead = 0.85;   // cosine: a wall in this direction is one that a face can go to
    double across = 1.25;  // of h: a cell kept so far from the centre, away from the wall, has its own face to that wall
    int depth = 32;        // steps from the kept cells
};

// The cells to give back, in order. No two of kept and given cells that share a face have geometry between their centres.
std::vector<Place> gapCells(const Room& room, const GapOptions& options = {});

} // namespace i2b
