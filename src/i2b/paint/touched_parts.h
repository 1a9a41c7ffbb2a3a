// Which parts wall a region in: those whose triangles meet a cut cell that shares a face with one of the region's.
#pragma once
#include "i2b/geometry/surface.h"
#include "i2b/paint/regions.h"
#include "i2b/sizing/size_field.h"

namespace i2b {

// Fills Region::parts of regions that labelRegions() gave for the same grid and cut. Every triangle is looked at once
// on the levels it may be cut at, node by node, as long as its part may still be new to a region.
void findTouchedParts(Regions& regions, const Surface& surface, const SizeField& field, const CellGrid& grid,
                      const CutCells& cut);

} // namespace i2b
