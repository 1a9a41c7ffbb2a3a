// Wall nodes that crossings of edges leave out: a neighbour is held to a feature, the faces around the node itself stand
// on either side of it, and yet the node is off it. Its neighbours across the feature being snapped already, no edge tells.
#pragma once
#include "i2b/fit/features.h"

namespace i2b {

// Snaps such nodes, nearest first, where no node beside them is bound for the same place; those already in snaps stay.
// Gives how many were added.
std::size_t snapFolds(const Band& band, const Front& front, const SurfaceIndex& index, const FeatureIndex& features,
                      const Positions& x, std::vector<Snap>& snaps);

} // namespace i2b
