// Where no move of nodes brings a face within the limits the mesh is changed: the face is divided into triangles, or a cell
// merged with a neighbour, since flow solvers take cells of any shape (Wang and Srinivasan 2002, section 2: badly shaped
// cells next to the wall). Either is done where it leaves fewer faces beyond the limits and nothing worse.
#pragma once
#include "i2b/assemble/mesh_topology.h"
#include "i2b/assemble/poly_mesh.h"
#include "i2b/quality/dictionary_limits.h"
#include <cstdint>
#include <limits>
#include <vector>

namespace i2b {

// What was done, for the report.
struct MeshChanges {
    std::int64_t merged = 0, divided = 0; // cells that others have taken in, faces
    std::vector<Vec3> places;             // m, of the faces that were to be mended; as many as reports name
    std::int64_t joined = 0;              // wall nodes at rims of sheets that are now one with another (close_rims.h)
};

struct LastResort {
    MeshChanges changes;
    std::vector<std::int32_t> cellOf; // per cell of before its number now; empty where nothing was done
    std::vector<std::int32_t> morePieces; // cells of before, ascending: one for each face that walls have got there
};

// poorFaces: ascending, as MeshFaults names them; what lies around them is looked at. Cells from thinFrom on are layers of a height
// that was asked for, and merge only with cells of the core and those of their own column. cellFaces: of the mesh as it is given, which
// has others afterwards.
LastResort changePoorPlaces(PolyMesh& mesh, Rows cellFaces, const std::vector<std::int32_t>& poorFaces, const DictionaryLimits& limits,
                            std::int32_t thinFrom = std::numeric_limits<std::int32_t>::max());

// Those of the faces (ascending) that no such change would mend: still beyond limits, or beside one that is, when all have been tried.
// Changes nothing.
std::vector<std::int32_t> facesBeyondHelp(const PolyMesh& mesh, const Rows& cellFaces, const std::vector<std::int32_t>& poorFaces,
                                          const DictionaryLimits& limits, std::int32_t thinFrom = std::numeric_limits<std::int32_t>::max());

} // namespace i2b
