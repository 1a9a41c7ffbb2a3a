// The geometry as a narrow band of distances on the lattice of one level, with the fluid on the positive
// side.
//
// Voxels of painted cells are positive, those of other cells negative. In cells that the geometry cuts the
// sign comes from a neighbour that a straight line reaches without meeting the geometry, found by stepping
// along the line by the distance (sphere tracing: Hart 1996); what no such line reaches is negative. A stray
// sheet in the fluid therefore has positive distances on both its sides and no zero crossing, which is what a
// sheet without an inside is.
#pragma once
#include "i2b/carve/kept_cells.h"
#include "i2b/core/context.h"
#include "i2b/grid/cell_grid.h"
#include "i2b/paint/regions.h"
#include "i2b/write/vdb_pieces.h"
#include <functional>
#include <limits>

namespace i2b {

// Distance to the geometry (m, not negative) where it is at most the given reach, else anything larger than the reach;
// called from many threads at once.
using DistanceFunction = std::function<double(const Vec3&, double reach)>;

struct SurfaceBand {
    int level = 0;                          // of the lattice the trees lie on
    openvdb::FloatTree::Ptr signedDistance; // m, clipped to the half width; active within it
    openvdb::FloatTree::Ptr distance;       // m; active in the fluid, within the half width
};

// The level that most of the cut cells have (the finer one of equals): a band there shows all of the
// geometry, at a cost that goes with the number of cut cells. A coarser one where the geometry would have more than
// mostCells cells there.
int bandLevel(const CutCells& cut, std::uint64_t mostCells = std::numeric_limits<std::uint64_t>::max());

// Fluid are the cells of painted regions, or, with no regions, the kept ones. halfWidth is in voxels of the
// level.
SurfaceBand buildSurfaceBand(const CellGrid& grid, const CutCells& cut, const Regions* regions,
                             const KeptCells* kept, const DistanceFunction& distance, int level,
                             int halfWidth, const Context& context);

} // namespace i2b
