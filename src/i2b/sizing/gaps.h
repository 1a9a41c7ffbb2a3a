// Narrow gaps between opposite walls, whichever parts they belong to. Every triangle is sampled at about the size that
// is wanted there, with a ray to each side along its normal; a wall that it meets is opposite where it is parallel
// within 60 degrees. Orientation plays no part, so the room inside a thin solid counts as a gap, too.
#pragma once
#include "i2b/sizing/size_field.h"

namespace i2b {

struct GapCells {
    std::vector<LevelCells> levels; // coarse to fine, each ascending: the cells along the rays
    double narrowest = 0;           // m, of the gaps that ask for less than the smallest cell; 0: none does
    Vec3 place;                     // m, of that one
};

// So that `count` cells lie between opposite walls, with cells of `smallest` m at least. Gaps narrower than that are
// cracks, and closer sheets are one wall: both are ignored. The same on any number of threads.
GapCells findGaps(const SizeField& field, const SurfaceIndex& index, int count, double smallest);

} // namespace i2b
