// Centres, areas and volumes of a PolyMesh, by the definitions of OpenFOAM v1912, rounding included.
#pragma once
#include "i2b/quality/mesh_topology.h"

namespace i2b {

// True division: core's multiplies by the inverse, which rounds differently.
constexpr Vec3 divided(const Vec3& a, double s) { return {a.x / s, a.y / s, a.z / s}; }

struct MeshGeometry {
    RawVector<Vec3> faceCentre;   // m
    RawVector<Vec3> faceArea;     // m^2, along the normal
    RawVector<Vec3> cellCentre;   // m
    RawVector<double> cellVolume; // m^3
};

struct FaceShape {
    Vec3 centre, area;
};

// A polygon as the fan of triangles around the mean of its vertices: centre weighted by the triangles' areas.
FaceShape measureFace(const PolyMesh& mesh, std::int32_t face);

// A cell as pyramids on its faces with their apex at the mean of the face centres. Needs faceCentre and
// faceArea.
void measureCell(const PolyMesh& mesh, std::span<const std::int32_t> faces, std::int32_t cell,
                 MeshGeometry& geometry);

MeshGeometry measureGeometry(const PolyMesh& mesh, const Rows& cellFaces);

} // namespace i2b
