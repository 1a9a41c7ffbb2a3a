// Quality cell by cell, for looking at: the worst of each cell's faces.
#pragma once
#include "i2b/assemble/mesh_topology.h"
#include "i2b/quality/mesh_geometry.h"
#include <vector>

namespace i2b {

struct CellQuality {                     // one value per cell each
    std::vector<float> nonOrthogonality; // degrees, over internal faces
    std::vector<float> skewness;
    std::vector<float> volume;           // m^3
};

// What a mesh's cells are made of, and what they come to: measureQuality() leaves it to whoever asks.
struct CellGeometry {
    Rows faces;                     // buildCellFaces()
    RawVector<CellMoments> moments; // per cell
};
CellGeometry geometryOfCells(const PolyMesh& mesh);

CellQuality measureCellQuality(const PolyMesh& mesh, const CellGeometry& cells);

} // namespace i2b
