#include "i2b/carve/flow_lookup.h"
#include "i2b/grid/leaf_cell.h"
#include "i2b/grid/neighbours.h"

namespace i2b {

// Is there a kept cell at `from`, of a level that may touch the given one's cells, whose centre sees the place?
bool FlowLookup::isSeen(const Vec3& place, const Vec3& from, std::size_t level) const {
    for (std::size_t k = 0; k < grid_.levels.size(); ++k) {
        if (!mayTouch(grid_.levels[k].level, grid_.levels[level].level)) continue;
        const Index3 cell = grid_.lattice.cellAt(grid_.levels[k].level, from);
        if (!kept_.levels[k]->isValueOn(toCoord(cell))) continue;
        return !index_.firstHit(grid_.lattice.cellBox(grid_.levels[k].level, cell).centre(), place);
    }
    return false;
}

bool FlowLookup::reaches(const Vec3& place) const {
    const Box domain = grid_.lattice.domain();
    const std::optional<LeafCell> cell = leafCellAt(grid_, place);
    if (!cell) return false;
    const std::size_t level = cell->level;
    if (isSeen(place, place, level)) return true;
    const Vec3 h = grid_.lattice.cellSize(grid_.levels[level].level);
    for (int i = 0; i < 27; ++i) {
        const Vec3 from = place + Vec3{h.x * (i % 3 - 1), h.y * (i / 3 % 3 - 1), h.z * (i / 9 - 1)};
        if (i != 13 && domain.contains(from) && isSeen(place, from, level)) return true;
    }
    return false;
}

} // namespace i2b
