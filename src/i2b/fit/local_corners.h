// The corners around one node as functions of that node's place: D is affine in it, |J|^2 quadratic. Both are exact for
// any move of the node, so steps and line searches touch no memory.
//
// Corners are worked on four at a time, in lanes, each with its own sum; the four are added last, in order. What comes out
// is the same, bit for bit, on any instruction set.
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
    friend CornerLanes operator*(double s, const CornerLanes& a) { return CornerLanes(s * a.v); }
    CornerLanes operator-() const { return CornerLanes(-v); }
    double sum() const { return v[0] + v[1] + v[2] + v[3]; }
};

inline CornerLanes atLeast(const CornerLanes& a, double least) { return CornerLanes(a.v > least ? a.v : CornerLanes(least).v); }

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

inline CornerLanes inverseCubeRoot(const CornerLanes& x) {
    using Bits = std::uint64_t __attribute__((vector_size(32)));
    using Words = std::uint32_t __attribute__((vector_size(32)));
    const Words third = Words(Bits(x.v) >> 46) * 21845u; // as in inverseCubeRoot() of a number
    CornerLanes y(CornerLanes::Register(inverseCubeRootMagic - (Bits(third) << 30)));
    for (int i = 0; i < 2; ++i) y = inverseCubeRootStep(CornerLanes(1), x, y);
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
    void gather(const Band& band, std::size_t node, const Positions& x);
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
        CornerLanes det, trace, root2, inverse; // where energy() was asked for last: D, trace, D^(-2/3), 1 / D (of a D that is positive)
    };
    std::size_t groups() const { return (count_ + CornerLanes::count - 1) / CornerLanes::count; }

    std::size_t count_ = 0;
    std::vector<Corner> around_;
    std::vector<Group> groups_;
};

inline void LocalCorners::gather(const Band& band, std::size_t node, const Positions& x) {
    // What a node needs is seldom near what the one before had: all of it is asked for before any is used.
    band.corners.prefetchAround(node);
    around_.clear();
    band.corners.around(node, [&](const Corner& c) {
        for (const std::int32_t m : c.node) __builtin_prefetch(&x[static_cast<std::size_t>(m)]);
        around_.push_back(c);
    });
    count_ = around_.size();
    if (groups_.size() < groups()) groups_.resize(groups());
    const auto self = static_cast<std::int32_t>(node);
    const auto roleOf = [&](const Corner& c) { return double((c.node[1] == self) + 2 * (c.node[2] == self) + 3 * (c.node[3] == self)); };
    for (std::size_t i = 0; i < groups(); ++i) {
        std::array<const Corner*, CornerLanes::count> corner; // the last one fills up, without weight
        for (std::size_t k = 0; k < CornerLanes::count; ++k)
            corner[k] = &around_[std::min(CornerLanes::count * i + k, count_ - 1)];
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
        const CornerLanes lengths2 = dot(c.e0, c.e0) * dot(c.e1, c.e1) * dot(c.e2, c.e2);
        for (std::size_t k = 0; k < CornerLanes::count; ++k) worst = std::min(worst, lengths2[k] > 0 ? det[k] / std::sqrt(lengths2[k]) : -1);
    }
    return worst;
}

inline double LocalCorners::energy(const Vec3& d) {
    const LaneVec3 move{CornerLanes(d.x), CornerLanes(d.y), CornerLanes(d.z)};
    const CornerLanes length2(norm2(d));
    CornerLanes sum(0);
    // Faces that were just split may start with corners inside out: these pull as ones do that are almost flat.
    constexpr double almostFlat = 1e-3;
    bool inverted = false;
    for (std::size_t i = 0; i < groups(); ++i) {
        Group& c = groups_[i];
        c.det = c.det0 + dot(c.gradient, move);
        for (std::size_t k = 0; k < CornerLanes::count; ++k) inverted |= !(c.det[k] > 0);
        c.trace = c.trace0 + dot(c.linear, move) + c.quadratic * length2;
        const CornerLanes root = inverseCubeRoot(atLeast(c.det, almostFlat));
        c.root2 = root * root;
        c.inverse = c.root2 * root;
        const CornerLanes phi = 0.25 * c.trace * c.root2 + 0.125 * (c.det + c.inverse);
        sum = sum + c.weight * phi * phi * phi;
    }
    return inverted ? std::numeric_limits<double>::infinity() : sum.sum();
}

inline Derivatives LocalCorners::derivatives(const Vec3& d) const {
    const LaneVec3 move{CornerLanes(d.x), CornerLanes(d.y), CornerLanes(d.z)};
    const CornerLanes one(1), none(0);
    LaneVec3 gradient{none, none, none};
    CornerLanes xx = none, xy = none, xz = none, yy = none, yz = none, zz = none;
    for (std::size_t i = 0; i < groups(); ++i) {
        const Group& c = groups_[i];
        const CornerLanes d23 = 0.25 * c.root2, pull = c.trace * d23;
        const LaneVec3 t = c.linear + move * (2.0 * c.quadratic);
        const CornerLanes phi = pull + 0.125 * (c.det + c.inverse);
        const CornerLanes slope = -(2.0 / 3) * pull * c.inverse + 0.125 * (one - c.inverse * c.inverse); // d phi / d det
        const LaneVec3 dphi = t * d23 + c.gradient * slope;
        const CornerLanes w = 3.0 * c.weight * phi * phi;
        gradient = gradient + dphi * w;
        // 2 quadratic 1, (t g^T + g t^T), g g^T and dphi dphi^T, each with its weight.
        const LaneVec3& g = c.gradient;
        const CornerLanes wd = w * d23, identity = 2.0 * wd * c.quadratic, both = -(2.0 / 3) * wd * c.inverse;
        const CornerLanes outer = w * c.inverse * c.inverse * ((10.0 / 9) * pull + 0.25 * c.inverse);
        const LaneVec3 s = t * both + g * outer, u = g * both, r = dphi * (6.0 * c.weight * phi);
        xx = xx + (identity + u.x * t.x + s.x * g.x + r.x * dphi.x);
        yy = yy + (identity + u.y * t.y + s.y * g.y + r.y * dphi.y);
        zz = zz + (identity + u.z * t.z + s.z * g.z + r.z * dphi.z);
        xy = xy + (u.x * t.y + s.x * g.y + r.x * dphi.y);
        xz = xz + (u.x * t.z + s.x * g.z + r.x * dphi.z);
        yz = yz + (u.y * t.z + s.y * g.z + r.y * dphi.z);
    }
    return {{gradient.x.sum(), gradient.y.sum(), gradient.z.sum()}, {xx.sum(), xy.sum(), xz.sum(), yy.sum(), yz.sum(), zz.sum()}};
}

} // namespace i2b
