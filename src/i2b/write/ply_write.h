// The wall of a mesh as a PLY surface: binary little-endian, polygons as they are, the patch of each face in
// the face property `part` (the order of the patches written; their names are comments in the header). Values of points
// are vertex properties after the coordinates.
#pragma once
#include "i2b/assemble/poly_mesh.h"
#include "i2b/core/context.h"
#include "i2b/write/point_data.h"
#include <filesystem>
#include <string>
#include <vector>

namespace i2b {

// Of the patches named, or of all patches of type wall. Normals point into the fluid, so that a body in a
// flow is a surface with its normals outwards. Points keep the order of the mesh. Throws Error{input},
// Cancelled.
void writePly(const PolyMesh& mesh, const std::filesystem::path& path, const Context& context,
              const std::vector<std::string>& patches = {}, const std::vector<PointData>& values = {});

} // namespace i2b
