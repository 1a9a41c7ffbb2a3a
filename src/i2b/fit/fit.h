// Fitting the front to the wall: wall positions go to their closest points on the geometry, as seen from the fluid,
// front and core points make room, and no accepted state inverts a cell corner.
//
// Method: Wang and Srinivasan (2002), section 4, smoothing and closest-point projection; where that would leave bad
// cells, a blend back towards the valid start and a barrier energy of Knupp's condition-number kind, minimised node
// by node. Steps: goals.cpp, blend.cpp, energy.cpp, snap.cpp.
#pragma once
#include "i2b/core/context.h"
#include "i2b/fit/band.h"
#include "i2b/fit/budget.h"
#include "i2b/fit/features.h"
#include "i2b/fit/off_cause.h"
#include "i2b/geometry/features.h"
#include "i2b/geometry/surface_index.h"
#include "i2b/options.h"

namespace i2b {

class WallViews;

// Height of the prisms at the start, in h: they are right by construction. Flatter ones have little of the energy to spare that a
// corner may have in the blend, so that few nodes go the whole way; of much higher ones the wall folds where the front is hollow.
inline constexpr double startThickness = 0.12;

struct FitSummary {
    std::size_t wallNodes = 0;
    std::size_t blended = 0;      // wall nodes that reached their goal directly
    std::size_t active = 0;       // nodes that the energy worked on
    std::size_t snapped = 0;      // wall nodes held to a feature
    std::size_t split = 0;        // front faces split along one
    std::vector<Snap> snaps;      // per wall node, inserted ones last: what it is held to
    std::vector<Snap> wishes;     // per wall node: what it should be held to besides, but could not be brought to
    std::size_t inserted = 0;     // vertices put where an edge crosses one
    bool cutShort = false;        // by options.seconds: sweeps were left out, and another run may end elsewhere
    std::vector<OffCause> offCauses; // per wall node: why it is off the geometry; none where it is within offInterest (off_wall.h)
};

// Moves the front's vertices (front and wall positions, movedPoints). Every corner stays positive. Once options.seconds
// are over no further sweep of the energy begins and no further features are looked for; the exact snap is always done.
FitSummary fitFront(Front& front, const LatticeMesh& mesh, const SurfaceIndex& index, const FeatureGraph& features,
                    const FitOptions& options, const Context& context, const RoomOfWalls& room = {});

// --- steps, for tests and benchmarks -------------------------------------------------------------------------------

// Where a wall node at b with its front node at f should go, as seen from the fluid side.
struct WallTarget {
    Vec3 point;
    Vec3 normal;        // unit: direction of the distance, or of the triangle where b is on it
    bool found = false;
};
// h, reach: m, smallest and largest edge of the cells around; outside: as in Front.
WallTarget targetSeen(const SurfaceIndex& index, const Vec3& f, const Vec3& b, double h, double reach, std::uint8_t outside);
// The same of a node of the band.
WallTarget wallTarget(const SurfaceIndex& index, const Band& band, std::size_t wallNode, const Vec3& f, const Vec3& b);

// Front nodes in narrow passages start behind a wall. Marks them in the band and gives valid positions with all of
// them on the flow's side, as far as the corners allow; the band's own where none is behind.
Positions startPositions(Band& band, const SurfaceIndex& index);

// Where the front node of a wall node stands, or the last place on the flow's side on the way to it.
Vec3 seenFront(const SurfaceIndex& index, const Band& band, std::size_t wallNode, const Vec3& f);

// Direct positions: smoothed front, projected wall, relaxed core (Jacobi; positions per node).
Positions goalPositions(const Band& band, const SurfaceIndex& index, const Positions& start, int sweeps);

// Of core and front points from `first` on those that hang on coarse edges or faces go to the middle of these.
void settleHanging(const Band& band, std::size_t first, Positions& x);

struct BlendOptions {
    std::vector<std::uint8_t> stays; // per wall node (or empty), not 0: alpha is 0
    double slope = 0.34;             // largest difference of alpha between neighbours: keeps the rim of a patch valid
    bool maybePoor = false;          // corners that are bad at the start may stay so
};
// x = start + alpha (goal - start) with the largest alpha per node, bounded in slope, that leaves every corner good.
// Gives alpha per movable node; x is filled.
RawVector<double> blend(const Band& band, const Positions& start, const Positions& goal, Positions& x,
                          const BlendOptions& options = {});

// Corner quality: phi = 0.75 |J|^2 / (3 D^(2/3)) + 0.125 (D + 1/D), infinite where D <= 0; 1 for the ideal corner.
double cornerEnergy(const Corner& corner, const Positions& x);
double scaledJacobian(const Corner& corner, const Positions& x);
// Is phi above the limit, and was it not before, or was the corner better then by far?
bool isBad(const Corner& corner, const Positions& x, const Positions& before, double limit);
// The least of a node's corners, at most 1.
double worstCorner(const Band& band, std::size_t node, const Positions& x);
// Marks, per movable node, those of corners with a phi above the limit.
std::vector<std::uint8_t> nodesOfPoorCorners(const Band& band, const Positions& x, double limit);

struct EnergyOptions {
    std::vector<double> wallWeights{0.1, 10, 100, 1e3, 1e5, 1e6};
    int newtonSteps = 2;
    double floor = 0.03;          // scaled Jacobian below which the wall pulls less
    double featureFloor = 0.01;   // the same for nodes snapped to features
    double cap = 0.3;             // of h: longest step
    Budget budget;                // of time: asked before each sweep
};
// Gauss-Seidel over a colouring of the active nodes. active: per movable node. Gives whether all sweeps were within the budget.
bool minimiseEnergy(WallViews& views, const FeatureIndex& features, const std::vector<Snap>& snaps,
                    const std::vector<std::uint8_t>& active, Positions& x, const EnergyOptions& options, const Context& context);

// Moves wall nodes the whole, half or a quarter of the way to their targets where the corners stay good.
void snapExactly(WallViews& views, const FeatureIndex& features, const std::vector<Snap>& snaps,
                 Positions& x, const EnergyOptions& options);

} // namespace i2b
