// Layers on a front that is made fit to carry them: walls that meet a side of the domain sharply are steepened
// (side_angles.h), columns bent off the wall (columns.h), faces too warped for their layers cut (warp.h).
#pragma once
#include "i2b/front/front.h"
#include "i2b/geometry/surface_index.h"
#include "i2b/layers/layer_stack.h"

namespace i2b {

struct LaidLayers {
    LayerStack stack;
    std::vector<std::uint8_t> movedWalls; // per vertex of the front: its wall position was changed; or empty
};

// Changes wall positions and faces of the front.
LaidLayers layOn(Front& front, const WallPlans& plans, const SurfaceIndex& index);

// Cuts the wall under cells of layers that could not be made valid, and lays the stack anew; false where nothing is left to
// be cut. core: number of cells before the layers'; cells: of the mesh.
bool cutUnderWrong(Front& front, LayerStack& stack, const WallPlans& plans, const SurfaceIndex& index, std::int32_t core, std::vector<std::int32_t> cells);

} // namespace i2b
