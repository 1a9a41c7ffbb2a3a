// Features of the geometry on the wall mesh: nodes are snapped to sharp edges and corners, and faces whose diagonal
// lies on an edge are split along it, front and wall alike, so that every prism stands on one side.
//
// A wall edge whose two ends lie on surfaces that differ by more than 25 degrees crosses a feature. Where the soup has a
// sharp edge there, that is it; where it has none (parts that intersect without a common edge), it is the line in
// which the tangent planes of the two ends meet, if the geometry confirms it. Where parts lie flush, the line on which
// the nearest part changes is one too, so that patches end along mesh edges. Faint lines (feature_index.h) are crossed where the edge leads
// over them; so, after all others, are creases.
#pragma once
#include "i2b/fit/band.h"
#include "i2b/fit/feature_index.h"

namespace i2b {

class WallViews;

enum class SnapKind : std::uint8_t { none, line, implicitLine, corner };

struct Snap { // what a wall node is held to
    SnapKind kind = SnapKind::none;
    Vec3 point;   // m
    Vec3 tangent; // unit, of the line
};

inline constexpr double mostBentAway = 0.3; // of h: so far the geometry may bend away from an implicit line along its tangent

// Where on its feature a snapped node at x should be, and the feature's direction there. h: m, the size of the cells around.
FeatureIndex::Line snapLine(const SurfaceIndex& index, const FeatureIndex& features, const Snap& snap, const Vec3& x, double h);

// The line that a wall node stands all but on, though nothing holds it there: cuts may end at it, and it is brought there if that
// can be. None beside a second one, and none where a sheet ends: its rim is dealt with later (quality/zip_rims.h).
FeatureIndex::Line lineUpon(const FeatureIndex& features, const Vec3& x, double h);

// Snaps further nodes, nearest crossings first, one end of an edge at most; those already in snaps stay.
// Gives how many were added.
std::size_t snapToFeatures(WallViews& views, const Front& front, const FeatureIndex& features,
                           const Positions& x, std::vector<Snap>& snaps);

// Splits quads of the front whose diagonal is snapped and whose other two nodes lie on different sides. Front
// numbering stays but for faces, which are renumbered in order of their owner cells. Gives how many were split.
std::size_t splitAlongFeatures(Front& front, const Band& band, const SurfaceIndex& index, const FeatureIndex& features,
                               const Positions& x, const std::vector<Snap>& snaps);

} // namespace i2b
