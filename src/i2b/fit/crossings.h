// Where wall edges still cross a line that the wall has no edge along: a sharp edge of the geometry, the line in which two
// parts meet, the foot of a step beside another line.
#pragma once
#include "i2b/fit/between.h"
#include "i2b/front/front.h"
#include <set>

namespace i2b {

struct WallMarks {
    // Per wall node of the band:
    std::vector<Foot> feet;             // what it sees
    std::vector<std::uint8_t> onLine;   // stands on a line that it is held to, or on a border between parts
    std::vector<Vec3> tangents;         // unit, of the line that it is held to; zero: none, or a corner
    std::set<std::uint32_t> takenCorners; // of the feature index: a node stands there, or may come as it wishes
};

// wishes: of nodes that snaps do not hold, what they are to be held to later.
WallMarks markWall(WallViews& views, const FeatureIndex& features, const Positions& x,
                   const std::vector<Snap>& snaps, const std::vector<Snap>& wishes);

struct EdgeCrossing {
    std::int32_t edge = -1, p = -1, q = -1; // of the front; its vertices
    double t = 0;                           // share of the way from p to q
    Vec3 front, wall;                       // m, the place on the edge of the front, and on the line
    SnapKind kind = SnapKind::none;         // of the line; none: a bend
    Vec3 tangent;                           // unit, of the line or border
    bool beside = false;                    // an end of the edge stands on another line
    bool onRim = false;                     // of a sheet
    bool bend = false;                      // away from lines
    std::int64_t corner = -1;               // of the feature index: no crossing, but the place on the wall is this corner beyond the edge
    bool alive = false;                     // false: there is none
};

// Those of the front's edges, in order, and corners beyond an edge, which are not alive: one may have several. x: positions of the
// band's nodes.
std::vector<EdgeCrossing> findCrossings(const Front& front, const Band& band, const SurfaceIndex& index, const FeatureIndex& features,
                                        const Positions& x, const WallMarks& marks);

// After nodes of the front have moved. Those that geometry now parts from their place on the line are no longer alive.
void followFront(const Band& band, const SurfaceIndex& index, const Positions& x, std::vector<EdgeCrossing>& crossings);

// Puts a crossing's place on the front at this share of its edge.
void placeOnFront(const Band& band, const Positions& x, EdgeCrossing& crossing, double t);

// The share at which the edge of the front comes nearest to the place on the wall, off its ends.
double shareUnder(const Band& band, const Positions& x, const EdgeCrossing& crossing);

// Slides a crossing's place on the wall along its line, m. False: there is no line there.
bool slideAlong(const SurfaceIndex& index, const FeatureIndex& features, EdgeCrossing& crossing, double way);

// Whether no geometry lies between the two places.
bool isFree(const SurfaceIndex& index, const EdgeCrossing& crossing);

} // namespace i2b
