// The cells of one region, numbered, with their neighbours across faces, and how far from the geometry each is: four bytes a
// cell beside the region's bits.
#pragma once
#include "i2b/geometry/surface_index.h"
#include "i2b/grid/neighbours.h"
#include "i2b/grid/ranked_mask.h"
#include "i2b/paint/regions.h"
#include <optional>

namespace i2b {

class RegionCells {
  public:
    struct Cell {
        std::size_t level = 0;
        Index3 at{};
        std::int64_t number = 0; // by level, then as RankedMask numbers them
    };
    struct Way { // out of a cell
        std::size_t axis;
        int side; // 0 low, 1 high
    };
    using Corners = std::array<Vec3, 4>; // m, of a face, around it, the right-hand rule out of the cell

    // Keeps a reference to grid. Measures the clearances of all cells.
    RegionCells(const Regions& regions, std::int32_t region, const CellGrid& grid, const SurfaceIndex& index);

    std::size_t size() const { return clearance_.size(); }
    std::size_t levels() const { return cells_.size(); }
    const RankedMask& level(std::size_t l) const { return cells_[l]; }
    double clearance(const Cell& c) const { return clearance_[static_cast<std::size_t>(c.number)]; } // m, of its centre from the geometry
    Vec3 centre(const Cell& c) const { return grid_.lattice.cellBox(grid_.levels[c.level].level, c.at).centre(); }
    double h(const Cell& c) const { return grid_.lattice.h(grid_.levels[c.level].level); }
    std::optional<Cell> cellAt(const Vec3& place) const;
    Cell widest() const; // of the largest clearance; of several the first
    Corners faceBetween(const Cell& c, const Cell& beside, const Way& way) const;

    // Looks cells up; not to be shared between threads.
    class Reader {
      public:
        explicit Reader(const RegionCells& cells);
        // f(cell, way to it) for every cell of the region across a face of this one.
        template <class F>
        void forEachNeighbour(const Cell& c, const F& f);

      private:
        template <class F>
        void across(const Cell& c, const Way& way, const F& f);

        const RegionCells& cells_;
        std::vector<RankedMask::Reader> readers_; // by level
    };

  private:
    const CellGrid& grid_;
    std::vector<RankedMask> cells_; // by level
    std::vector<std::vector<std::size_t>> touching_;
    std::vector<float> clearance_;
};

inline RegionCells::Reader::Reader(const RegionCells& cells) : cells_(cells) {
    for (const RankedMask& level : cells.cells_) readers_.emplace_back(level);
}

template <class F>
void RegionCells::Reader::forEachNeighbour(const Cell& c, const F& f) {
    for (std::size_t axis = 0; axis < 3; ++axis)
        for (int side = 0; side < 2; ++side)
            if (side == 1 || c.at[axis] > 0) across(c, {axis, side}, f);
}

template <class F>
void RegionCells::Reader::across(const Cell& c, const Way& way, const F& f) {
    const auto give = [&](std::size_t level, const Index3& at) {
        const std::int64_t number = readers_[level].rank(at);
        if (number < 0) return false;
        f(Cell{level, at, number}, way);
        return true;
    };
    Index3 next = c.at;
    next[way.axis] += way.side ? 1 : -1;
    if (give(c.level, next)) return;
    const CellGrid& grid = cells_.grid_;
    for (const std::size_t m : cells_.touching_[c.level])
        forEachAcross(c.at, grid.levels[c.level].level, grid.levels[m].level, way.axis, way.side, [&](const Index3& n) { give(m, n); });
}

} // namespace i2b
