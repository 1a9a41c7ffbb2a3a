#include "i2b/grid/build.h"
#include "i2b/core/checksum.h"
#include "i2b/grid/mask_ops.h"
#include <fmt/format.h>

namespace i2b {

std::vector<Mask::Ptr> wantedByBoxes(const SizeField& field) {
    std::vector<Mask::Ptr> wanted;
    for (int l = 0; l <= field.lattice.maxLevel; ++l) {
        auto mask = std::make_shared<Mask>(false);
        for (const LevelBox& rule : field.boxes) {
            if (rule.level != l || !rule.box.overlaps(field.lattice.domain())) continue;
            const Index3 lo = field.lattice.cellAt(l, rule.box.lo), hi = field.lattice.cellAt(l, rule.box.hi);
            mask->denseFill(openvdb::CoordBBox(toCoord(lo), toCoord(hi)), true, true);
        }
        mask->voxelizeActiveTiles();
        wanted.push_back(mask);
    }
    return wanted;
}

CellGrid buildCellGrid(const SizeField& field, const std::vector<Mask::Ptr>& wanted) {
    const Lattice& lattice = field.lattice;
    const auto levels = static_cast<std::size_t>(lattice.maxLevel) + 1;
    std::vector<Mask::Ptr> refined(levels); // cells of level l that are split
    refined[levels - 1] = std::make_shared<Mask>(false);
    for (std::size_t l = levels - 1; l-- > 0;) {
        const Mask::Ptr below = unionOf(*wanted[l + 1], *refined[l + 1]);
        refined[l] = parentsOf(*dilated(*below, field.bufferCells, lattice.cells(static_cast<int>(l) + 1)));
    }
    CellGrid grid;
    grid.lattice = lattice;
    for (std::size_t l = 0; l < levels; ++l) {
        const Mask::Ptr all = l == 0 ? filledBox(lattice.count) : childrenOf(*refined[l - 1]);
        const auto level = static_cast<std::uint8_t>(l);
        grid.levels.push_back({{level, level, level}, differenceOf(*all, *refined[l])});
    }
    return grid;
}

std::uint64_t CellGrid::cellCount() const {
    std::uint64_t n = 0;
    for (const CellLevel& level : levels) n += countOf(*level.cells);
    return n;
}

std::uint64_t CutCells::cellCount() const {
    std::uint64_t n = 0;
    for (const Mask::Ptr& level : levels) n += countOf(*level);
    return n;
}

std::uint64_t CellGrid::checksum() const {
    Checksum sum;
    sum.bytes(&lattice.origin, sizeof lattice.origin);
    sum.bytes(&lattice.base, sizeof lattice.base);
    for (const CellLevel& level : levels) addTo(sum, *level.cells);
    return sum.value();
}

std::string CellGrid::validate() const {
    if (levels.size() != static_cast<std::size_t>(lattice.maxLevel) + 1) return "one mask per level expected";
    double volume = 0, whole = 1;
    for (std::size_t i = 0; i < 3; ++i) whole *= lattice.count[i];
    for (std::size_t l = 0; l < levels.size(); ++l) {
        volume += std::ldexp(static_cast<double>(countOf(*levels[l].cells)), -3 * static_cast<int>(l));
        if (levels[l].cells->hasActiveTiles()) return fmt::format("active tile at level {}", l);
        if (l == 0) continue;
        // Cells beside a finer one, or an ancestor of one, must have ancestors' neighbours: no leaf two levels up.
        const Mask::Ptr parents = parentsOf(*levels[l].cells);
        if (countOf(*intersectionOf(*parents, *levels[l - 1].cells)) != 0) return fmt::format("levels {} and {} overlap", l - 1, l);
        if (l < 2) continue;
        const Mask::Ptr around = dilated(*levels[l].cells, 1, lattice.cells(static_cast<int>(l)));
        const Mask::Ptr grand = parentsOf(*parentsOf(*around));
        if (countOf(*intersectionOf(*grand, *levels[l - 2].cells)) != 0) {
            return fmt::format("a cell of level {} touches one of level {}", l, l - 2);
        }
    }
    if (volume != whole) return fmt::format("cells cover {} of {} base cells", volume, whole);
    return "";
}

} // namespace i2b
