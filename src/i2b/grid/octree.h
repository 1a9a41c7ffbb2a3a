// The two tree operations that an octree is built with, each in one pass over its nodes.
#pragma once
#include "i2b/grid/mask_ops.h"

namespace i2b {

// Parents of all cells within n (at most 8) cells, in all 26 directions, of a cell of a or of b: what parentsOf(dilated(
// unionOf(a, b), n)) gives. size: of the parents' level.
Mask::Ptr parentsAround(const Mask& a, const Mask& b, int n, const Index3& size);

// Children of the cells of `split` that are not in `again`.
Mask::Ptr childrenLess(const Mask& split, const Mask& again);

// All cells of [0, size) that are not in `again`.
Mask::Ptr boxLess(const Index3& size, const Mask& again);

} // namespace i2b
