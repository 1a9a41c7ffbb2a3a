// A face as triangles.
#pragma once
#include "i2b/core/vec.h"
#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace i2b {

// Of a face that is divided: no fan, but the triangles of which the thinnest is as wide as can be. A fan has triangles of no area
// where vertices lie in one line.
inline constexpr std::uint32_t widest = ~0u;

using FaceTriangle = std::array<std::uint32_t, 3>; // places among the face's vertices, in the face's sense

// Two fewer than the face has vertices: a fan from one of the vertices, or the widest, by dynamic programming over
// chains of vertices (Klincsek 1980). Width: the area, as seen along the face's normal, over the square of the longest side.
// points: of the whole mesh, m.
std::vector<FaceTriangle> trianglesOf(std::span<const Vec3> points, std::span<const std::int32_t> face, std::uint32_t from);

} // namespace i2b
