// Quads of the wall that cut across a bend of the geometry: where the halves along one of their diagonals are
// nearer to it, they are cut along that; where that may make a cell of the core concave, only if they are much nearer.
//
// Wang and Srinivasan (2002) have no such step; a quad whose corners are all on the geometry and whose middle is not has a
// diagonal on either side of the bend, and one of the two is nearer.
#pragma once
#include "i2b/front/front.h"
#include "i2b/geometry/surface_index.h"

namespace i2b {

// Front and wall alike; nothing moves. Faces are renumbered in order of their owner cells. Gives how many were cut.
std::size_t cutAcrossBends(Front& front, const SurfaceIndex& index);

} // namespace i2b
