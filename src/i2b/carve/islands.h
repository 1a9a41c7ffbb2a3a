// A region whose narrowest places are too near the walls for cells falls apart. Its largest part is kept; the others are islands, which
// come back whole where a passage leads to them: no wall is where no geometry is.
#pragma once
#include "i2b/carve/vertices.h"
#include "i2b/paint/regions.h"
#include <cstdint>
#include <vector>

namespace i2b {

class Islands {
  public:
    // Takes all parts but the largest out of kept (by level).
    Islands(std::vector<Mask::Ptr>& kept, const CellGrid& grid);
    Islands(const Islands&) = delete;
    Islands& operator=(const Islands&) = delete;

    std::uint64_t cells() const { return cells_; } // of those that are out
    void addLargest(std::vector<Region>& to, std::uint64_t least) const; // those that are out, of so many cells
    // Puts those back that have one of these cells. Gives whether that puts back any other cell.
    bool bringBack(std::vector<Mask::Ptr>& kept, const std::vector<Place>& reached);

  private:
    std::int32_t islandAt(const Place& cell) const; // -1: none that is out

    Regions parts_;
    std::vector<std::vector<const RegionPiece*>> pieces_; // by level, those of parts_ that are of islands, by origin
    std::vector<std::uint8_t> isOut_;                     // per part
    std::uint64_t cells_ = 0;
};

} // namespace i2b
