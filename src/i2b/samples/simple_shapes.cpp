// Box, sphere and tunnel.
#include "i2b/samples/parts.h"
#include <map>

namespace i2b::samples {
namespace {

// Each triangle into four, new points pushed out to the unit sphere.
Mesh refinedSphere(const Mesh& coarse) {
    Mesh fine{coarse.points, {}};
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
        const auto [it, fresh] = middles.try_emplace(std::minmax(a, b), std::uint32_t(fine.points.size()));
        if (fresh) fine.points.push_back(normalized(fine.points[a] + fine.points[b]));
        return it->second;
    };
    for (const auto& [a, b, c] : coarse.triangles) {
        const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
        for (const Triangle& t : {Triangle{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}})
            fine.triangles.push_back(t);
    }
    return fine;
}

// The tunnel's section at s in [0, 1]: square to round, shrinking, its middle on an S.
Ring tunnelSection(double s, const Loop2& square, const Loop2& round) {
    const double blend = s * s * (3 - 2 * s);
    const double half = 0.15 + (0.10 - 0.15) * blend;
    Ring ring;
    for (std::size_t i = 0; i < square.size(); ++i) {
        const Vec2 p = square[i] * (1 - blend) + round[i] * blend;
        // Outlines are counterclockwise about +x in (y, z).
        ring.push_back({2 * s, half * p.x, half * p.y + 0.3 * blend});
    }
    return ring;
}

Mesh flat(const Ring& ring, bool facingBack) { return loft({ring}, {facingBack, !facingBack}); }

} // namespace

Parts boxParts(const Make&) { return {{"box", box({0, 0, 0}, {1, 1, 1})}}; }

Parts sphereParts(const Make& make) {
    const double g = (1 + std::sqrt(5.0)) / 2;
    Mesh mesh;
    for (const Vec3& p : {Vec3{-1, g, 0},
                          {1, g, 0},
                          {-1, -g, 0},
                          {1, -g, 0},
                          {0, -1, g},
                          {0, 1, g},
                          {0, -1, -g},
                          {0, 1, -g},
                          {g, 0, -1},
                          {g, 0, 1},
                          {-g, 0, -1},
                          {-g, 0, 1}})
        mesh.points.push_back(normalized(p));
    mesh.triangles = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                      {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                      {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
    for (int k = 0; k < 3 + make.resolution; ++k) mesh = refinedSphere(mesh);
    for (Vec3& p : mesh.points) p *= 0.5;
    return {{"sphere", mesh}};
}

Parts tunnelParts(const Make& make) {
    const auto outlines = [&](int perSide) {
        std::pair<Loop2, Loop2> both;
        both.first = subdivided({{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}, 2.0 / perSide);
        const int n = 4 * perSide;
        for (int i = 0; i < n; ++i) both.second.push_back(unitCircle(2 * i + 5 * n / 4, 2 * n));
        return both;
    };
    const auto [square, round] = outlines(make.n(12));
    std::vector<Ring> rings;
    const int count = make.n(40);
    for (int k = 0; k <= count; ++k) rings.push_back(tunnelSection(double(k) / count, square, round));
    // A dirty end is cut differently and stands 0.5 mm off.
    const auto [otherSquare, otherRound] = make.dirty() ? outlines(make.n(16)) : outlines(make.n(12));
    const Vec3 off{make.dirty() ? 0.5e-3 * make.dirt : 0, 0, 0};
    return {{"wall", loft(rings, {false, false})},
            {"inlet", moved(flat(tunnelSection(0, otherSquare, otherRound), true), -off)},
            {"outlet", moved(flat(tunnelSection(1, otherSquare, otherRound), false), off)}};
}

} // namespace i2b::samples
