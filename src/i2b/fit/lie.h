// How a piece of the wall lies on the geometry.
#pragma once
#include "i2b/geometry/surface_index.h"
#include <algorithm>
#include <cmath>
#include <span>

namespace i2b {

inline const double tilted = std::cos(25 * 3.14159265358979323846 / 180); // cosine: pieces that lean more are faults

struct Lie {
    double off = 0;    // m, of its middle
    double cosine = 1; // of its normal with the geometry's, 0 where there is none near
};

// x: its corners; h: m, farther off the geometry counts as that.
inline Lie lieOf(const SurfaceIndex& index, std::span<const Vec3> x, double h) {
    Vec3 middle, normal;
    for (const Vec3& p : x) middle += p;
    middle *= 1.0 / static_cast<double>(x.size());
    for (std::size_t i = 0; i < x.size(); ++i) normal += cross(x[i] - middle, x[i + 1 == x.size() ? 0 : i + 1] - middle);
    const ClosestPoint c = index.closest(middle, h);
    if (!c) return {h, 0};
    return {c.distance, std::abs(dot(normalized(normal), index.normal(c.triangle)))};
}

} // namespace i2b
