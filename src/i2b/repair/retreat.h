// The way back of the points around wrong and poor cells: towards the start of the fit, where every cell is right by
// construction, with a bounded slope so that it ends smoothly.
#pragma once
#include "i2b/assemble/assemble.h"
#include "i2b/quality/mesh_faults.h"
#include "i2b/repair/mesh_nodes.h"
#include <cstdint>
#include <vector>

namespace i2b {

// What asks for it: cells that are wrong; also faces that are severely non-orthogonal or skew; also all poor ones.
enum class RetreatFrom : std::uint8_t { wrong, severe, poor };

struct RetreatSummary {
    int rounds = 0;
    std::int64_t retracted = 0;           // nodes that stepped back
    std::vector<std::int32_t> wrongCells; // that are left
};

// Steps back until nothing is wrong, then, if asked to, for quality as long as it helps. Moves points of mesh and front; columns
// lose their bend with it. startThickness: what buildFront() was given. faults and meshNodes: of mesh; the faults kept up to date.
RetreatSummary retreatFromFaults(PolyMesh& mesh, const Rows& cellFaces, MeshFaults& faults, Front& front, const MeshNodes& meshNodes, const LatticeMesh& lattice,
                                 LayerStack& layers, double startThickness, RetreatFrom from);

} // namespace i2b
