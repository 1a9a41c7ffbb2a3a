// The lines in which parts of a geometry meet, whatever their triangles do there: where triangles of two parts cut each
// other, and where an edge of one part lies upon another part that its triangle rises from (a foot on a plate, two panels
// side by side). Parts that only come near to each other have no border.
#pragma once
#include "i2b/geometry/surface_index.h"
#include <array>
#include <cstdint>
#include <vector>

namespace i2b {

struct BorderLines {
    Surface lines;                                  // segments as triangles without area
    std::vector<std::array<std::int32_t, 2>> parts; // per line: the lower number first
};

// Among the triangles that are marked. tolerance: m, what lies so near upon another part touches it. In order of the
// triangles; a border along which both parts have an edge comes twice.
BorderLines borderLines(const SurfaceIndex& index, const std::vector<std::uint8_t>& marked, double tolerance);

} // namespace i2b
