// The cells of a PolyMesh in VTK's terms: tetrahedra, pyramids, wedges and hexahedra are recognised by their
// topology, everything else is a polyhedron given by its faces.
//
//        7-------6
//       /|      /|      hexahedron: 0 1 2 3 seen from inside run with the right hand, 4 5 6 7 above them
//      4-------5 |
//      | 3-----|-2
//      |/      |/
//      0-------1
#pragma once
#include "i2b/assemble/poly_mesh.h"
#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace i2b {

// VTK's numbers of cell types.
enum class VtkCell : std::uint8_t { tetra = 10, hexahedron = 12, wedge = 13, pyramid = 14, polyhedron = 42 };

// The type of a cell and, unless it is a polyhedron, its points in VTK's order.
struct CellShape {
    VtkCell type = VtkCell::polyhedron;
    std::array<std::int32_t, 8> points{};
    std::size_t pointCount = 0;
};
CellShape shapeOf(const PolyMesh& mesh, std::span<const std::int32_t> cellFaces, std::int32_t cell);

// Distinct points of a cell, ascending, into `out` (overwritten).
void cellPoints(const PolyMesh& mesh, std::span<const std::int32_t> cellFaces,
                std::vector<std::int32_t>& out);

// VTK's face stream of a polyhedron appended to `out`: faces, then for each its number of points and the
// points, seen from outside with the right hand.
void appendFaceStream(const PolyMesh& mesh, std::span<const std::int32_t> cellFaces, std::int32_t cell,
                      std::vector<std::int32_t>& out);

} // namespace i2b
