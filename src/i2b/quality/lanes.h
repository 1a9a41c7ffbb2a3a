// Faces and cells that are measured eight at a time lie side by side, one to a lane. Each lane goes through the very
// operations, in the very order, that the plain code goes through, so results are the same to the last bit; that rests
// on -ffp-contract=off.
#pragma once
#include "i2b/core/vec.h"
#include <algorithm>
#include <limits>

namespace i2b {

inline constexpr std::size_t laneCount = 8;

struct alignas(64) Lanes {
    double value[laneCount] = {};

    double& operator[](std::size_t lane) { return value[lane]; }
    double operator[](std::size_t lane) const { return value[lane]; }
};

// Eight vectors.
struct VecLanes {
    Lanes x, y, z;

    void set(std::size_t lane, const Vec3& v) { x[lane] = v.x, y[lane] = v.y, z[lane] = v.z; }
    Vec3 operator[](std::size_t lane) const { return {x[lane], y[lane], z[lane]}; }
};

// Least and greatest values of each lane so far.
struct LaneExtremes {
    Lanes least, most;

    LaneExtremes() {
        std::fill_n(least.value, laneCount, std::numeric_limits<double>::infinity());
        std::fill_n(most.value, laneCount, -std::numeric_limits<double>::infinity());
    }
    double leastOfAll() const { return *std::min_element(least.value, least.value + laneCount); }
    double mostOfAll() const { return *std::max_element(most.value, most.value + laneCount); }
};

} // namespace i2b
