// Lattice vertices that the mesh will have. A vertex belongs to the finest level of a cell that has it as a corner;
// a vertex on the middle of a coarse cell's edge or face so belongs to the finer level beside it.
#pragma once
#include "i2b/carve/kept_cells.h"
#include "i2b/carve/vertex_patterns.h"
#include "i2b/grid/mask_ops.h"

namespace i2b {

struct Octant {
    std::int8_t level = -1; // of the cell that fills it; -1 outside the domain
    bool kept = false;
    Index3 cell{};          // in that level's coordinates
};

struct VertexView {
    std::array<Octant, 8> octants;
    std::uint8_t kept = 0;  // pattern, outside octants mirrored
    int outside = 0;        // bit 2 * axis (+ 1): the vertex lies on the low (high) side of the domain box
};

// Looks at cells around vertices. Holds cached readers: one per thread.
class VertexLookup {
  public:
    VertexLookup(const CellGrid& grid, const std::vector<Mask::Ptr>& kept);
    VertexView view(int level, const Index3& v);
    bool isCell(int level, const Index3& c);
    bool isKept(int level, const Index3& c);
    // True if v is a corner of a leaf cell of the level.
    bool isCorner(int level, const Index3& v);

  private:
    const Lattice& lattice_;
    std::vector<MaskReader> cells_, kept_;
};

// By level: the vertices that touch a kept cell and are a corner of any cell.
std::vector<Mask::Ptr> activeVertices(const CellGrid& grid, const std::vector<Mask::Ptr>& kept);
// By level: those of them that touch a removed cell too.
std::vector<Mask::Ptr> frontVertices(const CellGrid& grid, const std::vector<Mask::Ptr>& kept,
                                     const std::vector<Mask::Ptr>& active);

} // namespace i2b
