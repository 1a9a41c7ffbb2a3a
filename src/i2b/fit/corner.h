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

// Cube root of a positive number to about 1e-14: a third of the exponent, then two Halley steps. Several times as fast
// as the library's, and the same on every IEEE machine.
inline double cubeRootGuess(double x) { return std::bit_cast<double>(std::bit_cast<std::uint64_t>(x) / 3 + 0x2a9f7893782da1ceull); }
inline double cubeRoot(double x) {
    double y = cubeRootGuess(x);
    for (int i = 0; i < 2; ++i) {
        const double t = y * y * y;
        y *= (t + 2 * x) / (2 * t + x);
    }
    return y;
}

inline double energyOf(double trace, double det) {
    if (!(det > 0)) return std::numeric_limits<double>::infinity();
    const double root = cubeRoot(det);
    return 0.25 * trace / (root * root) + 0.125 * (det + 1 / det);
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
