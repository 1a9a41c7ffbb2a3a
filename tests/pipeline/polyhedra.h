// Convex and star polyhedra from the normals of their faces: Catalan solids have one face for each vertex of an
// Archimedean solid, square to it; the stars are their core's planes carried on until they meet again.
#pragma once
#include "i2b/samples/builder.h"
#include <vector>

namespace i2b::test {

// All points that come from p by permuting its coordinates and changing their signs, each once. evenSigns: only
// an even number of changes.
std::vector<Vec3> signedPermutations(const Vec3& p, bool evenSigns = false);

// The 12 vertices of an icosahedron, of length 1: the normals of a dodecahedron.
std::vector<Vec3> icosahedronVertices();

// The body n . x <= 1 for all normals n, closed, normals outwards. The normals must enclose the origin.
samples::Mesh polyhedron(const std::vector<Vec3>& normals);

// The same body with a pyramid on every face whose sides lie in the planes of the faces next to it: the stella
// octangula of an octahedron, the small stellated dodecahedron of a dodecahedron. Normals of one length.
samples::Mesh stellated(const std::vector<Vec3>& normals);

// Scaled about the origin so that the farthest point is at `radius`.
samples::Mesh fitted(samples::Mesh mesh, double radius);

} // namespace i2b::test
