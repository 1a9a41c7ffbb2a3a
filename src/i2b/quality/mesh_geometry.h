// Centres, areas and volumes of a PolyMesh, by the definitions of OpenFOAM v1912, rounding included. Those of faces are
// worked out where they are asked for: held for all faces they would be larger than the mesh.
#pragma once
#include "i2b/assemble/mesh_topology.h"
#include "i2b/core/four.h"

namespace i2b {

// True division: core's multiplies by the inverse, which rounds differently.
constexpr Vec3 divided(const Vec3& a, double s) { return {a.x / s, a.y / s, a.z / s}; }

struct FaceShape {
    Vec3 centre; // m
    Vec3 area;   // m^2, along the normal
};

struct CellMoments {
    Vec3 centre;       // m
    double volume = 0; // m^3
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

// The same of four points at once.
inline FaceShape shapeOfQuad(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    constexpr double tinyArea = 1e-150;
    const Vec3 mean = divided(((a + b) + c) + d, 4.0);
    const VecFour here = fourOf(a, b, c, d), next = picked<1, 2, 3, 0>(here), twice = cross(next - here, mean - here);
    const Four size = sqrt(dot(twice, twice));
    const double area = sum(size);
    if (area < tinyArea) return {mean, {}};
    const Vec3 weighted = sum(size * (here + next + mean));
    return {divided((1.0 / 3.0) * weighted, area), 0.5 * sum(twice)};
}

FaceShape measureFace(const PolyMesh& mesh, std::int32_t face);

// The shapes of a cell's faces side by side. The cells of a mesh follow each other so that most faces of one belong to
// one just before it, too: a few are remembered, and each is worked out little more than once. One per thread.
class CellFaceShapes {
  public:
    explicit CellFaceShapes(const PolyMesh& mesh) : mesh_(mesh), face_(slots, -1), shape_(slots) {}

    // Holds until the next call.
    std::span<const FaceShape> of(std::span<const std::int32_t> faces) {
        if (row_.size() < faces.size()) row_.resize(faces.size());
        for (std::size_t i = 0; i < faces.size(); ++i) {
            const std::int32_t f = faces[i];
            const std::size_t slot = static_cast<std::size_t>(f) % slots;
            if (face_[slot] != f) face_[slot] = f, shape_[slot] = measureFace(mesh_, f);
            row_[i] = shape_[slot];
        }
        return {row_.data(), faces.size()};
    }

  private:
    static constexpr std::size_t slots = 512;
    const PolyMesh& mesh_;
    std::vector<std::int32_t> face_; // in each slot
    std::vector<FaceShape> shape_, row_;
};

// A cell as pyramids on its faces with their apex at the mean of the face centres. shapes: of its faces.
CellMoments measureCell(const PolyMesh& mesh, std::span<const std::int32_t> faces,
                        std::span<const FaceShape> shapes, std::int32_t cell);

// Of all cells.
RawVector<CellMoments> measureCellMoments(const PolyMesh& mesh, const Rows& cellFaces);

} // namespace i2b
