// Where paint may begin at a place that someone names: in its own cell, or, where the geometry cuts that, in the nearest open one around
// that the place sees, so that it stays on its side of a wall.
#pragma once
#include "i2b/geometry/surface_index.h"
#include "i2b/paint/regions.h"

namespace i2b {

struct Spot {
    std::int32_t region = -1;
    Vec3 place; // m: as named, or the centre of the cell near by
};

// what: names the place where it must be refused. Looks as far as three of the cells there, and first for regions of 64 cells and more.
// Throws Error where the place is outside the box, or sees no open cell.
Spot spotAt(const Regions& regions, const CellGrid& grid, const SurfaceIndex& index, const Vec3& place, const char* what);

} // namespace i2b
