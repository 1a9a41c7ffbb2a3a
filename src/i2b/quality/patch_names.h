// Patches as users name them.
#pragma once
#include "i2b/assemble/poly_mesh.h"
#include <string>
#include <vector>

namespace i2b {

// The names of the patches, of any type and in their order, that one of the names or regular expressions means. Throws
// Error (usage) for one that is no expression, or means no patch: what follows would look like the fit of all walls.
std::vector<std::string> patchesNamed(const std::vector<Patch>& patches, const std::vector<std::string>& names);

} // namespace i2b
