// The corners around one node as functions of that node's place: D is affine in it, |J|^2 quadratic. Both are exact for
// any move of the node, so steps and line searches touch no memory.
//
// Corners are worked on four at a time, in lanes; sums run over them one by one, in order, so every result is that of a
// plain loop, bit for bit, on any instruction set.
#pragma once
#include "i2b/fit/corner.h"
#include <cmath>

namespace i2b {

struct CornerLanes { // the compiler's vectors, as a type of our own
    using Register = double __attribute__((vector_size(32)));
    static constexpr std::size_t count = 4;
    Register v;
    CornerLanes() = default;
    explicit CornerLanes(double s) : v{s, s, s, s} {}
    CornerLanes(double a, double b, double c, double d) : v{a, b, c, d} {}
    explicit CornerLanes(const Register& r) : v(r) {}
    double operator[](std::size_t i) const { return v[i]; }
    void set(std::size_t i, double s) { v[i] = s; }
    friend CornerLanes operator+(const CornerLanes& a, const CornerLanes& b) { return CornerLanes(a.v + b.v); }
    friend CornerLanes operator-(const CornerLanes& a, const CornerLanes& b) { return CornerLanes(a.v - b.v); }
    friend CornerLanes operator*(const CornerLanes& a, const CornerLanes& b) { return CornerLanes(a.v * b.v); }
    friend CornerLanes operator/(const CornerLanes& a, const CornerLanes& b) { return CornerLanes(a.v / b.v); }
    friend CornerLanes operator*(double s, const CornerLanes& a) { return CornerLanes(s * a.v); }
    CornerLanes operator-() const { return CornerLanes(-v); }
};

// where[i] == value ? a[i] : b[i]
inline CornerLanes choose(const CornerLanes& where, double value, const CornerLanes& a, const CornerLanes& b) {
    return CornerLanes(where.v == value ? a.v : b.v);
}

struct LaneVec3 {
    CornerLanes x, y, z;
    friend LaneVec3 operator+(const LaneVec3& a, const LaneVec3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
    friend LaneVec3 operator-(const LaneVec3& a, const LaneVec3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
    friend LaneVec3 operator*(const LaneVec3& a, const CornerLanes& s) { return {a.x * s, a.y * s, a.z * s}; }
    LaneVec3 operator-() const { return {-x, -y, -z}; }
};
inline CornerLanes dot(const LaneVec3& a, const LaneVec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline LaneVec3 cross(const LaneVec3& a, const LaneVec3& b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }
inline LaneVec3 choose(const CornerLanes& where, double value, const LaneVec3& a, const LaneVec3& b) {
    return {choose(where, value, a.x, b.x), choose(where, value, a.y, b.y), choose(where, value, a.z, b.z)};
}

inline CornerLanes cubeRoot(const CornerLanes& x) {
    CornerLanes y;
    for (std::size_t i = 0; i < CornerLanes::count; ++i) y.set(i, cubeRootGuess(x[i]));
    for (int i = 0; i < 2; ++i) {
        const CornerLanes t = y * y * y;
        y = y * ((t + 2.0 * x) / (2.0 * t + x));
    }
    return y;
}

// Gradient and the upper triangle of the Hessian: xx, xy, xz, yy, yz, zz.
struct Derivatives {
    Vec3 gradient;
    std::array<double, 6> hessian{};

    void addOuter(const Vec3& a, double w) {
        const Vec3 s = a * w;
        hessian[0] += s.x * a.x, hessian[1] += s.x * a.y, hessian[2] += s.x * a.z;
        hessian[3] += s.y * a.y, hessian[4] += s.y * a.z, hessian[5] += s.z * a.z;
    }
};

class LocalCorners {
  public:
    // Looks at the corners of a node.
    void gather(const Band& band, std::size_t node, const std::vector<Vec3>& x);
    bool empty() const { return count_ == 0; }
    double worstScaledJacobian() const; // at most 1
    // Of sum w phi^3, with phi = T D^(-2/3) / 4 + (D + 1/D) / 8, after a move of the node by d; infinite where a D <= 0.
    double energy(const Vec3& d);
    // At the move that energy() was asked for last.
    Derivatives derivatives(const Vec3& d) const;

  private:
    struct Group {             // of corners, one to a lane
        LaneVec3 e0, e1, e2;   // m, edges from node[0]
        CornerLanes w0, w1, w2;  // inverse lengths
        CornerLanes role;        // which of the corner's nodes it is
        LaneVec3 gradient;     // of D
        CornerLanes det0;        // D at the node's present place
        CornerLanes quadratic;   // trace = quadratic * |d|^2 + linear . d + trace0, with d the move from there
        LaneVec3 linear;
        CornerLanes trace0;
        CornerLanes weight;
        CornerLanes det, trace, root, inverse; // where energy() was asked for last: D, trace, D^(1/3), 1 / D
    };
    std::size_t groups() const { return (count_ + CornerLanes::count - 1) / CornerLanes::count; }

    std::size_t count_ = 0;
    std::vector<Group> groups_;
};

inline void LocalCorners::gather(const Band& band, std::size_t node, const std::vector<Vec3>& x) {
    const std::span<const std::int32_t> corners = band.cornersOf[node];
    count_ = corners.size();
    if (groups_.size() < groups()) groups_.resize(groups());
    // What a node needs is seldom near what the one before had: all of it is asked for before any is used.
    for (const std::int32_t c : corners) __builtin_prefetch(&band.corners[static_cast<std::size_t>(c)]);
    for (const std::int32_t c : corners)
        for (const std::int32_t m : band.corners[static_cast<std::size_t>(c)].node) __builtin_prefetch(&x[static_cast<std::size_t>(m)]);
    const auto self = static_cast<std::int32_t>(node);
    const auto roleOf = [&](const Corner& c) { return double((c.node[1] == self) + 2 * (c.node[2] == self) + 3 * (c.node[3] == self)); };
    for (std::size_t i = 0; i < groups(); ++i) {
        std::array<const Corner*, CornerLanes::count> corner; // the last one fills up, without weight
        for (std::size_t k = 0; k < CornerLanes::count; ++k)
            corner[k] = &band.corners[static_cast<std::size_t>(corners[std::min(CornerLanes::count * i + k, count_ - 1)])];
        const auto lanes = [&](const auto& of) { return CornerLanes(of(*corner[0]), of(*corner[1]), of(*corner[2]), of(*corner[3])); };
        const auto place = [&](std::size_t k) {
            const auto at = [&](std::size_t lane) -> const Vec3& { return x[static_cast<std::size_t>(corner[lane]->node[k])]; };
            const Vec3 &a = at(0), &b = at(1), &c = at(2), &d = at(3);
            return LaneVec3{CornerLanes(a.x, b.x, c.x, d.x), CornerLanes(a.y, b.y, c.y, d.y), CornerLanes(a.z, b.z, c.z, d.z)};
        };
        const auto inverse = [&](std::size_t k) { return lanes([k](const Corner& c) { return double(c.inverseLength[k]); }); };
        Group& c = groups_[i];
        const LaneVec3 p0 = place(0);
        c.e0 = place(1) - p0, c.e1 = place(2) - p0, c.e2 = place(3) - p0;
        c.w0 = inverse(0), c.w1 = inverse(1), c.w2 = inverse(2);
        c.role = lanes(roleOf);
        c.weight = lanes([](const Corner& of) { return double(of.weight); });
        for (std::size_t k = count_ - CornerLanes::count * i; k < CornerLanes::count; ++k) c.weight.set(k, 0);
        const CornerLanes volume = c.w0 * c.w1 * c.w2;
        const LaneVec3 g0 = cross(c.e1, c.e2) * volume, g1 = cross(c.e2, c.e0) * volume, g2 = cross(c.e0, c.e1) * volume;
        c.det0 = dot(g0, c.e0);
        c.trace0 = dot(c.e0, c.e0) * c.w0 * c.w0 + dot(c.e1, c.e1) * c.w1 * c.w1 + dot(c.e2, c.e2) * c.w2 * c.w2;
        const LaneVec3 l0 = c.e0 * (2.0 * c.w0 * c.w0), l1 = c.e1 * (2.0 * c.w1 * c.w1), l2 = c.e2 * (2.0 * c.w2 * c.w2);
        const CornerLanes q0 = c.w0 * c.w0, q1 = c.w1 * c.w1, q2 = c.w2 * c.w2, none(0);
        c.gradient = choose(c.role, 0, -(g0 + g1 + g2), choose(c.role, 1, g0, choose(c.role, 2, g1, g2)));
        c.quadratic = choose(c.role, 0, q0 + q1 + q2, choose(c.role, 1, q0, choose(c.role, 2, q1, q2)));
        c.linear = choose(c.role, 0, LaneVec3{none, none, none} - l0 - l1 - l2, choose(c.role, 1, l0, choose(c.role, 2, l1, l2)));
    }
}

inline double LocalCorners::worstScaledJacobian() const {
    double worst = 1;
    for (std::size_t i = 0; i < groups(); ++i) {
        const Group& c = groups_[i];
        const CornerLanes det = dot(cross(c.e0, c.e1), c.e2);
        const CornerLanes n0 = dot(c.e0, c.e0), n1 = dot(c.e1, c.e1), n2 = dot(c.e2, c.e2);
        for (std::size_t k = 0; k < CornerLanes::count; ++k) {
            const double l = std::sqrt(n0[k]) * std::sqrt(n1[k]) * std::sqrt(n2[k]);
            worst = std::min(worst, l > 0 ? det[k] / l : -1);
        }
    }
    return worst;
}

inline double LocalCorners::energy(const Vec3& d) {
    const LaneVec3 move{CornerLanes(d.x), CornerLanes(d.y), CornerLanes(d.z)};
    const CornerLanes length2(norm2(d));
    double sum = 0;
    bool inverted = false; // goes on all the same: faces that were just split may start so, and derivatives are asked for
    for (std::size_t i = 0; i < groups(); ++i) {
        Group& c = groups_[i];
        c.det = c.det0 + dot(c.gradient, move);
        for (std::size_t k = 0; k < CornerLanes::count; ++k) inverted |= !(c.det[k] > 0);
        c.trace = c.trace0 + dot(c.linear, move) + c.quadratic * length2;
        c.root = cubeRoot(c.det);
        c.inverse = CornerLanes(1) / c.det;
        const CornerLanes phi = 0.25 * c.trace / (c.root * c.root) + 0.125 * (c.det + c.inverse);
        const CornerLanes part = c.weight * phi * phi * phi;
        for (std::size_t k = 0; k < CornerLanes::count; ++k) sum += part[k];
    }
    return inverted ? std::numeric_limits<double>::infinity() : sum;
}

inline Derivatives LocalCorners::derivatives(const Vec3& d) const {
    const LaneVec3 move{CornerLanes(d.x), CornerLanes(d.y), CornerLanes(d.z)};
    const CornerLanes quarter(0.25), one(1);
    Derivatives sum;
    for (std::size_t i = 0; i < groups(); ++i) {
        const Group& c = groups_[i];
        const CornerLanes d23 = quarter / (c.root * c.root);
        const LaneVec3 t = c.linear + move * (2.0 * c.quadratic);
        const CornerLanes phi = c.trace * d23 + 0.125 * (c.det + c.inverse);
        const CornerLanes slope = -(2.0 / 3) * c.trace * d23 * c.inverse + 0.125 * (one - c.inverse * c.inverse); // d phi / d det
        const LaneVec3 dphi = t * d23 + c.gradient * slope;
        const CornerLanes w = 3.0 * c.weight * phi * phi;
        const LaneVec3 gradient = dphi * w;
        // In order: of 2 quadratic 1, (t g^T + g t^T), g g^T and dphi dphi^T, each with its weight.
        const LaneVec3& g = c.gradient;
        const CornerLanes identity = w * CornerLanes(2) * c.quadratic * d23, both = -w * CornerLanes(2.0 / 3) * d23 * c.inverse;
        const CornerLanes outer = w * ((10.0 / 9) * c.trace * d23 * c.inverse * c.inverse + 0.25 * c.inverse * c.inverse * c.inverse);
        const LaneVec3 s = t * both, u = g * both, v = g * outer, r = dphi * (6.0 * c.weight * phi);
        const CornerLanes cxx = 2.0 * s.x * g.x, cxy = s.x * g.y + u.x * t.y, cxz = s.x * g.z + u.x * t.z;
        const CornerLanes cyy = 2.0 * s.y * g.y, cyz = s.y * g.z + u.y * t.z, czz = 2.0 * s.z * g.z;
        const CornerLanes oxx = v.x * g.x, oxy = v.x * g.y, oxz = v.x * g.z, oyy = v.y * g.y, oyz = v.y * g.z, ozz = v.z * g.z;
        const CornerLanes pxx = r.x * dphi.x, pxy = r.x * dphi.y, pxz = r.x * dphi.z, pyy = r.y * dphi.y, pyz = r.y * dphi.z, pzz = r.z * dphi.z;
        for (std::size_t k = 0; k < CornerLanes::count; ++k) {
            sum.gradient.x += gradient.x[k], sum.gradient.y += gradient.y[k], sum.gradient.z += gradient.z[k];
            auto& h = sum.hessian;
            h[0] += identity[k], h[3] += identity[k], h[5] += identity[k];
            h[0] += cxx[k], h[1] += cxy[k], h[2] += cxz[k], h[3] += cyy[k], h[4] += cyz[k], h[5] += czz[k];
            h[0] += oxx[k], h[1] += oxy[k], h[2] += oxz[k], h[3] += oyy[k], h[4] += oyz[k], h[5] += ozz[k];
            h[0] += pxx[k], h[1] += pxy[k], h[2] += pxz[k], h[3] += pyy[k], h[4] += pyz[k], h[5] += pzz[k];
        }
    }
    return sum;
}

} // namespace i2b
