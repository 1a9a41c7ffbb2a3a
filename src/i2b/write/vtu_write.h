// PolyMesh as a VTK XML unstructured grid: appended raw binary in zlib blocks of fixed size, compressed in
// parallel. Tetrahedra, pyramids, wedges and hexahedra as such, all other cells as VTK_POLYHEDRON
// (vtu_cells.h). Points are doubles; indices are 32-bit where they fit. Nothing but what is a few bytes a cell is held
// in memory beside the mesh and the faces of its cells (buildCellFaces()).
#pragma once
#include "i2b/assemble/mesh_topology.h"
#include "i2b/core/context.h"
#include "i2b/write/point_data.h"
#include <filesystem>
#include <string>
#include <vector>

namespace i2b {

// One value for each cell, e.g. "nonOrthogonality" (degrees), "skewness", "volume" (m^3), or for some of them.
struct CellData {
    std::string name;
    std::vector<float> values; // mesh.cells, or as many as `cells`
    const std::vector<std::int32_t>* cells = nullptr; // ascending: the cells that have a value; 0 elsewhere. Null: all
};

struct VtuWriteOptions {
    bool compress = true;
    int compression = 1; // 1 fast ... 12 small (libdeflate's levels)
};

// Cell data written: level, layer, region (where the mesh has them), patch (number of the first wall patch
// the cell lies at, else -1), then `data`; point data: `points`. Throws Error{input} (unwritable, disk full), Error{internal} (data
// of the wrong length) and Cancelled.
void writeVtu(const PolyMesh& mesh, const Rows& cellFaces, const std::vector<CellData>& data, const std::filesystem::path& path,
              const VtuWriteOptions& options, const Context& context, const std::vector<PointData>& points = {});

} // namespace i2b
