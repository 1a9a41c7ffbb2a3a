#include "i2b/carve/islands.h"
#include "i2b/core/parallel.h"
#include "i2b/grid/mask_ops.h"
#include "i2b/paint/paint.h"
#include <algorithm>

namespace i2b {
namespace {

using Index = std::size_t;
const std::array<std::int32_t, 3>& originOf(const RegionPiece* piece) { return piece->origin; }

} // namespace

Islands::Islands(std::vector<Mask::Ptr>& kept, const CellGrid& grid) : pieces_(kept.size()) {
    CutCells closed;
    for (Index l = 0; l < kept.size(); ++l) closed.levels.push_back(differenceOf(*grid.levels[l].cells, *kept[l]));
    parts_ = labelRegions(grid, closed);
    if (parts_.table.size() < 2) return;
    const auto largest = std::max_element(parts_.table.begin(), parts_.table.end(), [](const Region& a, const Region& b) { return a.volume < b.volume; });
    isOut_.assign(parts_.table.size(), 1);
    isOut_[Index(largest->id)] = 0;
    for (const Region& part : parts_.table) cells_ += isOut_[Index(part.id)] ? part.cells : 0;
    for (Index l = 0; l < kept.size(); ++l) {
        for (const RegionPiece& piece : parts_.pieces[l])
            if (piece.region != largest->id) pieces_[l].push_back(&piece);
        std::ranges::stable_sort(pieces_[l], {}, originOf);
    }
    kept = parts_.cellsOf(largest->id);
}

void Islands::addLargest(std::vector<Region>& to, std::uint64_t least) const {
    if (cells_ == 0) return;
    std::ranges::copy_if(parts_.table, std::back_inserter(to), [&](const Region& part) { return isOut_[Index(part.id)] != 0 && part.cells >= least; });
}

std::int32_t Islands::islandAt(const Place& cell) const {
    const std::array<std::int32_t, 3> origin{cell.at[0] & ~7, cell.at[1] & ~7, cell.at[2] & ~7};
    const int offset = bits::offset(cell.at[0], cell.at[1], cell.at[2]);
    for (const RegionPiece* piece : std::ranges::equal_range(pieces_[Index(cell.level)], origin, {}, originOf))
        if (bits::test(piece->mask, offset)) return isOut_[Index(piece->region)] ? piece->region : -1;
    return -1;
}

bool Islands::bringBack(std::vector<Mask::Ptr>& kept, const std::vector<Place>& reached) {
    if (cells_ == 0) return false;
    std::vector<std::int32_t> islands(reached.size());
    parallelFor(reached.size(), [&](Index i) { islands[i] = islandAt(reached[i]); }, 1024);
    std::vector<std::uint64_t> found(parts_.table.size(), 0); // cells reached, per part
    for (const std::int32_t island : islands)
        if (island >= 0) ++found[Index(island)];
    bool isMore = false;
    for (const Region& part : parts_.table) {
        const Index id = Index(part.id);
        if (found[id] == 0) continue;
        isMore = isMore || found[id] < part.cells;
        isOut_[id] = 0, cells_ -= part.cells;
    }
    for (Index l = 0; l < kept.size(); ++l) {
        openvdb::tree::ValueAccessor<Mask> write(*kept[l]);
        for (const RegionPiece* piece : pieces_[l])
            if (found[Index(piece->region)] > 0) setLeafBitsOn(write, toCoord(piece->origin), piece->mask);
    }
    return isMore;
}

} // namespace i2b
