// Quality of the tetrahedra that a face divides into with the centres of its cells, as OpenFOAM measures it
// (polyMeshTetDecomposition, v1912): face_tets.h says how far a face is from having poor ones, this whether it has.
#pragma once
#include "i2b/assemble/poly_mesh.h"
#include <algorithm>
#include <cmath>
#include <span>

namespace i2b {

// Tetrahedra are poor whose quality is not over a tolerance. With D six times the volume and L the longest edge at one
// corner, the circumradius is at most 2.5 L^4/|D|, hence |quality| > |D|^4/(49 L^12); where D^2/L^6 is over shape, the size of
// the quality is clearly over the tolerance.
struct TetTolerance {
    explicit TetTolerance(double value) : quality(value), shape(value < 0 ? 1e300 : std::max(1e-12, 7.1 * std::sqrt(value))) {}

    // Sign of the quality where a glance settles that its size is over the tolerance, else 0.
    int clearSign(double sixfoldVolume, double longest2) const {
        const double d2 = sixfoldVolume * sixfoldVolume;
        if (!(d2 > shape * longest2 * longest2 * longest2) || !(d2 > 1e-280)) return 0;
        return sixfoldVolume > 0 ? 1 : -1;
    }

    double quality, shape;
};

// Of a face (v: its vertices) with the centres of its cells (neighbour: null on the boundary): how many of these fail. The tetrahedra
// around its centre, on either side; and a fan from one of its vertices with none poor on any side.
int tetErrors(const PolyMesh& mesh, std::span<const std::int32_t> v, const Vec3& faceCentre, const Vec3& owner, const Vec3* neighbour,
              const TetTolerance& tolerance);

} // namespace i2b
