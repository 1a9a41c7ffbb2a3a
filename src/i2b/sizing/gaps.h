// Narrow gaps between opposite walls, whichever parts they belong to. Every triangle is sampled at about the size that
// is wanted there, with a ray to each side along its normal; a wall that it meets is opposite where it is parallel
// within 60 degrees. Orientation plays no part, so the room inside a thin solid is a gap as good as another: which of them
// the flow comes to shows only once cells small enough to enter them have been painted.
#pragma once
#include "i2b/geometry/surface_index.h"
#include "i2b/sizing/size_field.h"

namespace i2b {

// What one ray found.
struct Gap {
    Vec3 from, to;     // m, on the two walls
    float width = 0;   // m, from one wall to the plane of the other
    LevelTriple level; // of the cells that are wanted along it
    Vec3 middle() const { return (from + to) * 0.5; }
};

// Where fewer than `count` cells would lie between opposite walls, with cells of `smallest` m at least. Gaps narrower than
// that are cracks, and closer sheets are one wall: both are ignored. In the order of the triangles, whatever the threads.
std::vector<Gap> findGaps(const SizeField& field, const SurfaceIndex& index, int count, double smallest);

// The cells along the rays, coarse to fine, each level's ascending and without repetition.
std::vector<LevelCells> cellsAlong(const std::vector<Gap>& gaps, const Lattice& lattice);

} // namespace i2b
