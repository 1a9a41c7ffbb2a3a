// Places that the repair does not name to the last resort (last_resort.h), since it does not count them.
#pragma once
#include "i2b/assemble/mesh_topology.h"
#include "i2b/assemble/poly_mesh.h"
#include <cstdint>
#include <optional>
#include <vector>

namespace i2b {

// Faces, ascending, with a corner that turns back by about the angle (degrees) or more, as checkMesh asks: by its sine.
std::vector<std::int32_t> concaveFaces(const PolyMesh& mesh, double degrees);

// Faces, ascending, of the thin cells (from thinFrom on) whose determinant (cellFullness) is under a limit; nothing where more than 200
// and one in a thousand have that: it goes with their height then.
std::optional<std::vector<std::int32_t>> facesOfFlatCells(const PolyMesh& mesh, const Rows& cellFaces, std::int32_t thinFrom, double determinant);

} // namespace i2b
