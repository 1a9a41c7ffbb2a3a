// Changes of a PolyMesh that move no point: cells made one, the faces between them gone; faces divided into triangles.
#pragma once
#include "i2b/assemble/face_triangles.h"
#include "i2b/assemble/poly_mesh.h"
#include <cstdint>
#include <utility>
#include <vector>

namespace i2b {

struct MeshEdits {
    // Per cell the lowest cell of its group, itself where it stays alone. The cells of a group hang together through
    // faces, and no point lies inside them alone.
    std::vector<std::int32_t> groups;
    // Faces that become triangles, ascending; as trianglesOf() has them: the place among its vertices of the one that a fan is from,
    // or widest.
    std::vector<std::pair<std::int32_t, std::uint32_t>> divided;
};

// Cells are numbered in the order of their lowest; they carry its level and region, and of layers the one nearest the wall.
// Returns per former cell its number.
std::vector<std::int32_t> editMesh(PolyMesh& mesh, const MeshEdits& edits);

} // namespace i2b
