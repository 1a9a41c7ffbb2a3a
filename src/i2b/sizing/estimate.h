// Whether a request fits the machine, before it is tried.
#pragma once
#include "i2b/sizing/size_field.h"

namespace i2b {

// A rough upper estimate of the memory that meshing (or only the grid stages) will take, in bytes.
double estimateBytes(const Surface& surface, const SizeField& field, int layers, bool gridOnly);

} // namespace i2b
