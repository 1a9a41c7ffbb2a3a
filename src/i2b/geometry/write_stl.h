// Writing of a Surface's triangles as STL. ASCII keeps every digit of the doubles and all parts (one solid
// each); binary is single precision and has one solid. Lines and free points have no place in STL and are
// left out.
#pragma once
#include "i2b/geometry/surface.h"
#include <string>
#include <vector>

namespace i2b {

enum class StlFormat { ascii, binary };

// Written beside the final name and renamed, so that no half-written file is left. Throws Error (input) if it
// cannot be written, or has more triangles than binary STL counts (2^32 - 1).
void writeStl(const Surface& surface, const std::string& path, StlFormat format);

// One <part name>.stl for every part with triangles, in a folder that is made if need be. Gives the paths.
std::vector<std::string> writeStlFolder(const Surface& surface, const std::string& folder, StlFormat format);

} // namespace i2b
