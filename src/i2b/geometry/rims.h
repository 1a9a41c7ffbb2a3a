// The rims of open sheets: free edges where a sheet ends in the open, so that a mesh wraps round them and sees a fold
// of 180 degrees. A crack of a dirty soup has free edges, too, but something goes on behind them. To tell the two apart,
// look along the edge, at the cut across it:
//
//                . - .
//       \      /   gap  \          wedge: 60 degrees to both sides of the sheet
//        \    .          .
//     ====+===m          .         m: the edge, ====: its sheet
//        /    .          .
//       /      \        /          a triangle within gap of m and outside the wedge continues the sheet: a crack, an
//                ' - '             overlap, a wall that the sheet stands on or lies on; without one m is on a rim
#pragma once
#include "i2b/geometry/features.h"
#include "i2b/geometry/surface_index.h"

namespace i2b {

// Gives EdgeKind::rim to the free edges along most of whose length nothing continues the sheet within gap, and makes the
// ends, meetings and turns of rims corners. gap: m, mostly a cell or two; 0: ten times the graph's weldTolerance, which
// is also the least that counts. graph: of index.surface() with these options, whose angle (rims fold by 180
// degrees) and boxes hold for rims as for other edges. The same on any number of threads.
void markRims(FeatureGraph& graph, const SurfaceIndex& index, const FeatureOptions& options, double gap = 0);

// Per edge of the graph: is it such a free edge?
std::vector<std::uint8_t> findRims(const FeatureGraph& graph, const SurfaceIndex& index, const FeatureOptions& options, double gap = 0);

} // namespace i2b
