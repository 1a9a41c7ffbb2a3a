// Measures of single faces and cells, as checkMesh defines them.
#pragma once
#include "i2b/quality/mesh_geometry.h"
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

namespace i2b {

inline constexpr double tinyDivisor = 1e-150;
inline constexpr double planarCosine = 1e-6; // face centres nearer a face's plane than this make a cell concave

// How far the line between the centres misses the face's centre, over the face's extent that way. The extent
// is at least leastExtent, so that most faces can be seen not to reach least, and need no closer look: of
// them -infinity is returned.
inline double skewness(const PolyMesh& mesh, std::span<const std::int32_t> v, const Vec3& faceCentre,
                const Vec3& area, const Vec3& toFace, const Vec3& across, double leastExtent, double least) {
    const Vec3 miss = toFace - (dot(area, toFace) / (dot(area, across) + tinyDivisor)) * across;
    const double clearlyLess = 0.999 * least * leastExtent;
    if (clearlyLess > 1e-140 && norm2(miss) < clearlyLess * clearlyLess)
        return -std::numeric_limits<double>::infinity();
    const double size = norm(miss);
    const Vec3 direction = divided(miss, size + tinyDivisor);
    double extent = leastExtent;
    for (const std::int32_t p : v)
        extent = std::max(extent, std::abs(dot(direction, mesh.points[static_cast<std::size_t>(p)] - faceCentre)));
    return size / extent;
}

// neighbour: of an internal face, else null. Results below least may be -infinity.
inline double faceSkewness(const PolyMesh& mesh, std::int32_t face, const FaceShape& shape, const Vec3& owner,
                           const Vec3* neighbour, double least) {
    const Vec3 toFace = shape.centre - owner;
    Vec3 across;
    double share = 0.2;
    if (neighbour != nullptr) {
        across = *neighbour - owner;
    } else {
        const double size = norm(shape.area);
        const Vec3 normal = size < tinyDivisor ? Vec3{} : divided(shape.area, size);
        across = normal * dot(normal, toFace);
        share = 0.4;
    }
    return skewness(mesh, mesh.face(face), shape.centre, shape.area, toFace, across,
                    share * norm(across) + tinyDivisor, least);
}

// Of an internal face with the cells at its sides.
struct PairValues {
    double ortho;  // cosine of the non-orthogonality
    double weight; // smaller share of the distance between the centres
    double ratio;  // of the volumes
};
inline PairValues pairValues(const FaceShape& shape, const CellMoments& own, const CellMoments& nei) {
    constexpr double tinyWeight = 1e-300;
    const Vec3 across = nei.centre - own.centre;
    PairValues values;
    values.ortho = dot(across, shape.area) / (norm(across) * norm(shape.area) + tinyDivisor);
    const double ownDistance = std::abs(dot(shape.area, shape.centre - own.centre));
    const double neiDistance = std::abs(dot(shape.area, nei.centre - shape.centre));
    values.weight = std::min(neiDistance, ownDistance) / (neiDistance + ownDistance + tinyWeight);
    values.ratio = std::min(own.volume, nei.volume) / (std::max(own.volume, nei.volume) + tinyWeight);
    return values;
}

// Directions that empty patches leave.
struct Directions {
    std::array<bool, 3> valid{true, true, true};
    int count = 3, missing = -1;
};

// Of the sum of n n^T over the internal faces, each n the area over their mean area; 1 for a cube inside the mesh.
inline double cellDeterminant(const PolyMesh& mesh, std::span<const std::int32_t> faces,
                              std::span<const FaceShape> shapes, const Directions& directions) {
    if (directions.count == 1) return 1;
    const std::int32_t internal = mesh.internalFaces();
    double mean = 0;
    int n = 0;
    for (std::size_t i = 0; i < faces.size(); ++i)
        if (faces[i] < internal) mean += norm(shapes[i].area), ++n;
    if (n == 0 || mean < tinyDivisor) return 0;
    mean /= n;
    double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;
    for (std::size_t i = 0; i < faces.size(); ++i) {
        if (faces[i] >= internal) continue;
        const Vec3 a = divided(shapes[i].area, mean);
        xx += a.x * a.x, xy += a.x * a.y, xz += a.x * a.z;
        yy += a.y * a.y, yz += a.y * a.z, zz += a.z * a.z;
    }
    if (directions.count == 2) (directions.missing == 0 ? xx : directions.missing == 1 ? yy : zz) = 1;
    return std::abs(xx * yy * zz + xy * yz * xz + xz * xy * yz - xx * yz * yz - xy * xy * zz - xz * yy * xz) /
           8.0;
}

// Determinant of the sum of a a^T / |a| over all faces, each a its area, over that of a cube with as much surface: how
// evenly the faces look to all sides. That of OpenFOAM's mesh quality dictionary, unlike the one above.
inline double cellFullness(std::span<const FaceShape> shapes) {
    double sum = 0, xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;
    for (const FaceShape& shape : shapes) {
        const Vec3& a = shape.area;
        const double size = norm(a);
        const Vec3 unit = (1.0 / (size + 1e-300)) * a;
        sum += size;
        xx += a.x * unit.x, xy += a.x * unit.y, xz += a.x * unit.z;
        yy += a.y * unit.y, yz += a.y * unit.z, zz += a.z * unit.z;
    }
    const double det = xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz);
    sum += 1e-300;
    return det / (sum * sum * sum) / 0.037037037037037;
}

} // namespace i2b
