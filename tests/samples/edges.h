// Edges of a soup after welding equal points, counted by how many triangles share them.
#pragma once
#include "i2b/geometry/surface.h"
#include <map>
#include <tuple>

namespace i2b::test {

struct EdgeCount {
    std::size_t open = 0, manifold = 0, crowded = 0; // one, two, more triangles
    std::size_t three = 0;                           // exactly three
    std::size_t flipped = 0;                         // of the manifold ones: both triangles run the same way
};

// Of one part, or of all (-1). Points closer than 1e-9 m in every coordinate's rounding are one.
inline EdgeCount countEdges(const Surface& s, std::int32_t part = -1) {
    using Key = std::tuple<long long, long long, long long>;
    std::map<Key, int> ids;
    const auto id = [&](std::uint32_t i) {
        const Vec3 p = s.points[i] * 1e9;
        return ids.try_emplace(Key{std::llround(p.x), std::llround(p.y), std::llround(p.z)}, int(ids.size()))
            .first->second;
    };
    std::map<std::pair<int, int>, std::pair<int, int>> edges; // count, net direction
    for (std::size_t t = 0; t < s.triangles.size(); ++t) {
        if (part >= 0 && s.partOf[t] != part) continue;
        for (std::size_t k = 0; k < 3; ++k) {
            const int a = id(s.triangles[t][k]), b = id(s.triangles[t][(k + 1) % 3]);
            if (a == b) continue;
            auto& [count, net] = edges[std::minmax(a, b)];
            ++count, net += a < b ? 1 : -1;
        }
    }
    EdgeCount out;
    for (const auto& [ends, e] : edges) {
        out.open += e.first == 1;
        out.manifold += e.first == 2;
        out.crowded += e.first > 2;
        out.three += e.first == 3;
        out.flipped += e.first == 2 && e.second != 0;
    }
    return out;
}

} // namespace i2b::test
