// Which places the flow of the kept cells comes to.
#pragma once
#include "i2b/carve/kept_cells.h"
#include "i2b/geometry/surface_index.h"

namespace i2b {

class FlowLookup {
  public:
    // Keeps references to all three.
    FlowLookup(const CellGrid& grid, const KeptCells& kept, const SurfaceIndex& index) : grid_(grid), kept_(kept), index_(index) {}

    // Does the centre of the kept cell around a place, or of one beside that cell, see it? False outside the domain. May be asked
    // by any number of threads.
    bool reaches(const Vec3& place) const;

  private:
    bool isSeen(const Vec3& place, const Vec3& from, std::size_t level) const;

    const CellGrid& grid_;
    const KeptCells& kept_;
    const SurfaceIndex& index_;
};

} // namespace i2b
