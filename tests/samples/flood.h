// A plain voxel flood, written apart from the mesher, to say which places of a soup are joined for cells of a
// size.
#pragma once
#include "i2b/geometry/surface.h"

namespace i2b::test {

struct Voxels {
    Box box;
    double size = 0; // m
    int nx = 0, ny = 0, nz = 0;
    std::vector<std::uint8_t> state; // 0 free, 1 met by a triangle, 2 reached

    std::size_t at(const Vec3& p) const;
    bool reached(const Vec3& p) const { return state[at(p)] == 2; }
    std::size_t count(std::uint8_t s) const { return std::size_t(std::count(state.begin(), state.end(), s)); }
};

// Voxels over the surface's box and `margin` around it, shifted by `shift` voxels; those that triangles meet
// marked (closed test: touching counts).
Voxels voxelise(const Surface& surface, double size, double margin, double shift = 0);

// Marks what can be reached from p across voxel faces without entering a met one.
void flood(Voxels& voxels, const Vec3& p);

} // namespace i2b::test
