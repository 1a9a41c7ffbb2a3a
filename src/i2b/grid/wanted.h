// What the sizes ask for, as masks: the cells that must be there, as leaf cells or split further, axis by axis.
#pragma once
#include "i2b/grid/cell_grid.h"
#include "i2b/sizing/size_field.h"
#include <array>

namespace i2b {

// axis[a][l]: cells of level l (the same on all axes) inside which axis a must be at level l or finer. Where nothing
// asks for different sizes along the axes, all three lists hold the same masks and perAxis is false.
struct WantedCells {
    std::array<std::vector<Mask::Ptr>, 3> axis;
    bool perAxis = false;
};

// Everything that the field asks for: the cut cells (see cutAtTargetLevels) and every source of sizes.
WantedCells wantedCells(const SizeField& field, const std::vector<CellLevel>& atTarget);

} // namespace i2b
