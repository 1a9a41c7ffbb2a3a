// The adaptive grid, from the finest level up: cells to refine at a level are the parents of what is wanted at the
// next, grown by the buffer; the leaf cells of a level are the children of what was refined above it less what is
// refined in it. Graded 2:1 across faces, edges and corners.
#pragma once
#include "i2b/grid/cell_grid.h"
#include "i2b/sizing/size_field.h"

namespace i2b {

// wanted[l]: cells of level l that must exist (as leaf cells or refined further), by level.
CellGrid buildCellGrid(const SizeField& field, const std::vector<Mask::Ptr>& wanted);

// The cells that refinement boxes ask for, by level.
std::vector<Mask::Ptr> wantedByBoxes(const SizeField& field);

} // namespace i2b
