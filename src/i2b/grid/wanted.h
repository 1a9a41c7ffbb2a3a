// What the sizes ask for, as masks: the cells that must be there, as leaf cells or split further, axis by axis.
#pragma once
#include "i2b/grid/cell_grid.h"
#include "i2b/sizing/size_field.h"
#include <array>

namespace i2b {

// Both lists: [axis][level] are cells of the level (the same on all axes) inside which the axis must be at that level or
// finer. walls are cut cells, and gaps, which get a buffer of their own level around them; spaces (boxes, bands and the
// like) end where they end, with the buffers of the coarser levels outside. Where nothing asks for different sizes along
// the axes, the lists of all three hold the same masks and perAxis is false.
struct WantedCells {
    std::array<std::vector<Mask::Ptr>, 3> walls, spaces;
    bool perAxis = false;
};

// Everything that the field asks for: the cut cells (see cutAtTargetLevels) and every source of sizes.
WantedCells wantedCells(const SizeField& field, const std::vector<CellLevel>& atTarget);

} // namespace i2b
