// Which axes split where, when the axes go their own ways (the 2^n tree of Wang and Srinivasan 2002, section 3).
#pragma once
#include "i2b/grid/wanted.h"

namespace i2b {

// A 2^n tree seen axis by axis. The cell that fills a place after l rounds of splitting has, on each axis, level l or
// the level at which that axis stopped. axis[a][l]: cells of level l (same on all axes) whose place is split along a in
// round l, from level l to l + 1.
//
// Invariants, which settleSplits() establishes as the least sets that hold what is wanted:
//   nested   axis[a][l] lies in axis[a][l - 1]
//   whole    axis[a][l] is a union of the cells that are there after l rounds
//   graded   every cell that touches one that is split along a in round l was split along a in round l - 1
struct AxisSplits {
    std::array<std::vector<Mask::Ptr>, 3> axis;
};

AxisSplits settleSplits(const SizeField& field, const WantedCells& wanted);

// The leaf cells, by level, coarse to fine; levels without cells are left out.
std::vector<CellLevel> leavesOfSplits(const Lattice& lattice, const AxisSplits& splits);

} // namespace i2b
