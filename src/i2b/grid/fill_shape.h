// The cells of one level that a shape meets, found from large blocks to small ones: a block that is wholly inside is
// filled at once, so the work is that of the shape's border, not of its volume.
#pragma once
#include "i2b/grid/cell_grid.h"
#include "i2b/sizing/shapes.h"

namespace i2b {

Mask::Ptr cellsOf(const Shape& shape, const Lattice& lattice, const LevelTriple& level);

// Those that share volume with the box; of a box without volume along an axis, those that hold it.
Mask::Ptr cellsOf(const Box& box, const Lattice& lattice, const LevelTriple& level);

} // namespace i2b
