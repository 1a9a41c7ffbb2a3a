// Painting: label every face-connected region of cells that the geometry does not meet, all at once and across
// levels; then choose the regions to mesh from seeds or by the kind of flow.
#pragma once
#include "i2b/geometry/surface_index.h"
#include "i2b/options.h"
#include "i2b/paint/regions.h"

namespace i2b {

// Labels each node's cells with bit-parallel floods, joins across node faces and levels with a union-find, and
// numbers regions by first cell (level, then lattice order). Same result on any number of threads.
Regions labelRegions(const CellGrid& grid, const CutCells& cut);

// Marks the regions to mesh, and gives them the names of their seeds. Throws Error where a seed is in none (spots.h), or nothing is left.
void chooseRegions(Regions& regions, const CellGrid& grid, const SurfaceIndex& index, const DomainOptions& domain);

} // namespace i2b
