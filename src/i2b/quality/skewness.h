// Skewness of one face, as checkMesh measures it.
#pragma once
#include "i2b/quality/mesh_geometry.h"
#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

namespace i2b {

inline constexpr double tinyDivisor = 1e-150;

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

} // namespace i2b
