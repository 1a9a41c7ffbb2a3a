#include "i2b/layers/lay_on.h"
#include "i2b/layers/columns.h"
#include "i2b/layers/side_angles.h"
#include "i2b/layers/warp.h"
#include <algorithm>

namespace i2b {

LaidLayers layOn(Front& front, const WallPlans& plans, const SurfaceIndex& index) {
    LaidLayers laid{makeLayers(front, plans), {}};
    LayerStack& stack = laid.stack;
    if (stack.areThin()) {
        laid.movedWalls = steepenAtSides(front);
        stack = makeLayers(front, plans);
    }
    bendColumns(front, stack);
    if (cutWarped(front, stack, index) > 0) {
        stack = makeLayers(front, plans);
        bendColumns(front, stack);
    }
    return laid;
}

bool cutUnderWrong(Front& front, LayerStack& stack, const WallPlans& plans, const SurfaceIndex& index, std::int32_t core, std::vector<std::int32_t> cells) {
    std::erase_if(cells, [&](std::int32_t c) { return c < core; });
    for (std::int32_t& c : cells) c -= core;
    if (cutUnder(front, stack, index, cells) == 0) return false;
    stack = makeLayers(front, plans);
    bendColumns(front, stack);
    return true;
}

} // namespace i2b
