// Where no move of nodes brings a face within the limits the mesh is changed: the face is divided into triangles, or a cell
// merged with a neighbour, since flow solvers take cells of any shape (Wang and Srinivasan 2002, section 2: badly shaped
// cells next to the wall). Either is done where it leaves fewer faces beyond the limits and nothing worse.
#pragma once
#include "i2b/assemble/poly_mesh.h"
#include "i2b/quality/dictionary_limits.h"
#include <cstdint>
#include <limits>
#include <vector>

namespace i2b {

struct LastResort {
    std::int64_t merged = 0, divided = 0; // cells that others have taken in, faces
    std::vector<std::int32_t> cellOf;     // per cell of before its number now; empty where none has merged
};

// poorFaces: ascending; what lies around them is looked at. Cells from thinFrom on are layers of a height that was asked for, and
// merge only with cells of the core.
LastResort changePoorPlaces(PolyMesh& mesh, const std::vector<std::int32_t>& poorFaces, const DictionaryLimits& limits,
                            std::int32_t thinFrom = std::numeric_limits<std::int32_t>::max());

} // namespace i2b
