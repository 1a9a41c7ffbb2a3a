// How well the wall of a mesh follows the geometry.
//
// h, the local wall cell size, is that of the cells from which the wall was made, whatever became of its own faces: of a
// wall face the size of the first cell inwards that begins 1.25 edges behind it, which is none of its layers and hardly
// bent to the wall, and that size the upper quartile of the cell's edges, so that squeezed ones, as in gaps, do not count.
// Of a wall node the median of the wall faces around it; of a wall face that of its nodes. (Of two in the middle the smaller.)
// Nothing of a lattice is used, so the same measure judges any mesh; of our own it is the size of the lattice's cells to
// within some 2 %. The wall's own edges are no measure: on a slope they are up to 0.6 times as long, and shorter where
// faces are divided.
//
// On the geometry: within 0.01 h of it.
//
// Sharp edges are the geometry's edges of 40 degrees and more and the rims of its sheets, which fold by 180: free edges beyond which nothing
// follows within 2 h (rims.h).
//
// Captured: samples are taken every h/4 along the geometry's sharp edges, where the wall
// comes within h/2 and where the edge is resolvable: every such edge stays within 0.1 h of the sample's own
// straight line as far as h from the sample; and where geometry does not hide it: an edge inside another part, more than
// 0.05 h behind what is seen from 0.3 h and from h over the nearest wall, is none that a wall could have, and nor is one at which the
// geometry, seen from there, goes straight on: where parts lie flush, or one ends at the far side of another, what is seen 0.1 h to both
// sides folds by no more than a wall edge must. The share that has a wall edge within 0.1 h where two faces of the wall fold by more than 25
// degrees, or one and that of another patch at which the wall ends.
//
// Faint edges: the lines that the geometry's user named, and edges over a feature angle of his below 40 degrees: a wall need not fold there.
// The same samples within 0.05 h of the geometry, where any line of either kind that is near counts against "resolvable"; captured where an edge of the wall that runs
// along the line, within 30 degrees, is within 0.1 h.
//
// Borders: the same along the lines where two parts meet (border_lines.h), of samples that are seen from the flow 0.3 h
// over the nearest wall, one of the parts at either side 0.1 h from the line and none at both; the share that has an edge
// between the patches of these two parts, or of others that lie upon them there, within 0.1 h.
//
// Tilted: of the wall faces whose centre is more than h from every sharp edge, the share
// whose normal is over 25 (45) degrees off that of the geometry closest to the centre, orientation ignored.
#pragma once
#include "i2b/assemble/mesh_topology.h"
#include "i2b/geometry/features.h"
#include "i2b/geometry/surface_index.h"
#include "i2b/quality/lost_cause.h"
#include <array>
#include <numeric>
#include <string>
#include <vector>

namespace i2b {

// A stretch of sharp edges that the wall has not captured (lost_edges.h).
struct LostEdge {
    double length = 0;                    // m
    Vec3 at;                              // m, a place on it, in its middle
    Box box;                              // m
    std::string part;                     // of the geometry
    LostCause cause = LostCause::crossed; // of most of it
};

struct LostEdges {
    std::array<double, lostCauses> lengthOf{}; // m, by cause
    std::int64_t total = 0;                    // stretches
    std::vector<LostEdge> first;               // of them, longest first
    double length() const { return std::accumulate(lengthOf.begin(), lengthOf.end(), 0.0); } // m, of all
};

struct FitReport {
    std::int64_t wallNodes = 0, wallFaces = 0;
    double wallNodesOnGeometryFraction = 1;                  // within 0.01 h, h the local wall cell size
    double wallNodesWithin0001h = 1, wallNodesWithin01h = 1; // within 0.001 h and 0.1 h
    double meanDistanceInH = 0, maxDistanceInH = 0;          // of wall face centres; of wall nodes
    double featureCaptureFraction = 1; // of resolvable samples every h/4 along sharp edges
    std::int64_t featureSamples = 0;
    LostEdges lostEdges;               // where the others are
    double faintCaptureFraction = 1;   // of resolvable samples every h/4 along faint edges
    std::int64_t faintSamples = 0;
    double tiltedFaceFraction = 0; // normal over 25 degrees off, more than h from sharp edges
    double tilted45FaceFraction = 0;
    double partBorderFraction = 1;   // of resolvable samples every h/4 along the lines where two parts meet
    std::int64_t borderSamples = 0;  // 0: not asked for, the patches are not named after parts, or nothing borders on anything
    Vec3 farthest; // m, the wall node of maxDistanceInH
};

inline constexpr double onGeometry = 0.01; // of h: a node within is on the geometry

// What was measured of each wall node.
struct WallNodes {
    std::vector<std::int32_t> points;  // of the mesh, ascending
    std::vector<double> distanceInH;   // to the geometry
    std::vector<std::uint8_t> tilted;  // 1: a wall face at it is tilted by over 45 degrees
};

// Of the mesh's wall patches: those named, or all patches of type wall. features must have been built with an
// angle of at most 40 degrees for the last figures to mean what is said above, and rims count where it has any marked: they
// are told from cracks anew, by the wall's own size. Faint edges are those of features that fold less. All is the same on any number of threads. nodes: filled where given and there is something to measure. cellFaces: buildCellFaces().
FitReport measureFit(const PolyMesh& mesh, const Rows& cellFaces, const SurfaceIndex& index, const FeatureGraph& features,
                     const std::vector<std::string>& patches = {}, WallNodes* nodes = nullptr);

// The borders, which measureFit() leaves out: they take longer than all the rest. Patches are told by the names of the
// geometry's parts.
void measurePartBorders(const PolyMesh& mesh, const Rows& cellFaces, const SurfaceIndex& index, const std::vector<std::string>& patches, FitReport& report);

} // namespace i2b
