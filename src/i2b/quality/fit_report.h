// How well the wall of a mesh follows the geometry (definitions: DESIGN.md section 5).
#pragma once
#include "i2b/assemble/poly_mesh.h"
#include "i2b/geometry/features.h"
#include "i2b/geometry/surface_index.h"
#include <string>
#include <vector>

namespace i2b {

struct FitReport {
    std::int64_t wallNodes = 0, wallFaces = 0;
    double wallNodesOnGeometryFraction = 1;      // within 0.01 h, h the local wall cell size
    double wallNodesWithin0001h = 1, wallNodesWithin01h = 1; // within 0.001 h and 0.1 h
    double meanDistanceInH = 0, maxDistanceInH = 0;          // of wall face centres; of wall nodes
    double featureCaptureFraction = 1;           // of resolvable samples every h/4 along sharp edges
    std::int64_t featureSamples = 0;
    double tiltedFaceFraction = 0;               // normal over 25 degrees off, more than h from sharp edges
    double tilted45FaceFraction = 0;
    Vec3 farthest;                               // m, the wall node farthest from the geometry
};

// Of the mesh's wall patches: those named, or all patches of type wall.
FitReport measureFit(const PolyMesh& mesh, const SurfaceIndex& index, const FeatureGraph& features,
                     const std::vector<std::string>& patches = {});

} // namespace i2b
