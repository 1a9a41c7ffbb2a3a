// Quality cell by cell, for looking at: the worst of each cell's faces.
#pragma once
#include "i2b/assemble/mesh_topology.h"
#include <vector>

namespace i2b {

struct CellQuality {                     // one value per cell each
    std::vector<float> nonOrthogonality; // degrees, over internal faces
    std::vector<float> skewness;
    std::vector<float> volume;           // m^3
};

// cellFaces: of all cells, as buildCellFaces() gives them.
CellQuality measureCellQuality(const PolyMesh& mesh, const Rows& cellFaces);

} // namespace i2b
