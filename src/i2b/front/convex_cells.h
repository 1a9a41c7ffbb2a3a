// A cell beside four finer ones has four faces in one plane. OpenFOAM's concavity test (checkConcaveCells: a face's centre
// that is not behind the plane of another face of the cell by 1e-6) counts such a cell, though nothing is wrong with it,
// and hides those that are concave. The point in the middle of the four faces therefore stands a little out of the
// coarser cell: all of its faces then turn away from each other.
#pragma once
#include "i2b/front/lattice_mesh.h"

namespace i2b {

inline constexpr double middleOut = 1.0 / 1024; // of the coarser cell's edge: 0.1 degrees of non-orthogonality

// points: of the lattice, as latticePoints() gives them (m). Moves those in the middle of a coarser kept cell's face;
// points of the front stay.
void raiseMiddles(const LatticeMesh& mesh, RawVector<Vec3>& points);

} // namespace i2b
