// Feature lines and corners that the user gives in files of their own.
#pragma once
#include "i2b/core/vec.h"
#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace i2b {

struct FeatureLines {
    std::vector<Vec3> points;                           // m
    std::vector<std::array<std::uint32_t, 2>> segments; // into points
    std::vector<std::uint32_t> corners;                 // into points
};

// files: Wavefront OBJ, plain or gzipped; their `l` elements are lines, their `p` elements corners, faces are left out
// with a note. scale: file unit to metres, that of the geometry. Throws Error (input) naming file and, where one is at
// fault, line: missing, unreadable, no OBJ, without lines and points.
FeatureLines readFeatureLines(const std::vector<std::string>& files, double scale, std::vector<std::string>& notes);

} // namespace i2b
