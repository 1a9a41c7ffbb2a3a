// What the geometry itself asks for: finer cells where it is curved and in narrow gaps.
#pragma once
#include "i2b/sizing/gaps.h"

namespace i2b {

// Both go down to size.min or, without it, half of size.surface; what that limit keeps from being met is noted.

// Adds triangleLevel for size.curvature. featureAngle: degrees; edges beyond it are no curvature.
void addCurvature(SizeField& field, const Surface& surface, const SizeOptions& size, double featureAngle);

// The gaps that size.gapCells asks for smaller cells in.
std::vector<Gap> findGaps(const SizeField& field, const SurfaceIndex& index, const SizeOptions& size);
// Adds them, or those of them that the flow comes to.
void addGaps(SizeField& field, const std::vector<Gap>& gaps, const SizeOptions& size);

} // namespace i2b
