// Why a sharp edge of the geometry is not captured: what the wall is like there, for reports.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

namespace i2b {

enum class LostCause : std::uint8_t {
    shallow, // the wall has an edge along it that folds by less than a sharp one must: a step, groove or rib lower than the cells
    crossed, // the wall's faces run across it
    bridged, // it lies over 0.1 h behind the wall, which spans a groove or gap there
    leftOut  // it lies over 0.1 h before the wall, in the cells: a rib or step lower or thinner than they are
};
inline constexpr std::size_t lostCauses = 4;

// As in report.json.
inline const char* nameOf(LostCause cause) {
    constexpr std::array<const char*, lostCauses> names{"shallow", "crossed", "bridged", "left_out"};
    return names[static_cast<std::size_t>(cause)];
}

} // namespace i2b
