// How far from the wall the front is to stand, for the layers between them.
#pragma once
#include <algorithm>
#include <vector>

namespace i2b {

// What the highest layers to come and a cell over them take. The fit moves the front inwards for it, as far as cells behind
// it keep their shape.
struct WantedRoom {
    double metres = 0;
    double cells = 0;   // the same in edges of the cell at the wall; the larger one counts
    double inCells(double h) const { return std::max(cells, metres / h); } // h: m, that edge
};

struct RoomOfWalls {
    WantedRoom most;                // of all walls
    std::vector<WantedRoom> ofPart; // per part of the surface; empty: the same on all
};

} // namespace i2b
