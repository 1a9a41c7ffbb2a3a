// The places that the user names, with a level each.
#pragma once
#include "i2b/sizing/size_field.h"

namespace i2b {

// Parts, boxes and shapes. Sizes beyond the limits are clamped, with a note; so are ratios of the sizes along the axes.
// index: as makeSizeField()'s.
void addSources(SizeField& field, const Surface& surface, const SizeOptions& size, const SurfaceIndex* index);

} // namespace i2b
