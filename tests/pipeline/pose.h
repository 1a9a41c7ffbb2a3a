// A turn and a shift by up to half a cell against the lattice, at random: the same for the same name and seed on every machine.
#pragma once
#include "i2b/core/vec.h"
#include <array>
#include <cmath>
#include <random>
#include <string_view>

namespace i2b::test {

class Pose {
  public:
    Pose(std::string_view name, double h, unsigned seed) {
        for (const char c : name) seed = seed * 31u + static_cast<unsigned char>(c);
        std::mt19937 random(seed);
        const auto real = [&] { return static_cast<double>(random()) / 2147483648.0 - 1; }; // the standard's
        double length = 0;                                          // distributions differ between libraries
        while (length < 0.1 || length > 1) { // even over all turns: a quaternion even over the 3-sphere
            for (double& v : q_) v = real();
            length = std::sqrt(q_[0] * q_[0] + q_[1] * q_[1] + q_[2] * q_[2] + q_[3] * q_[3]);
        }
        for (double& v : q_) v /= length;
        const double x = real(), y = real(), z = real();
        shift_ = Vec3{x, y, z} * (h / 2);
    }
    Vec3 operator()(const Vec3& p) const {
        const Vec3 v{q_[1], q_[2], q_[3]};
        return p + 2 * cross(v, cross(v, p) + q_[0] * p) + shift_;
    }

  private:
    std::array<double, 4> q_{};
    Vec3 shift_;
};

} // namespace i2b::test
