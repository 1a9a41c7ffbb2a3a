// Where paint comes through: the openings on its way from one place to another that someone holds to be apart.
//
// Cells of the region are flooded from both places, those farthest from the geometry first; what the floods meet in are the narrowest
// places between the two, all at once: a watershed of the distance from the geometry (Meyer, Signal Processing 38 (1994) 113-125,
// flooding from markers). Each flood begins where the distance is largest around its place, so that a place beside a wall does as well as
// one in the middle. Faces of cells that hang together are one opening. Costs a distance for each of the region's cells, and one thread
// floods them, once a pair of places: on two cores some three seconds for a million cells; nothing where no two places are in one region.
#pragma once
#include "i2b/geometry/surface_index.h"
#include "i2b/options.h"
#include "i2b/paint/regions.h"
#include <vector>

namespace i2b {

// Of painted regions: the openings between seeds of different names, and those on the way to places of domain.keepOut, of each pair the
// widest first. Throws Error where such a place lies outside the box or in a cut cell. The same on any number of threads.
std::vector<Leak> findLeaks(const Regions& regions, const CellGrid& grid, const SurfaceIndex& index, const DomainOptions& domain);

} // namespace i2b
