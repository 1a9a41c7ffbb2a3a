// The cell size that the curvature of a soup asks for. A smooth wall is told from its triangulation: the angle between
// two neighbours, over the arc that it turns along, is one over the radius. Orientation plays no part.
#pragma once
#include "i2b/geometry/surface.h"
#include <vector>

namespace i2b {

// Per triangle, in metres: the largest cell with so many cells per 360 degrees of the tightest arc to a neighbour;
// infinite where all neighbours lie in its plane or beyond the feature angle (degrees), and at edges of one or of
// three and more triangles. Points within a millionth of the extent are taken as one (but for a few pairs that
// straddle a step of the rounding). Costs one sort of the edges.
std::vector<double> curvatureSizes(const Surface& surface, double cellsPerCircle, double featureAngle);

} // namespace i2b
