// The directions in which the columns of layers leave the wall.
#pragma once
#include "i2b/front/front.h"
#include <span>
#include <vector>

namespace i2b {

// The direction from which the worst seen of the faces with these unit normals is seen best: the axis of the smallest cone
// around them, which two or three of them determine. "Most normal" direction of Y. Kallinderis, S. Ward, Prismatic grid
// generation for three-dimensional complex geometries, AIAA Journal 31 (1993) 1850-1856; there found by iteration.
Vec3 mostNormal(std::span<const Vec3> normals);

// Per vertex of the front, a unit vector off the wall: the most normal direction of the wall faces around it, within the
// sides of the domain that it lies on; zero where none sees all of these faces.
std::vector<Vec3> wallNormals(const Front& front);

} // namespace i2b
