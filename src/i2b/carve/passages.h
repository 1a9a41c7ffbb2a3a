// Cells that come back. A front that keeps out of all cut cells stands up to 1.7 cells away from a wall, bridges
// passages and grooves of one to two and a half cells, and rounds off convex edges. So cells whose centre has room on
// the flow's side of the walls are given back: those beside kept cells, and chains of them through narrow passages. The
// fit draws their corners that lie behind a wall back to this side.
#pragma once
#include "i2b/carve/room.h"

namespace i2b {

inline constexpr int passageDepth = 32; // steps from the kept cells

// The cells to give back, in order. No two of kept and given cells that share a face have geometry between their centres.
std::vector<Place> passageCells(const Room& room);

} // namespace i2b
