// Values of some points of a mesh, for the writers of pictures.
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <variant>

namespace i2b {

// One value for some points, 0 for all others: for what is known of the wall alone. The arrays must outlive the writing.
struct PointData {
    std::string name;
    std::span<const std::int32_t> points; // of the mesh, ascending
    std::variant<std::span<const float>, std::span<const std::uint8_t>> values; // one each
};

} // namespace i2b
