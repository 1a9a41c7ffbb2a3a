// Which cells the geometry meets: an exact, closed triangle/box test in lattice coordinates, borderline cases
// decided to the safe side, so that a wall never has a pinhole through which paint runs.
#pragma once
#include "i2b/geometry/surface.h"
#include "i2b/grid/cell_grid.h"
#include "i2b/sizing/size_field.h"

namespace i2b {

// By target level, coarse to fine: the cells of that level which triangles with that target meet, whether they exist
// yet or not. Every target level of the field has an entry.
std::vector<CellLevel> cutAtTargetLevels(const Surface& surface, const SizeField& field);

// The leaf cells of the grid that any triangle meets. atTarget is what cutAtTargetLevels() gave for the same input;
// only triangles whose place was refined beyond their own level are looked at again.
CutCells cutLeafCells(const Surface& surface, const SizeField& field, const CellGrid& grid,
                      const std::vector<CellLevel>& atTarget);

} // namespace i2b
