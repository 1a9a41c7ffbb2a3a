// What of a wall could not be brought onto the geometry: every node with its cause, and the places where such nodes lie
// together, worst first. A node counts by the same measure as in FitReport: farther than 0.01 h (fit_report.h). The nodes of
// faces that are tilted by over 45 degrees but are on the geometry themselves are listed apart.
//
// A place is a set of these nodes connected by edges of the wall. Order: most nodes first, then the greatest distance,
// then the lowest point number.
#pragma once
#include "i2b/fit/off_cause.h"
#include "i2b/geometry/surface_index.h"
#include "i2b/quality/fit_report.h"
#include <array>
#include <string>
#include <vector>

namespace i2b {

struct OffPlace {
    std::int64_t nodes = 0;
    Vec3 centre;                       // m, mean of the nodes
    Box box;                           // m, of them
    double farthestInH = 0;            // greatest distance to the geometry
    Vec3 farthest;                     // m, the node at that distance
    OffCause cause = OffCause::none;   // of most of its nodes (the lowest number among equals)
    std::string part;                  // of the geometry, nearest to `farthest`
};

// Places of one kind: how many there are, and the first of them in order.
struct OffPlaces {
    std::int64_t total = 0;
    std::vector<OffPlace> first;
};

struct OffGeometry {
    std::int64_t nodes = 0, tilted = 0;           // off the geometry; on it, at a tilted face
    double fraction = 0;                          // of the wall nodes: off
    std::array<std::int64_t, offCauses> counts{}; // wall nodes by cause
    OffPlaces places, tiltedPlaces;               // of the two kinds
};

// The causes of wall nodes (in the order of nodes.points) after repair. fit: what the fit found of each, retreated: 1 where
// repair pulled it back (empty: nowhere). A node that the fit had on the geometry is off by the retreat.
std::vector<OffCause> settleCauses(const WallNodes& nodes, const std::vector<OffCause>& fit, const std::vector<std::uint8_t>& retreated);

// causes: as settleCauses() gives. At most `most` places of each kind are kept. The same on any number of threads.
OffGeometry listOffPlaces(const PolyMesh& mesh, const WallNodes& nodes, const std::vector<OffCause>& causes, const SurfaceIndex& index,
                          std::size_t most = 100);

} // namespace i2b
