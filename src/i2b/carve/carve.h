// From painted cells to cells whose front can be extruded: cells too close to the wall go (Wang and Srinivasan 2002,
// section 3, with a clearance found by study), cells whose centre has room come back (passages.h), and parts of the region that they
// lead to (islands.h), gaps between walls are filled (gaps.h), the front is shaped until every fan has a direction (extrudable.h), and
// islands that this has cut off go.
#pragma once
#include "i2b/carve/kept_cells.h"
#include "i2b/geometry/surface_index.h"
#include "i2b/options.h"
#include "i2b/paint/regions.h"

namespace i2b {

// Throws Error where nothing of a painted region is left.
KeptCells carve(const CellGrid& grid, const CutCells& cut, const Regions& regions, const SurfaceIndex& index,
                const FitOptions& options);

} // namespace i2b
