#include "i2b/grid/wanted.h"
#include "i2b/grid/resample.h"

namespace i2b {
namespace {

// Adds cells of any level to what each axis wants.
void add(WantedCells& wanted, const Mask& cells, const LevelTriple& level) {
    if (isEmpty(cells)) return;
    if (level.same()) {
        for (std::size_t a = 0; a < (wanted.perAxis ? 3u : 1u); ++a) wanted.axis[a][level.x]->topologyUnion(cells);
        return;
    }
    for (std::size_t a = 0; a < 3; ++a) {
        wanted.axis[a][static_cast<std::size_t>(level[a])]->topologyUnion(*overlapping(cells, level, allAxes(level[a])));
    }
}

Mask::Ptr cellsOfBox(const Lattice& lattice, const Box& box, const LevelTriple& level) {
    auto mask = std::make_shared<Mask>(false);
    if (!box.overlaps(lattice.domain())) return mask;
    mask->denseFill(openvdb::CoordBBox(toCoord(lattice.cellAt(level, box.lo)), toCoord(lattice.cellAt(level, box.hi))), true, true);
    mask->voxelizeActiveTiles();
    return mask;
}

} // namespace

WantedCells wantedCells(const SizeField& field, const std::vector<CellLevel>& atTarget) {
    WantedCells wanted;
    for (const CellLevel& cut : atTarget) wanted.perAxis = wanted.perAxis || !cut.level.same();
    for (const LevelBox& rule : field.boxes) wanted.perAxis = wanted.perAxis || !rule.level.same();
    for (std::size_t a = 0; a < 3; ++a) {
        for (int l = 0; l <= field.lattice.maxLevel; ++l) {
            wanted.axis[a].push_back(a == 0 || wanted.perAxis ? std::make_shared<Mask>(false) : wanted.axis[0][std::size_t(l)]);
        }
    }
    for (const CellLevel& cut : atTarget) add(wanted, *cut.cells, cut.level);
    for (const LevelBox& rule : field.boxes) add(wanted, *cellsOfBox(field.lattice, rule.box, rule.level), rule.level);
    return wanted;
}

} // namespace i2b
