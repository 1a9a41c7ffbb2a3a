// Ogive nose, cylinder, boat tail, four fins of double-wedge section.
#include "i2b/samples/parts.h"

namespace i2b::samples {
namespace {

constexpr double length = 2.0, noseLength = 0.5, radius = 0.1, tailStart = 1.85, tailRadius = 0.075;

// Tangent ogive: an arc of radius rho that meets the cylinder without an angle.
double ogive(double x) {
    const double rho = (radius * radius + noseLength * noseLength) / (2 * radius);
    const double d = noseLength - x;
    return std::sqrt(rho * rho - d * d) + radius - rho;
}

Profile noseProfile(int n) {
    Profile p{{0, 0}};
    for (int i = 1; i <= n; ++i) { // closer together towards the tip
        const double s = double(i) / n, x = noseLength * s * (0.4 + 0.6 * s);
        p.push_back({i == n ? radius : ogive(x), x});
    }
    return p;
}

void addCylinder(Profile& p, double from, int n) {
    for (int i = 1; i <= n; ++i) p.push_back({radius, from + (tailStart - from) * i / n});
    p.push_back({tailRadius, length});
    p.push_back({0, length});
}

Mesh bodyMesh(const Make& make) {
    const Frame axis{{}, {0, 1, 0}, {0, 0, 1}, {1, 0, 0}};
    Profile nose = noseProfile(make.n(20));
    if (!make.dirty()) {
        addCylinder(nose, noseLength, make.n(18));
        return lathe(axis, nose, make.n(64));
    }
    // The nose ends in an open rim, the rest begins in one with another count, 0.3 mm behind.
    Profile rest{{radius, noseLength + make.gap(0.3)}};
    addCylinder(rest, noseLength, make.n(18));
    const auto skin = [&](const Profile& profile, int n, Caps caps) {
        std::vector<Ring> rings;
        for (const Vec2& p : profile) {
            Ring& ring = rings.emplace_back();
            for (int i = 0; i < (p.x > 0 ? n : 1); ++i)
                ring.push_back({p.y, p.x * unitCircle(i, n).x, p.x * unitCircle(i, n).y});
        }
        return loft(rings, caps);
    };
    Mesh mesh = skin(nose, make.n(64), {false, false});
    append(mesh, skin(rest, make.n(48), {false, false}));
    return mesh;
}

// Fin in the plane of x and r, from root radius outwards; four-sided section, sharp at both edges and at the
// ridge.
Mesh finMesh(const Make& make, double root) {
    const auto section = [&](double r, double lead, double trail, double half) {
        const int n = make.n(6);
        const std::array<Vec3, 4> corner{
            Vec3{lead, r, 0}, {(lead + trail) / 2, r, -half}, {trail, r, 0}, {(lead + trail) / 2, r, half}};
        Ring ring;
        for (std::size_t k = 0; k < 4; ++k)
            for (int i = 0; i < n; ++i)
                ring.push_back(corner[k] + (corner[(k + 1) % 4] - corner[k]) * (double(i) / n));
        std::reverse(ring.begin(), ring.end()); // counterclockwise about +y
        return ring;
    };
    std::vector<Ring> rings;
    const int n = make.n(8);
    const double tip = 0.26;
    for (int k = 0; k <= n; ++k) {
        const double s = double(k) / n, r = root + (tip - root) * s, t = (r - 0.09) / (tip - 0.09);
        rings.push_back(section(r, 1.50 + 0.18 * t, 1.82 + 0.02 * t, 0.009 - 0.005 * t));
    }
    return loft(rings);
}

} // namespace

Parts missileParts(const Make& make) {
    Parts parts{{"body", bodyMesh(make)}};
    for (int k = 0; k < 4; ++k) {
        // Dirty: two fins stand 0.4 mm off the skin at its thickest, two run deeper in than the clean ones.
        const double root = !make.dirty() ? 0.097
                            : k % 2 == 0  ? radius + make.gap(0.4)
                                          : radius - 0.003 - make.bite(2);
        Mesh fin = finMesh(make, root);
        const Vec2 e = unitCircle(k, 4);
        for (Vec3& p : fin.points) p = {p.x, e.x * p.y - e.y * p.z, e.y * p.y + e.x * p.z};
        parts.push_back({"fin_" + std::to_string(k + 1), fin});
    }
    return parts;
}

} // namespace i2b::samples
