// Rims of sheets. There the wall folds back on itself, and two rows of its nodes want the same line: faces between them have next to no
// width, and where a front node stands in the plane of the sheet none of any width is right. So the strip of faces between the rows goes
// (zip_rims.h): its nodes are put on the rim, and the cells over it become wedges without a wall face. Then single pairs of nodes
// become one, or nodes go to the rim by themselves. Solvers take cells of any shape (Wang and Srinivasan 2002, section 4). Only where no
// measure that a check names is worse for it.
#pragma once
#include "i2b/assemble/poly_mesh.h"
#include "i2b/geometry/features.h"
#include "i2b/geometry/surface_index.h"
#include "i2b/quality/dictionary_limits.h"
#include <cstdint>
#include <vector>

namespace i2b {

struct Front;

struct ClosedRims {
    std::int64_t moved = 0;              // nodes that went to the rim by themselves
    std::vector<std::int32_t> lostNodes; // made one with others, ascending: places among the wall points of before
    std::vector<std::int32_t> lostFaces; // cells of before, ascending: one for each wall face that is gone
    std::vector<std::int32_t> cellOf;    // per cell of before its number now; empty where cells stay
};

// mesh: with the wall of front, whose vertices its wall points follow; cells from firstLayerCell on are layers. index: of the geometry that
// features are of. Points, faces and cells are renumbered in their order. The same on any number of threads.
ClosedRims closeRims(PolyMesh& mesh, const Front& front, const FeatureGraph& features, const SurfaceIndex& index, const DictionaryLimits& limits,
                     std::int32_t firstLayerCell);

} // namespace i2b
