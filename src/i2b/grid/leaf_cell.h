// The leaf cell of a grid that holds a place.
#pragma once
#include "i2b/grid/mask_ops.h"
#include <optional>

namespace i2b {

struct LeafCell {
    std::size_t level;
    Index3 at;
};

// Finest levels first, as places that are asked for lie beside walls. None outside the domain.
inline std::optional<LeafCell> leafCellAt(const CellGrid& grid, const Vec3& place) {
    if (!grid.lattice.domain().contains(place)) return {};
    for (std::size_t l = grid.levels.size(); l-- > 0;) {
        const Index3 at = grid.lattice.cellAt(grid.levels[l].level, place);
        if (grid.levels[l].cells->isValueOn(toCoord(at))) return LeafCell{l, at};
    }
    return {};
}

} // namespace i2b
