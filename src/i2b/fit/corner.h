// Arithmetic of corner tetrahedra, shared by the steps of the fit.
#pragma once
#include "i2b/core/parallel.h"
#include "i2b/fit/band.h"
#include <bit>

namespace i2b {

inline double determinantOf(const Corner& c, const Vec3& x0, const Vec3& x1, const Vec3& x2, const Vec3& x3) {
    const double scale = double(c.inverseLength[0]) * double(c.inverseLength[1]) * double(c.inverseLength[2]);
    return dot(cross(x1 - x0, x2 - x0), x3 - x0) * scale;
}

// x^(-1/3) of a positive number but for its last digits, without a division: minus a third of the exponent and a few bits
// more, then two Householder steps of fourth order, 0.036 -> 2e-5 -> 6e-16 off. The same on every IEEE machine.
constexpr std::uint64_t inverseCubeRootMagic = 0x553ecf0000000000ull; // the least error from 1/8 to 8, by search
template <class Number>
Number inverseCubeRootStep(const Number& one, const Number& x, const Number& y) {
    const Number r = one - x * y * y * y;
    return y + y * r * (1.0 / 3 * one + r * (2.0 / 9 * one + 14.0 / 81 * r));
}
inline double inverseCubeRoot(double x) {
    const auto top = static_cast<std::uint32_t>(std::bit_cast<std::uint64_t>(x) >> 46);
    double y = std::bit_cast<double>(inverseCubeRootMagic - (std::uint64_t{top * 21845u} << 30)); // 65535 / 3
    for (int i = 0; i < 2; ++i) y = inverseCubeRootStep(1.0, x, y);
    return y;
}

inline double energyOf(double trace, double det) {
    if (!(det > 0)) return std::numeric_limits<double>::infinity();
    const double root = inverseCubeRoot(det), root2 = root * root;
    return 0.25 * trace * root2 + 0.125 * (det + root2 * root);
}

// energyOf() > limit, by its cube: no root.
inline bool energyExceeds(double trace, double det, double limit) {
    if (!(det > 0)) return true;
    const double rest = limit - 0.125 * (det + 1 / det);
    return !(rest > 0) || trace * trace * trace > 64 * (rest * rest * rest) * (det * det);
}

// Drops the components of a move that would leave the sides of the domain box.
inline Vec3 withinSides(Vec3 move, std::uint8_t outside) {
    for (int axis = 0; axis < 3; ++axis) {
        if (outside >> (2 * axis) & 3) move[axis] = 0;
    }
    return move;
}

} // namespace i2b
