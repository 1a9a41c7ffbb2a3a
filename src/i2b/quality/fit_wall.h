// The wall of a mesh as the measures of the fit see it: its faces, nodes and edges, and their sizes.
#pragma once
#include "i2b/geometry/features.h"
#include "i2b/geometry/surface_index.h"
#include "i2b/quality/fit_report.h"
#include "i2b/quality/mesh_geometry.h"
#include <functional>
#include <string>
#include <vector>

namespace i2b {

inline constexpr double sharpAngle = 40, creaseAngle = 25; // degrees; of the geometry, of the mesh

struct WallEdge {
    std::int32_t a, b, face; // a < b: points of the mesh; face: place in Wall::faces
    friend auto operator<=>(const WallEdge&, const WallEdge&) = default;
};

struct Wall {
    std::vector<std::int32_t> faces;  // of the mesh, ascending
    std::vector<std::int32_t> nodes;  // of the mesh, ascending
    std::vector<WallEdge> edges;      // one for each side of a face, sorted
    std::vector<FaceShape> shapes;    // per face
    std::vector<double> nodeH, faceH; // m
};

// Of the patches named, or of all patches of type wall; with shapes and sizes. cellFaces: buildCellFaces().
// isWanted: asked of each face, on any thread; without it all are.
Wall collectWall(const PolyMesh& mesh, const Rows& cellFaces, const std::vector<std::string>& patches, const std::function<bool(std::int32_t)>& isWanted = {});

// Where a point of the mesh is in wall.nodes.
std::size_t nodePlace(const Wall& wall, std::int32_t point);

double degreesBetween(const Vec3& a, const Vec3& b);

// The sharp edges of the geometry, and the rims of its sheets, as triangles without area. h: m, the size of most of the wall.
Surface sharpSurface(const FeatureGraph& features, double h, const SurfaceIndex& index);
double sizeOfMost(const Wall& wall); // m

// Fills the report's share of captured samples (fit_report.h). index: of the geometry; sharp: of sharpEdges, which is not empty.
void measureCapture(const PolyMesh& mesh, const Wall& wall, const SurfaceIndex& index, const Surface& sharpEdges, const SurfaceIndex& sharp, FitReport& report);

// The same of faint edges.
void measureFaintCapture(const PolyMesh& mesh, const Wall& wall, const SurfaceIndex& index, const FeatureGraph& features, FitReport& report);

} // namespace i2b
