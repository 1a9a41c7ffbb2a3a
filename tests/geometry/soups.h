// Soups whose feature graphs can be worked out by hand.
#pragma once
#include "i2b/geometry/features.h"
#include <algorithm>
#include <gtest/gtest.h>

namespace i2b::test {

// Every triangle with its own three points, as STL has them.
inline void addTriangle(Surface& s, const Vec3& a, const Vec3& b, const Vec3& c, std::int32_t part = 0) {
    const auto n = static_cast<std::uint32_t>(s.points.size());
    s.points.insert(s.points.end(), {a, b, c});
    s.triangles.push_back({n, n + 1, n + 2});
    s.partOf.push_back(part);
}

inline void addQuad(Surface& s, const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, std::int32_t part = 0) {
    addTriangle(s, a, b, c, part);
    addTriangle(s, a, c, d, part);
}

inline void addCube(Surface& s, const Vec3& at, std::int32_t part = 0) {
    const auto p = [&](int i) { return at + Vec3{double(i & 1), double(i >> 1 & 1), double(i >> 2 & 1)}; };
    const int faces[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                             {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    for (const auto& f : faces) addQuad(s, p(f[0]), p(f[1]), p(f[2]), p(f[3]), part);
}

inline std::size_t count(const FeatureGraph& g, EdgeKind kind) {
    return static_cast<std::size_t>(std::count_if(
        g.edges.begin(), g.edges.end(), [&](const FeatureEdge& e) { return (e.kinds & bitOf(kind)) != 0; }));
}

inline double length(const FeatureGraph& g, EdgeKind kind) {
    double sum = 0;
    for (const FeatureEdge& e : g.edges)
        if (e.kinds & bitOf(kind)) sum += norm(g.points[e.b] - g.points[e.a]);
    return sum;
}

} // namespace i2b::test
