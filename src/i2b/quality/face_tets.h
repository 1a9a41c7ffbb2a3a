// How well a face divides: into tetrahedra, as particle trackers and OpenFOAM's checkFaceTets ask it to, around its centre, and as a
// fan from one of its vertices, each with the centres of the cells at its sides as apex; and into triangles around its centre that
// face the way between the cells (checkFaceTwist); and whether it turns back at a corner (checkFaceAngles).
#pragma once
#include "i2b/quality/mesh_geometry.h"
#include <algorithm>
#include <limits>

namespace i2b {

// Of tetShare(): below, tetrahedra may be of no quality (under 1e-15), which falls with the fourth power.
inline constexpr double undividedShare = 1e-2;
// Of the twist, from which its share counts: minTwist of OpenFOAM's mesh quality dictionary, a cosine.
inline constexpr double leastTwist = 0.02;

// Of a flat convex face 1, below 0 where it does not divide: the least, over its triangles, of the height of an apex over the
// triangle's plane as a share of its height over the face's; of the fans the best one counts; and the cosine between a triangle's
// normal and the way from cell to cell, from the limit of the twist on; and the sine of the turn at a reflex corner, from the limit of
// concavity down; and the area of the face and of its triangles over the square of its reach. At least -2.
// centre: of the face; area: its vector, m^2; neighbour: the other cell's centre, or null. Shares over `enough` are given as
// that, those up to `hopeless` as any up to it.
double tetShare(const PolyMesh& mesh, std::int32_t face, const Vec3& centre, const Vec3& area, const Vec3& owner, const Vec3* neighbour,
                double enough = 1, double hopeless = -std::numeric_limits<double>::infinity());

// Of the lesser pyramid of a face with a cell's centre: by how much it is over the least volume (m^3, not negative), as a share of that.
inline double pyramidShare(const FaceShape& face, const Vec3& owner, const Vec3* neighbour, double least) {
    double threefold = dot(face.area, face.centre - owner);
    if (neighbour) threefold = std::min(threefold, dot(face.area, *neighbour - face.centre));
    return least > 0 ? threefold / (3 * least) - 1 : 1;
}

} // namespace i2b
