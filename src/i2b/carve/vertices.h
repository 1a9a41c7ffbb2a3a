// Lattice vertices that the mesh will have: corners of cells, and the crossings of two cells' edges on the face between
// them (one cell is split along one axis, the cell across along the other). They are kept on lattices with the same
// level on all axes: a vertex belongs to the finest level, over all axes, of a cell that has it as a corner, a crossing
// to that of a cell around it; a vertex on the middle of a coarser cell's edge or face so belongs to the finer level.
#pragma once
#include "i2b/carve/kept_cells.h"
#include "i2b/carve/vertex_patterns.h"
#include "i2b/grid/neighbours.h"
#include "i2b/grid/resample.h"
#include <optional>

namespace i2b {

// A cell (level: index into CellGrid::levels) or a vertex (level: of its lattice).
struct Place {
    std::int32_t level = 0;
    Index3 at{};
    friend auto operator<=>(const Place&, const Place&) = default;
};

struct Octant {
    std::int16_t level = -1; // of the cell that fills it, index into CellGrid::levels; -1 outside the domain
    bool kept = false;
    Index3 cell{};           // in that level's coordinates
};

struct VertexView {
    std::array<Octant, 8> octants;
    std::uint8_t kept = 0;  // pattern, outside octants mirrored
    int outside = 0;        // bit 2 * axis (+ 1): the vertex lies on the low (high) side of the domain box
};

// A point on the lattice one level finer than the finest cells: corners and middles of all cells are whole there.
using FinePoint = std::array<std::int64_t, 3>;

// Looks at cells around vertices. Holds cached readers: one per thread.
class VertexLookup {
  public:
    VertexLookup(const CellGrid& grid, const std::vector<Mask::Ptr>& kept);
    VertexView view(int level, const Index3& v);
    VertexView view(const Place& v) { return view(v.level, v.at); }
    // The vertex at a point, on the level that it belongs to; none if there is none.
    std::optional<Place> vertexAt(const FinePoint& p);

    FinePoint fine(const Place& v) const;           // of a vertex
    FinePoint fine(const LevelTriple& level, const Index3& at) const;

  private:
    int vertexLevel(const FinePoint& p, const std::array<Octant, 8>& octants) const; // -1: no vertex
    bool find(const FinePoint& corner, Octant& octant); // the cell that holds the finest half cell with that low corner
    bool inCell(std::size_t level, const FinePoint& corner, Octant& octant);
    std::array<Octant, 8> around(const FinePoint& p);

    const CellGrid& grid_;
    std::vector<std::vector<std::size_t>> touching_;
    std::vector<MaskReader> cells_, kept_;
    std::size_t last_ = 0; // level of the cell found last: the next is likely to be of the same, or beside it
};

// By level: the vertices that touch a kept cell and are a corner of any cell.
std::vector<Mask::Ptr> activeVertices(const CellGrid& grid, const std::vector<Mask::Ptr>& kept);
// By level: those of them that touch a removed cell too.
std::vector<Mask::Ptr> frontVertices(const CellGrid& grid, const std::vector<Mask::Ptr>& kept,
                                     const std::vector<Mask::Ptr>& active);

} // namespace i2b
