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
// n: of its points; a constant of the compiler's makes it faster.
template <class Count>
FaceShape shapeOfPolygon(const Vec3* point, Count n) {
    constexpr double tinyArea = 1e-150; // below it a polygon has no area
    if (n == 3)
        return {(1.0 / 3.0) * (point[0] + point[1] + point[2]),
                0.5 * cross(point[1] - point[0], point[2] - point[0])};
    Vec3 mean = point[0];
    for (std::size_t i = 1; i < n; ++i) mean += point[i];
    mean = divided(mean, static_cast<double>(n));
    Vec3 normal, weighted;
    double area = 0;
    for (std::size_t i = 0; i < n; ++i) {
        const Vec3& here = point[i];
        const Vec3& next = point[i + 1 == n ? 0 : i + 1];
        const Vec3 twice = cross(next - here, mean - here);
        const double size = norm(twice);
        normal += twice;
        area += size;
        weighted += size * (here + next + mean);
    }
    if (area < tinyArea) return {mean, {}};
    return {divided((1.0 / 3.0) * weighted, area), 0.5 * normal};
}

FaceShape measureFace(const PolyMesh& mesh, std::int32_t face);

// A cell as pyramids on its faces with their apex at the mean of the face centres. Needs faceCentre and
// faceArea.
void measureCell(const PolyMesh& mesh, std::span<const std::int32_t> faces, std::int32_t cell,
                 MeshGeometry& geometry);

MeshGeometry measureGeometry(const PolyMesh& mesh, const Rows& cellFaces);

} // namespace i2b
