#include "i2b/carve/vertices.h"

namespace i2b {
namespace {

// Children of the coarse cells that lie beside cells of the next level; the others have no vertex in common with it.
Mask::Ptr childrenBeside(const Mask& coarse, const Mask& fineCells, const Index3& size) {
    const Mask::Ptr beside = dilated(*parentsOf(fineCells), 1, size);
    return childrenOf(*intersectionOf(coarse, *beside));
}

} // namespace

VertexLookup::VertexLookup(const CellGrid& grid, const std::vector<Mask::Ptr>& kept) : lattice_(grid.lattice) {
    for (const CellLevel& level : grid.levels) cells_.emplace_back(*level.cells);
    for (const Mask::Ptr& mask : kept) kept_.emplace_back(*mask);
}

bool VertexLookup::isCell(int level, const Index3& c) { return cells_[std::size_t(level)].isValueOn(toCoord(c)); }
bool VertexLookup::isKept(int level, const Index3& c) { return kept_[std::size_t(level)].isValueOn(toCoord(c)); }

bool VertexLookup::isCorner(int level, const Index3& v) {
    for (int o = 0; o < 8; ++o) {
        if (isCell(level, {v[0] - 1 + (o & 1), v[1] - 1 + (o >> 1 & 1), v[2] - 1 + (o >> 2)})) return true;
    }
    return false;
}

VertexView VertexLookup::view(int level, const Index3& v) {
    VertexView view;
    const Index3 n = lattice_.cells(level);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        if (v[axis] == 0) view.outside |= 1 << (2 * axis);
        if (v[axis] == n[axis]) view.outside |= 2 << (2 * axis);
    }
    int kept = 0;
    for (int o = 0; o < 8; ++o) {
        const Index3 c{v[0] - 1 + (o & 1), v[1] - 1 + (o >> 1 & 1), v[2] - 1 + (o >> 2)};
        Octant& octant = view.octants[std::size_t(o)];
        if (c[0] < 0 || c[1] < 0 || c[2] < 0 || c[0] >= n[0] || c[1] >= n[1] || c[2] >= n[2]) continue;
        octant.level = static_cast<std::int8_t>(level);
        octant.cell = c;
        if (isKept(level, c)) {
            octant.kept = true;
        } else if (!isCell(level, c) && level > 0) {
            octant.level = static_cast<std::int8_t>(level - 1);
            octant.cell = {c[0] >> 1, c[1] >> 1, c[2] >> 1};
            octant.kept = isKept(level - 1, octant.cell);
        }
        kept |= int(octant.kept) << o;
    }
    view.kept = view.outside ? mirrored(static_cast<std::uint8_t>(kept), view.outside) : static_cast<std::uint8_t>(kept);
    return view;
}

std::vector<Mask::Ptr> activeVertices(const CellGrid& grid, const std::vector<Mask::Ptr>& kept) {
    const std::size_t levels = grid.levels.size();
    std::vector<Mask::Ptr> active(levels);
    for (std::size_t l = 0; l < levels; ++l) {
        active[l] = cornersOf(*kept[l]);
        if (l == 0) continue;
        const Mask& cells = *grid.levels[l].cells;
        const Mask::Ptr coarse = childrenBeside(*kept[l - 1], cells, grid.lattice.cells(static_cast<int>(l) - 1));
        const Mask::Ptr hanging = intersectionOf(*cornersOf(*coarse), *cornersOf(*differenceOf(cells, *kept[l])));
        active[l]->topologyUnion(*hanging);
    }
    for (std::size_t l = 0; l + 1 < levels; ++l) active[l] = differenceOf(*active[l], *evenSamplesOf(*active[l + 1]));
    return active;
}

std::vector<Mask::Ptr> frontVertices(const CellGrid& grid, const std::vector<Mask::Ptr>& kept,
                                     const std::vector<Mask::Ptr>& active) {
    std::vector<Mask::Ptr> front(active.size());
    for (std::size_t l = 0; l < active.size(); ++l) {
        const Mask& cells = *grid.levels[l].cells;
        const Mask::Ptr removed = differenceOf(cells, *kept[l]);
        front[l] = intersectionOf(*active[l], *cornersOf(*removed));
        if (l == 0) continue;
        const Mask::Ptr coarseRemoved = differenceOf(*grid.levels[l - 1].cells, *kept[l - 1]);
        const Mask::Ptr coarse = childrenBeside(*coarseRemoved, cells, grid.lattice.cells(static_cast<int>(l) - 1));
        front[l]->topologyUnion(*intersectionOf(*active[l], *cornersOf(*coarse)));
    }
    return front;
}

} // namespace i2b
