// The adaptive Cartesian grid as sparse VDB topology: one mask tree of leaf cells per level triple. A tree node of 8x8x8
// cells is 64 bytes, so every operation here works on 64 cells a word.
#pragma once
#include "i2b/core/lattice.h"
#include "i2b/grid/vdb.h"
#include <string>
#include <vector>

namespace i2b {

using Mask = openvdb::MaskTree;

// One level of the 2^n tree. Trees hold leaf nodes only (no active tiles), in level coordinates.
struct CellLevel {
    LevelTriple level;
    Mask::Ptr cells;
};

// Invariants: leaf cells of all levels are disjoint and cover the domain box; cells that share a face, an edge or a
// corner differ by at most one level on each axis. Where all axes split together levels[l].level is (l, l, l) for
// every l; else the levels in use, by their finest axis, then in order. "Level k" of a cell is an index into this list.
struct CellGrid {
    Lattice lattice;
    std::vector<CellLevel> levels; // coarse to fine

    std::uint64_t cellCount() const;
    std::string validate() const;
    std::uint64_t checksum() const;
};

// The leaf cells that the geometry meets (closed, decided to the safe side): a subset of CellGrid's, by level.
struct CutCells {
    std::vector<Mask::Ptr> levels;

    std::uint64_t cellCount() const;
};

} // namespace i2b
