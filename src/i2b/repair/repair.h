// The last guard of validity. The fit judges cells by their corners, which is nearly, not quite, OpenFOAM's measure: nodes
// of wrong and poor cells are moved by that measure (optimise.h). Where a cell still has no positive volume or a face
// pyramid of it points the wrong way, the points around it step back towards the start of the fit, where every cell is
// right by construction, and so on until none is left. The slope of the retreat is bounded, so that it ends smoothly. For
// faces still over the limits of quality single wall nodes leave the geometry first, as a node that is a little off the
// wall is worth less than a mesh that passes its checks; the retreat comes last, as far as it helps, since it takes whole
// regions along. At the end wall nodes go on to their features and onto the geometry where no limit forbids it, and sharp edges that the wall
// has missed are sought anew (recapture.h).
#pragma once
#include "i2b/quality/dictionary_limits.h"
#include "i2b/repair/optimise.h"
#include <cstddef>
#include <cstdint>
#include <vector>

namespace i2b {

struct RepairSummary {
    int rounds = 0;
    std::int64_t moves = 0;      // of single nodes to better places
    std::int64_t badCells = 0;   // at the beginning
    std::int64_t retracted = 0;  // points that stepped back
    std::int64_t remaining = 0;  // bad cells at the end; 0 unless the start itself is wrong: thin layers over warped faces
    std::vector<std::int32_t> wrongCells;  // these
    std::int64_t poorFaces = 0;  // faces over the limits of non-orthogonality, skewness, weight or volume ratio at the
                                 // beginning, and cells of small determinant
    std::int64_t poorRemaining = 0;
    std::vector<std::int32_t> foldedCells; // thin ones with a face that does not divide, ascending
    std::vector<std::int32_t> unmended;    // faces with any fault at the end, and those of cells with one
    Rows cellFaces;                       // of the mesh, whose points alone have changed
    std::vector<std::uint8_t> movedWalls; // per vertex of the front: its wall position was changed
};

// startThickness: what buildFront() was given. Moves points of mesh, and front positions alike; columns of layers whose
// wall position steps back lose their bend with it. limits: what the last resort will be asked to hold; where it would not, wall nodes
// leave the geometry a little. Cutting the wall under thin layers comes before that: where so many thin cells as mostFolded or fewer
// keep a face that does not divide, it ends with these; 0: it goes on to the last.
RepairSummary repair(PolyMesh& mesh, Front& front, const LatticeMesh& lattice, LayerStack& layers, double startThickness,
                     const WallGuide& guide, const DictionaryLimits& limits, std::size_t mostFolded);

} // namespace i2b
