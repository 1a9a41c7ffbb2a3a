// What the geometry itself asks for: finer cells where it is curved and in narrow gaps.
#pragma once
#include "i2b/sizing/size_field.h"

namespace i2b {

// Adds triangleLevel for size.curvature and gaps for size.gapCells, down to size.min or, without it, half of
// size.surface; notes what that limit keeps from being met. featureAngle: degrees; edges beyond it are no curvature.
void addAutomaticSizes(SizeField& field, const SurfaceIndex& index, const SizeOptions& size, double featureAngle);

} // namespace i2b
