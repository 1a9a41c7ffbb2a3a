// Four numbers or vectors side by side, for loops over the corners of a quadrangle. Every lane goes through the operations that
// plain code goes through, so results are the same to the last bit; that rests on -ffp-contract=off.
#pragma once
#include "i2b/core/vec.h"
#include <cmath>

namespace i2b {

using Four = double __attribute__((vector_size(4 * sizeof(double))));

struct VecFour {
    Four x, y, z;

    Vec3 operator[](std::size_t lane) const { return {x[lane], y[lane], z[lane]}; }
};

inline VecFour fourOf(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    return {Four{a.x, b.x, c.x, d.x}, Four{a.y, b.y, c.y, d.y}, Four{a.z, b.z, c.z, d.z}};
}
inline VecFour operator+(const VecFour& a, const VecFour& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline VecFour operator+(const VecFour& a, const Vec3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline VecFour operator-(const VecFour& a, const VecFour& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline VecFour operator-(const Vec3& a, const VecFour& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline VecFour operator*(const Four& s, const VecFour& v) { return {s * v.x, s * v.y, s * v.z}; }
inline VecFour cross(const VecFour& a, const VecFour& b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }
inline Four dot(const VecFour& a, const VecFour& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Four dot(const VecFour& a, const Vec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Four sqrt(const Four& v) {
#if defined(__AVX__)
    return __builtin_ia32_sqrtpd256(v);
#else
    return Four{std::sqrt(v[0]), std::sqrt(v[1]), std::sqrt(v[2]), std::sqrt(v[3])};
#endif
}
// Lanes in another order.
template <int a, int b, int c, int d>
VecFour picked(const VecFour& v) {
    return {__builtin_shufflevector(v.x, v.x, a, b, c, d), __builtin_shufflevector(v.y, v.y, a, b, c, d), __builtin_shufflevector(v.z, v.z, a, b, c, d)};
}
// One after the other, as a loop would.
inline double sum(const Four& v) { return ((0.0 + v[0]) + v[1] + v[2]) + v[3]; }
inline Vec3 sum(const VecFour& v) { return {sum(v.x), sum(v.y), sum(v.z)}; }

} // namespace i2b
