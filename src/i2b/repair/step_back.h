// Faces that neither moves of single nodes nor changes of the mesh make divide into tetrahedra: those on which front and wall have been
// squeezed between two pieces of the geometry. All nodes around such a face go back together, part of their way to the start of
// the fit, those farther off less; then single nodes mend what that has left. What does not help is undone.
#pragma once
#include "i2b/repair/optimise.h"
#include <cstdint>
#include <vector>

namespace i2b {

struct StepBackInput {
    const PolyMesh& mesh;
    const Rows& cellFaces;
    const MeshFaults& faults;
    const Front& front;
    const LatticeMesh& lattice;
    double startThickness; // what buildFront() was given
    const DictionaryLimits& limits;
};

// faces: ascending, as facesBeyondHelp() gives them. Returns how many were mended; no other face or cell gets a fault that the last
// resort does not mend.
std::int64_t stepBackFrom(const std::vector<std::int32_t>& faces, const StepBackInput& in, Optimiser& optimiser);

} // namespace i2b
