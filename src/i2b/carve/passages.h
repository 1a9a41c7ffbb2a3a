// Narrow passages and grooves: where two walls stand one to two and a half cells apart, the cells between them are cut
// or cut off, and a front that keeps out of all cut cells bridges the passage. Cells whose centre has room on the flow's
// side of the walls are given back there, in chains that start at the kept cells; the fit draws the corners that lie
// behind a wall back to this side.
//
// Along a single wall nothing is given back: cells one step in front of a cut cell that has room are not cut at all,
// so a chain of two steps exists only where there is a second wall or a corner. Cells between kept ones on two sides,
// a lid of one or two cells on a passage, come back as well.
#pragma once
#include "i2b/carve/room.h"

namespace i2b {

inline constexpr int passageDepth = 8;  // steps from the kept cells
inline constexpr int passageRounds = 4; // what comes back leaves others between kept cells

// The cells to give back, in order. No two of kept and given cells that share a face have geometry between their centres.
std::vector<Place> passageCells(const Room& room);

} // namespace i2b
