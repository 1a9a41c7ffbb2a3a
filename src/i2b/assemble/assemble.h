// From kept cells, front and layers to the polyhedral mesh, in OpenFOAM's order: cells in lattice order, then the
// layer cells of each front face; internal faces by owner and neighbour; boundary faces by patch.
#pragma once
#include "i2b/assemble/poly_mesh.h"
#include "i2b/layers/layer_stack.h"
#include "i2b/paint/regions.h"

namespace i2b {

struct AssembleInput {
    const LatticeMesh& lattice;
    const KeptCells& kept;
    const Front& front;
    const LayerStack& layers;
    const std::vector<Part>& parts; // for patch names
};

// Throws Error(input) where the mesh has more than 2^31 labels.
PolyMesh assemble(const AssembleInput& input);

} // namespace i2b
