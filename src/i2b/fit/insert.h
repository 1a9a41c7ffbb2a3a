// Vertices for the front where the fit has none: a wall edge that still crosses a sharp edge of the geometry, or a
// border between parts, is divided at the crossing, front and wall alike, and the faces beside it are cut from crossing
// to crossing, so that each prism stands on one side of the line. So is an edge that bridges a bend, where it is farthest off, and one beside a
// face that closes a hollow before its tip, with a vertex at that. Nothing else moves but front nodes that make room.
#pragma once
#include "i2b/fit/features.h"
#include "i2b/front/front.h"

namespace i2b {

// x: the fitted positions of the band's nodes, as stored in front, where front nodes make room. The band does not know the
// new vertices; snaps, of the band's wall nodes, gets one for each of them: the line that it is on. wishes: what further nodes are to be held
// to later. Gives how many were inserted.
std::size_t insertVertices(Front& front, WallViews& views, const FeatureIndex& features, Positions& x,
                           std::vector<Snap>& snaps, const std::vector<Snap>& wishes);

} // namespace i2b
