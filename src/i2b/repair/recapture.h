// Sharp edges that the wall has missed. Neither the fit nor single moves bring a node to an edge where a cell beside it would be poor for it;
// here it is put there nonetheless, and then the cells around are mended (wanted_nodes.h: which, and where). What is still poor after that, or
// captures no more of the edges, goes back to where it was, so that a mesh without faults stays so.
#pragma once
#include "i2b/repair/optimise.h"

namespace i2b {

// Gives how many nodes have come to an edge. faults: without wrong cells. guide.graph is given. The same on any number of threads.
std::int64_t recapture(const PolyMesh& mesh, const Rows& cellFaces, const MeshFaults& faults, const Front& front, const WallGuide& guide, Optimiser& optimiser);

} // namespace i2b
