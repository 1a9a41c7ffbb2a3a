#include "i2b/grid/build.h"
#include "i2b/core/checksum.h"
#include "i2b/grid/mask_ops.h"
#include "i2b/grid/neighbours.h"
#include "i2b/grid/octree.h"
#include "i2b/grid/resample.h"
#include "i2b/grid/splits.h"
#include <fmt/format.h>

namespace i2b {

namespace {

// Parents of what is wanted or split at the level below, and of the buffer around it.
Mask::Ptr splitAbove(const Mask& wanted, const Mask& split, int buffer, const Lattice& lattice, int level) {
    const Index3 size = lattice.cells(level);
    if (buffer <= 8) return parentsAround(wanted, split, buffer, size);
    const Mask::Ptr grown = dilated(*unionOf(wanted, split), buffer - 8, lattice.cells(level + 1));
    return parentsAround(*grown, Mask(false), 8, size);
}

// All axes together: an octree, one mask a level.
std::vector<CellLevel> octreeLeaves(const SizeField& field, const std::vector<Mask::Ptr>& walls, const std::vector<Mask::Ptr>& spaces) {
    const Lattice& lattice = field.lattice;
    const auto levels = static_cast<std::size_t>(lattice.maxLevel) + 1;
    std::vector<Mask::Ptr> split(levels); // cells of level l that are split
    split[levels - 1] = std::make_shared<Mask>(false);
    for (std::size_t l = levels - 1; l-- > 0;) {
        split[l] = splitAbove(*walls[l + 1], *split[l + 1], field.bufferCells, lattice, static_cast<int>(l));
        if (!isEmpty(*spaces[l + 1])) split[l]->topologyUnion(*parentsOf(*spaces[l + 1]));
    }
    std::vector<CellLevel> leaves;
    for (std::size_t l = 0; l < levels; ++l) {
        const Mask::Ptr cells = l == 0 ? boxLess(lattice.count, *split[0]) : childrenLess(*split[l - 1], *split[l]);
        leaves.push_back({allAxes(static_cast<int>(l)), cells});
        if (l > 0) split[l - 1].reset(); // its memory is what the next level needs
    }
    return leaves;
}

} // namespace

CellGrid buildCellGrid(const SizeField& field, const WantedCells& wanted) {
    CellGrid grid;
    grid.lattice = field.lattice;
    grid.levels = wanted.perAxis ? leavesOfSplits(field.lattice, settleSplits(field, wanted))
                                 : octreeLeaves(field, wanted.walls[0], wanted.spaces[0]);
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

namespace {

// True if a cell of one level touches a cell of the other, be it in a corner.
bool touch(const Lattice& lattice, const CellLevel& a, const CellLevel& b) {
    const LevelTriple low = coarserOf(a.level, b.level), fine = finerOf(a.level, b.level);
    const Mask::Ptr place = dilated(*overlapping(*b.cells, b.level, low), 1, lattice.cells(low));
    const Mask::Ptr near = intersectionOf(*a.cells, *overlapping(*place, low, a.level));
    const Mask::Ptr around = dilated(*overlapping(*near, a.level, fine), 1, lattice.cells(fine));
    return sharesVolume(*around, fine, *b.cells, b.level);
}

std::string nameOf(const LevelTriple& l) {
    return l.same() ? fmt::format("{}", l.x) : fmt::format("({} {} {})", l.x, l.y, l.z);
}

} // namespace

std::string CellGrid::validate() const {
    double volume = 0, whole = 1;
    for (std::size_t i = 0; i < 3; ++i) whole *= lattice.count[i];
    for (std::size_t k = 0; k < levels.size(); ++k) {
        const auto& [level, cells] = levels[k];
        volume += std::ldexp(static_cast<double>(countOf(*cells)), -(level.x + level.y + level.z));
        if (cells->hasActiveTiles()) return fmt::format("active tile at level {}", nameOf(level));
        if (level.finest() > lattice.maxLevel) return fmt::format("level {} is beyond the lattice's", nameOf(level));
        for (std::size_t m = 0; m < k; ++m) {
            if (sharesVolume(*cells, level, *levels[m].cells, levels[m].level)) {
                return fmt::format("levels {} and {} overlap", nameOf(level), nameOf(levels[m].level));
            }
            if (!mayTouch(level, levels[m].level) && touch(lattice, levels[m], levels[k])) {
                return fmt::format("a cell of level {} touches one of level {}", nameOf(level), nameOf(levels[m].level));
            }
        }
    }
    if (volume != whole) return fmt::format("cells cover {} of {} base cells", volume, whole);
    return "";
}

} // namespace i2b
