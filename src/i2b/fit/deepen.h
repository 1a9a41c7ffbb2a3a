// More room for layers that are to be higher than the fit leaves between front and wall: the front goes on inwards, and the core behind it
// moves up in as many rings as that takes. Where walls face each other each takes a third of the way at most; where cells would be bad,
// and around, the front goes less deep.
#pragma once
#include "i2b/front/front.h"
#include "i2b/front/lattice_mesh.h"
#include "i2b/front/wanted_room.h"
#include "i2b/geometry/surface_index.h"

namespace i2b {

// Do layers ask for any height at all?
inline bool wantsDepth(const RoomOfWalls& room) { return room.most.inCells(1) > 0; }
// Moves front positions and core points; wall positions stay. Before vertices are inserted. Gives whether any moved.
bool deepen(Front& front, const LatticeMesh& mesh, const SurfaceIndex& index, const RoomOfWalls& room);

} // namespace i2b
