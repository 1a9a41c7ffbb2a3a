// Rims of sheets. There the wall folds back on itself, and two rows of its nodes want the same line: faces between them have next to no
// width, and where a front node stands in the plane of the sheet none of any width is right. So two wall nodes become one, on
// the rim, and the cell between them a wedge without a wall face, or nodes go to the rim by themselves: solvers take cells of any shape (Wang and
// Srinivasan 2002, section 4). Only where no measure that a check names is worse for it.
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
    std::int64_t closed = 0, moved = 0;  // pairs of nodes made one; nodes that went to the rim by themselves
    std::vector<std::int32_t> lostNodes; // ascending: places among the wall points of before
    std::vector<std::int32_t> lostFaces; // cells, ascending: one for each wall face that is gone
};

// mesh: with the wall of front, whose vertices its wall points follow. index: of the geometry that features are of. Points and faces are
// renumbered in their order, cells stay. The same on any number of threads.
ClosedRims closeRims(PolyMesh& mesh, const Front& front, const FeatureGraph& features, const SurfaceIndex& index, const DictionaryLimits& limits);

} // namespace i2b
