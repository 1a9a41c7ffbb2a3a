// The openings that paint comes through (paint/leaks.h) as a PLY surface: binary little-endian, the faces of cells in them as
// quadrilaterals of their own corners, their normals towards what is beyond; the face property `leak` is the place of the opening in the
// list, which the report has in the same order.
#pragma once
#include "i2b/paint/regions.h"
#include <filesystem>
#include <vector>

namespace i2b {

void writeLeaks(const std::vector<Leak>& leaks, const std::filesystem::path& path); // throws Error{input}

} // namespace i2b
