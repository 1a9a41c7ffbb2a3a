// Gaps of about a cell between walls are entered in part and bridged in part: where the lattice happens to put centres into
// the middle, cells come back as passages do (passages.h), beside them none does, and every face between the two has no
// wall to go to. So more cells are given back, with less room than others, where that leaves fewer such faces: the least
// number of them is a minimum cut through the cells of the gaps. Room is what the gap has, not what a cell's centre has: a gap
// askew to the lattice can only be run through by cells of which every other one has its centre at a wall. Where that wall is a sheet
// with cells given back on its open side, too, these go: the wall there has others behind them.
#pragma once
#include "i2b/carve/room.h"

namespace i2b {

struct GapOptions {
    double width = 0.5;      // of h: least room between the walls at a given cell
    double displaced = 0.05; // faces that must be spared for a cell that goes: little, there are others behind it
    double ahead = 0.85;     // cosine: a wall in this direction is one that a face can go to
    double across = 1.25;    // of h: a cell kept so far from the centre, away from the wall, has its own face to that wall: kept
                             // cells look into no gap there, but given ones beside it do
    int depth = 32;          // steps from the kept cells
};

struct GapFilling {
    std::vector<Place> given, displaced; // cells to give back, and kept ones that go instead; in order
};

// After it no two of kept and given cells that share a face have geometry between their centres.
GapFilling fillGaps(const Room& room, const GapOptions& options = {});

} // namespace i2b
