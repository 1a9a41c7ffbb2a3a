// Random adaptive grids and cell masks, and a plain array over the finest cells to hold results against.
#pragma once
#include "i2b/core/error.h"
#include "i2b/grid/build.h"
#include "i2b/grid/mask_ops.h"
#include "i2b/paint/paint.h"
#include <random>

namespace i2b::test {

// Wanted cells at random places of random levels; levels - 1 is the finest. perAxis: each axis wants its own.
inline CellGrid randomGrid(unsigned seed, const Index3& count, int levels, int buffer, bool perAxis = false) {
    std::mt19937 random(seed);
    SizeField field;
    field.lattice.origin = {-1, 2, 0.5};
    field.lattice.base = {0.5, 0.25, 0.375}; // exact in binary, and different along each axis
    field.lattice.count = count;
    field.lattice.maxLevel = levels - 1;
    field.bufferCells = buffer;
    WantedCells wanted;
    wanted.perAxis = perAxis;
    for (std::size_t axis = 0; axis < (perAxis ? 3u : 1u); ++axis) {
        for (int l = 0; l < levels; ++l) {
            auto mask = std::make_shared<Mask>(false);
            const Index3 n = field.lattice.cells(l);
            for (int i = 0; i < 2 && l > 0; ++i) {
                Index3 c{};
                for (std::size_t a = 0; a < 3; ++a)
                    c[a] = static_cast<std::int32_t>(random() % static_cast<unsigned>(n[a]));
                mask->setValueOn(toCoord(c));
            }
            wanted.walls[axis].push_back(mask);
            wanted.spaces[axis].push_back(std::make_shared<Mask>(false));
        }
    }
    if (perAxis) return buildCellGrid(field, wanted);
    for (auto* lists : {&wanted.walls, &wanted.spaces}) (*lists)[1] = (*lists)[2] = (*lists)[0];
    return buildCellGrid(field, wanted);
}

struct GridCell {
    int level = 0; // index into CellGrid::levels
    LevelTriple triple;
    Index3 at{};
};

// Cells in the order of their numbers: by level, then tree order. at(): which cell fills a place of the
// finest lattice.
class CellArray {
  public:
    explicit CellArray(const CellGrid& grid)
        : lattice(grid.lattice), size(grid.lattice.cells(grid.lattice.maxLevel)) {
        cell_.assign(static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1]) *
                         static_cast<std::size_t>(size[2]),
                     -1);
        for (std::size_t l = 0; l < grid.levels.size(); ++l) {
            for (const MaskLeaf* leaf : leavesOf(static_cast<const Mask&>(*grid.levels[l].cells))) {
                for (auto it = leaf->cbeginValueOn(); it; ++it) {
                    cells.push_back({static_cast<int>(l), grid.levels[l].level, toIndex(it.getCoord())});
                    fill(static_cast<int>(cells.size()) - 1);
                }
            }
        }
    }
    // Finest cells along each edge of a cell.
    Index3 span(int cell) const {
        const LevelTriple& l = cells[static_cast<std::size_t>(cell)].triple;
        return {1 << (lattice.maxLevel - l.x), 1 << (lattice.maxLevel - l.y), 1 << (lattice.maxLevel - l.z)};
    }
    bool inside(const Index3& p) const {
        return p[0] >= 0 && p[1] >= 0 && p[2] >= 0 && p[0] < size[0] && p[1] < size[1] && p[2] < size[2];
    }
    int at(const Index3& p) const { return inside(p) ? cell_[offset(p)] : -1; }

    std::vector<bool> flagged(const std::vector<Mask::Ptr>& masks) const {
        std::vector<bool> flags(cells.size());
        for (std::size_t i = 0; i < cells.size(); ++i) {
            flags[i] = masks[static_cast<std::size_t>(cells[i].level)]->isValueOn(toCoord(cells[i].at));
        }
        return flags;
    }
    // Face-connected components of the open cells, numbered by their first cell; -1 where closed.
    std::vector<int> flood(const std::vector<bool>& open) const {
        std::vector<std::vector<int>> beside(cells.size());
        for (int x = 0; x < size[0]; ++x) {
            for (int y = 0; y < size[1]; ++y) {
                for (int z = 0; z < size[2]; ++z) {
                    const int a = at({x, y, z});
                    for (int b : {at({x + 1, y, z}), at({x, y + 1, z}), at({x, y, z + 1})}) {
                        if (b < 0 || a == b) continue;
                        beside[static_cast<std::size_t>(a)].push_back(b);
                        beside[static_cast<std::size_t>(b)].push_back(a);
                    }
                }
            }
        }
        std::vector<int> label(cells.size(), -1);
        int count = 0;
        for (std::size_t i = 0; i < cells.size(); ++i) {
            if (!open[i] || label[i] >= 0) continue;
            std::vector<std::size_t> stack{i};
            label[i] = count;
            while (!stack.empty()) {
                const std::size_t c = stack.back();
                stack.pop_back();
                for (int n : beside[c]) {
                    const auto b = static_cast<std::size_t>(n);
                    if (open[b] && label[b] < 0) label[b] = count, stack.push_back(b);
                }
            }
            ++count;
        }
        return label;
    }

    Lattice lattice;
    Index3 size;
    std::vector<GridCell> cells;

  private:
    void fill(int cell) {
        const Index3 s = span(cell), &c = cells[static_cast<std::size_t>(cell)].at;
        for (int i = 0; i < s[0] * s[1] * s[2]; ++i) {
            cell_[offset({c[0] * s[0] + i % s[0], c[1] * s[1] + i / s[0] % s[1], c[2] * s[2] + i / s[0] / s[1]})] = cell;
        }
    }
    std::size_t offset(const Index3& p) const {
        return (static_cast<std::size_t>(p[0]) * static_cast<std::size_t>(size[1]) +
                static_cast<std::size_t>(p[1])) *
                   static_cast<std::size_t>(size[2]) +
               static_cast<std::size_t>(p[2]);
    }
    std::vector<int> cell_;
};

// Every cell with the given probability.
inline CutCells randomCut(const CellGrid& grid, unsigned seed, double probability) {
    std::mt19937 random(seed);
    CutCells cut;
    for (const CellLevel& level : grid.levels) {
        auto mask = std::make_shared<Mask>(false);
        for (auto it = level.cells->cbeginValueOn(); it; ++it) {
            if (static_cast<double>(random()) < probability * 4294967296.0) mask->setValueOn(it.getCoord());
        }
        cut.levels.push_back(mask);
    }
    return cut;
}

} // namespace i2b::test
