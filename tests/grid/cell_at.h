// The size of the cell at a place.
#pragma once
#include "i2b/grid/mask_ops.h"

namespace i2b::test {

// m; 0 where no cell is.
inline double cellAt(const CellGrid& grid, const Vec3& p) {
    for (const CellLevel& level : grid.levels) {
        if (level.cells->isValueOn(toCoord(grid.lattice.cellAt(level.level, p)))) return grid.lattice.h(level.level);
    }
    return 0;
}

} // namespace i2b::test
