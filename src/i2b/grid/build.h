// The adaptive grid, from the finest level up: cells to refine at a level are the parents of what is wanted at the
// next, grown by the buffer; the leaf cells of a level are the children of what was refined above it less what is
// refined in it. Graded 2:1 on every axis, across faces, edges and corners.
#pragma once
#include "i2b/grid/wanted.h"

namespace i2b {

// Leaf cells that satisfy every wish and the grading, with the least splitting: a cell is split in two, four or eight,
// along the axes that need it, all at once.
CellGrid buildCellGrid(const SizeField& field, const WantedCells& wanted);

} // namespace i2b
