// The layer cells over a wall face, from the wall to the front.
#pragma once
#include "i2b/assemble/mesh_topology.h"
#include "i2b/assemble/poly_mesh.h"
#include <cstdint>
#include <optional>
#include <vector>

namespace i2b {

struct LayerColumn {
    using Loop = std::vector<std::int32_t>;
    std::vector<std::int32_t> cells;  // from the wall on
    std::vector<Loop> levels;         // one more: points, each over its own of the wall face; the last are on the front
};

// wallFace: of the boundary; cells from firstLayerCell on are layers. None where layers are not one upon the other there.
std::optional<LayerColumn> layerColumn(const PolyMesh& mesh, const Rows& cellFaces, std::int32_t wallFace, std::int32_t firstLayerCell);

} // namespace i2b
