// Mask trees between levels that differ from axis to axis: one tree operation an axis and level, on words.
#pragma once
#include "i2b/grid/mask_ops.h"

namespace i2b {

// Cells of level `to` that share volume with a cell of the mask.
Mask::Ptr overlapping(const Mask& cells, LevelTriple from, LevelTriple to);
// Cells of level `to` whose low corner lies in a cell of the mask. For sets that are known to be unions of whole
// cells of level `to` wherever they matter, at the price of one probe a cell.
Mask::Ptr sampled(const Mask& cells, LevelTriple from, LevelTriple to);

constexpr LevelTriple coarserOf(const LevelTriple& a, const LevelTriple& b) {
    return {std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)};
}
// True if a cell of one mask shares volume with a cell of the other. Dyadic boxes do so where their ancestors on the
// coarser level of each axis are the same, so nothing is ever refined.
bool sharesVolume(const Mask& a, const LevelTriple& levelA, const Mask& b, const LevelTriple& levelB);

// Vertices of level `from`, on the lattice of a level nowhere coarser.
Mask::Ptr embeddedVertices(const Mask& vertices, LevelTriple from, LevelTriple to);

} // namespace i2b
