// Why wall nodes stay off the geometry at the end of the fit. What the steps of the fit have looked at is looked at once
// more, for these few nodes: their targets, the ways there, the floor of the exact snap, and the geometry around.
//
// Looked at in this order, the first that holds:
//   bridged        no geometry within 2 h: the wall closes off a room that the flow must not enter
//   box side       its target within the sides of the domain that it lies in is itself off the geometry
//   feature off    it is held to a feature and has come within 0.01 h of its place on it
//   sheet between  its front node stands behind geometry, or other geometry is met on the way from there to the node or
//                  to its target (more than 0.05 h before the end, as the fit allows)
//   unfinished     the exact snap would take the whole way now
//   feature        it is held to a feature
//   bridged, gap   geometry on both sides of the node, over less than 2 h: bridged where there is nothing behind within half
//                  a cell but the rim, else a gap; or geometry on the far side of the flow within 2 h of the target: a gap
//   beside edge    a feature within h, or a neighbour's normal of the geometry over 35 degrees from its own
//   quality        the rest: the floor alone
#pragma once
#include "i2b/fit/features.h"
#include "i2b/fit/fit.h"
#include "i2b/fit/off_cause.h"

namespace i2b {

// Nodes nearer to the geometry, in h, are of no interest: none. Half of what a report asks for, since that goes by the
// wall's own sizes, which may be smaller.
inline constexpr double offInterest = 0.005;

// Per wall node; x: m, per node of the band; snaps: per wall node; options: the floors. The same on any number of threads.
std::vector<OffCause> findOffCauses(const Band& band, const SurfaceIndex& index, const FeatureIndex& features,
                                    const std::vector<Snap>& snaps, const Positions& x, const EnergyOptions& options);

} // namespace i2b
