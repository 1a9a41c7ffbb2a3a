// The geometry as the mesher sees it: a triangle soup. It has no inside or outside, its normals mean nothing, it
// need not be closed, and triangles may cross, repeat or degenerate (Wang and Srinivasan 2002, section 2).
#pragma once
#include "i2b/core/vec.h"
#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace i2b {

struct Part {
    std::string name;          // unique, usable as an OpenFOAM patch name
    std::string file;          // where it came from, for messages
    std::uint64_t triangles = 0;
};

// Free entities: curves and points that act on size and features but bound nothing.
struct FreeSegment {
    std::uint32_t a = 0, b = 0; // into Surface::points
    std::int32_t part = 0;
};

struct Surface {
    std::vector<Vec3> points;                            // metres
    std::vector<std::array<std::uint32_t, 3>> triangles; // into points; degenerate ones are kept where they have extent
    std::vector<std::int32_t> partOf;                    // per triangle, into parts
    std::vector<Part> parts;
    std::vector<FreeSegment> segments;                   // OBJ lines and the like
    std::vector<std::uint32_t> freePoints;               // into points

    Box bounds() const;               // of all triangles; empty if there are none
    Box bounds(std::int32_t part) const;
    std::string validate() const;     // "" or the first fault found: index out of range, not finite, part out of range
    std::uint64_t checksum() const;
};

} // namespace i2b
