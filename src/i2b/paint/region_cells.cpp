#include "i2b/paint/region_cells.h"
#include <algorithm>
#include <limits>

namespace i2b {

RegionCells::RegionCells(const Regions& regions, std::int32_t region, const CellGrid& grid, const SurfaceIndex& index)
    : grid_(grid), touching_(touchingLevels(grid)) {
    std::int64_t first = 0;
    for (const Mask::Ptr& mask : regions.cellsOf(region)) {
        cells_.emplace_back(mask, first);
        first += cells_.back().size();
    }
    clearance_.resize(static_cast<std::size_t>(first));
    for (std::size_t l = 0; l < cells_.size(); ++l) {
        parallelFor(cells_[l].leafCount(), [&](std::size_t i) {
            Cell c{l, {}, cells_[l].leafFirst(i)};
            const Index3 o = toIndex(cells_[l].leaf(i).origin());
            double radius = std::numeric_limits<double>::infinity(); // the last one's answer bounds the next
            Vec3 before;
            bits::forEach(leafBits(&cells_[l].leaf(i)), [&](int x, int y, int z) {
                c.at = {o[0] + x, o[1] + y, o[2] + z};
                const Vec3 at = centre(c);
                radius = index.closest(at, (radius + norm(at - before)) * (1 + 1e-9)).distance;
                clearance_[static_cast<std::size_t>(c.number++)] = static_cast<float>(radius);
                before = at;
            });
        }, 8);
    }
}

std::optional<RegionCells::Cell> RegionCells::cellAt(const Vec3& place) const {
    for (std::size_t l = 0; l < cells_.size(); ++l) {
        const Index3 at = grid_.lattice.cellAt(grid_.levels[l].level, place);
        const std::int64_t number = RankedMask::Reader(cells_[l]).rank(at);
        if (number >= 0) return Cell{l, at, number};
    }
    return {};
}

RegionCells::Cell RegionCells::widest() const {
    const std::int64_t number = std::max_element(clearance_.begin(), clearance_.end()) - clearance_.begin();
    std::size_t l = 0;
    while (number >= cells_[l].first() + cells_[l].size()) ++l;
    return {l, cells_[l].at(number), number};
}

// On each axis along it the face is as long as the finer cell.
RegionCells::Corners RegionCells::faceBetween(const Cell& c, const Cell& beside, const Way& way) const {
    const Lattice& lattice = grid_.lattice;
    const Box a = lattice.cellBox(grid_.levels[c.level].level, c.at), b = lattice.cellBox(grid_.levels[beside.level].level, beside.at);
    Vec3 lo, hi;
    for (int k = 0; k < 3; ++k) lo[k] = std::max(a.lo[k], b.lo[k]), hi[k] = std::min(a.hi[k], b.hi[k]);
    const int axis = static_cast<int>(way.axis), u = (axis + 1) % 3, v = (axis + 2) % 3;
    lo[axis] = hi[axis] = way.side ? a.hi[axis] : a.lo[axis];
    Corners corners{lo, lo, hi, lo};
    corners[way.side ? 1 : 3][u] = hi[u];
    corners[way.side ? 3 : 1][v] = hi[v];
    return corners;
}

} // namespace i2b
