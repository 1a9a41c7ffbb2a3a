// A front that prisms can be extruded from: around every vertex each fan of exposed faces has a direction with a
// positive component on all of them, and an edge where kept and removed cells alternate comes apart in the same way at
// both of its ends; removed cells that the geometry passes between do not come apart at an edge, or the tip of a sheet would be
// a wall of its own. Where that does not hold, a cell goes or, where it has room, comes back: the one after which the
// fewest vertices around it are at fault; one that comes back in a gap may take the place of those beyond its walls. Taking
// cells away only would eat up passages of one cell from their mouths.
#pragma once
#include "i2b/carve/room.h"

namespace i2b {

struct ShapingSummary {
    std::uint64_t removed = 0, added = 0; // cells
};

// Changes the kept cells. room: what may come back; none: cells only go.
ShapingSummary makeExtrudable(std::vector<Mask::Ptr>& kept, const CellGrid& grid, const SurfaceIndex& index, const Room* room);

// Vertices on the closed cells, each on its own level, in order.
std::vector<Place> verticesOf(const std::vector<Place>& cells, VertexLookup& lookup, const CellGrid& grid);

// All places of the masks: by level, then in the order of the tree.
std::vector<Place> placesOf(const std::vector<Mask::Ptr>& masks);

} // namespace i2b
