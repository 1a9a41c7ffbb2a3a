// Faces beyond the limits that neither moving columns (optimise.h) nor changing cells (last_resort.h) helps: the points of their cells,
// which no boundary holds, move one by one, whatever the layers (shape_zip.h).
#pragma once
#include "i2b/assemble/mesh_topology.h"
#include "i2b/quality/dictionary_limits.h"
#include <cstdint>
#include <vector>

namespace i2b {

// Moves points around the faces only where fewer faces are beyond the limits for it and nothing else is worse; none where there are too many
// faces for single points to be what is wrong. Gives the number of faces that this helped.
std::int64_t moveLastPoints(PolyMesh& mesh, const Rows& cellFaces, const std::vector<std::int32_t>& faces, const DictionaryLimits& limits);

} // namespace i2b
