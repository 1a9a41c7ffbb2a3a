// Small soups whose curvature and gaps are known.
#pragma once
#include "i2b/geometry/surface.h"
#include <numbers>
#include <random>

namespace i2b::test {

inline void addTriangle(Surface& s, const Vec3& a, const Vec3& b, const Vec3& c, std::int32_t part = 0) {
    if (!(norm(cross(b - a, c - a)) > 1e-12)) return; // at the poles of a sphere
    const auto n = static_cast<std::uint32_t>(s.points.size());
    s.points.insert(s.points.end(), {a, b, c});
    s.triangles.push_back({n, n + 1, n + 2});
    s.partOf.push_back(part);
    while (static_cast<int>(s.parts.size()) <= part) s.parts.push_back({"part" + std::to_string(s.parts.size()), "", 0});
}
inline void addQuad(Surface& s, const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, std::int32_t part = 0) {
    addTriangle(s, a, b, c, part);
    addTriangle(s, a, c, d, part);
}

// Along z, without ends.
inline Surface cylinder(double radius, int segments, double length, int rows = 1) {
    Surface s;
    const auto at = [&](int i, int j) {
        const double t = 2 * std::numbers::pi * (i % segments) / segments;
        return Vec3{radius * std::cos(t), radius * std::sin(t), length * j / rows};
    };
    for (int i = 0; i < segments; ++i) {
        for (int j = 0; j < rows; ++j) addQuad(s, at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
    }
    return s;
}

// By longitude and latitude.
inline Surface sphere(double radius, int segments) {
    Surface s;
    const auto at = [&](int i, int j) {
        const double u = 2 * std::numbers::pi * (i % segments) / segments, v = std::numbers::pi * j / (segments / 2);
        return Vec3{radius * std::sin(v) * std::cos(u), radius * std::sin(v) * std::sin(u), radius * std::cos(v)};
    };
    for (int i = 0; i < segments; ++i) {
        for (int j = 0; j < segments / 2; ++j) addQuad(s, at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
    }
    return s;
}

inline Surface reversedAtRandom(Surface s, unsigned seed) {
    std::mt19937 random(seed);
    for (auto& t : s.triangles) {
        if (random() & 1) std::swap(t[1], t[2]);
    }
    return s;
}

} // namespace i2b::test
