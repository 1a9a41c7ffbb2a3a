// The accessory drive at the front: crankshaft pulley, water pump, alternator, belt. All turn about axes
// along x.
#include "i2b/samples/parts.h"

namespace i2b::samples {
namespace {

using namespace engine;

constexpr Vec2 crankAt{0, crankHeight}, pumpAt{-0.004, 0.372}, alternatorAt{0.150, 0.385}; // (y, z)
constexpr double beltFrom = 0.021, beltTo = 0.043;                                         // x
constexpr double crankRadius = 0.078, pumpRadius = 0.054, alternatorRadius = 0.030;

Frame axisAt(Vec2 at, double x) { return {{x, at.x, at.y}, {0, 1, 0}, {0, 0, 1}, {1, 0, 0}}; }

// A pulley between x = 0 and `width`: dished front, V grooves on the rim.
Profile pulley(double radius, double width, double dish, int grooves) {
    Profile p{{0, dish},          {0.45 * radius, dish}, {0.5 * radius, dish}, {0.80 * radius, dish * 0.9},
              {0.86 * radius, 0}, {radius - 0.001, 0},   {radius, 0.001}};
    const double pitch = (width - 0.006) / grooves;
    for (int g = 0; g < grooves; ++g) {
        const double x = 0.003 + pitch * g;
        p.push_back({radius, x});
        p.push_back({radius - 0.0025, x + 0.35 * pitch});
        p.push_back({radius - 0.0025, x + 0.65 * pitch});
    }
    p.push_back({radius, width - 0.003});
    p.push_back({radius, width});
    p.push_back({0, width});
    return p;
}

Mesh crankPulley(const Make& make) {
    Mesh mesh = lathe(axisAt(crankAt, beltFrom - 0.003),
                      pulley(crankRadius, beltTo - beltFrom + 0.006, 0.010, 5), make.n(40));
    append(
        mesh,
        lathe(
            axisAt(crankAt, 0.010),
            {{0, 0}, {0.017, 0}, {0.019, 0.003}, {0.019, 0.012}, {0.021, 0.040}, {0.021, 0.050}, {0, 0.050}},
            make.n(32)));
    append(mesh, boltHead({0.010, crankAt.x, crankAt.y}, {-1, 0, 0}, 0.022));
    return mesh;
}

Mesh waterPump(const Make& make) {
    const int n = make.n(40);
    Mesh mesh = lathe(axisAt(pumpAt, beltFrom), pulley(pumpRadius, beltTo - beltFrom, 0.008, 5), n);
    append(mesh, lathe(axisAt(pumpAt, 0.014),
                       {{0, 0}, {0.013, 0}, {0.016, 0.003}, {0.016, 0.036}, {0, 0.036}}, make.n(24)));
    for (int i = 0; i < 4; ++i) {
        const Vec2 e = unitCircle(2 * i + 1, 8) * 0.023;
        append(mesh, boltHead({beltFrom + 0.008, pumpAt.x + e.x, pumpAt.y + e.y}, {-1, 0, 0}, 0.009));
    }
    // Housing with its volute neck, a little way into the timing cover.
    const double back = front - 0.024 + make.bite(2);
    append(mesh,
           lathe(axisAt(pumpAt, 0),
                 {{0, 0.046}, {0.028, 0.046}, {0.041, 0.050}, {0.043, 0.053}, {0.043, back}, {0, back}}, n));
    append(mesh, pipe(bentPath({{0.061, 0.02, 0.37}, {0.061, -0.075, 0.350}, {0.061, -0.105, 0.405}}, 0.025,
                               make.n(8)),
                      0.0125, make.n(20)));
    return mesh;
}

Mesh alternator(const Make& make) {
    const int n = make.n(40);
    Mesh mesh = lathe(axisAt(alternatorAt, beltFrom), pulley(alternatorRadius, beltTo - beltFrom, 0.006, 5),
                      make.n(32));
    append(mesh,
           lathe(axisAt(alternatorAt, 0.012), {{0, 0}, {0.009, 0}, {0.009, 0.045}, {0, 0.045}}, make.n(20)));
    append(mesh, lathe(axisAt(alternatorAt, 0.050),
                       {{0, 0},
                        {0.035, 0},
                        {0.048, 0.006},
                        {0.055, 0.014},
                        {0.055, 0.042},
                        {0.0515, 0.044},
                        {0.0515, 0.058},
                        {0.055, 0.060},
                        {0.055, 0.090},
                        {0.050, 0.102},
                        {0.030, 0.106},
                        {0, 0.106}},
                       n));
    for (int i = 0; i < 12; ++i) { // ribs of the two shields
        const Vec2 e = unitCircle(i, 12), t{-e.y, e.x};
        for (const double x : {0.070, 0.116}) {
            const Frame rib{{x, alternatorAt.x + 0.050 * e.x, alternatorAt.y + 0.050 * e.y},
                            {1, 0, 0},
                            {0, t.x, t.y},
                            {0, e.x, e.y}};
            append(mesh,
                   roundedBox(rib, {{0, -0.002}, {0.018, 0.002}, 0, 0.0075, 0.0019, 0.001, 0.02, make.n(1)}));
        }
    }
    // Arms to the block: the upper one adjusts, the lower one turns on a bolt.
    for (const auto& [from, to] : {std::pair{Vec2{0.150, 0.436}, Vec2{0.062, 0.425}},
                                   std::pair{Vec2{0.135, 0.337}, Vec2{0.066, 0.325}}}) {
        const Vec2 d = (to - from) * (1 / std::sqrt(dot(to - from, to - from))), t{-d.y, d.x};
        Loop2 arm;
        const double half[2] = {0.012, 0.014};
        int k = 0;
        for (const Vec2& p : {from, to}) {
            const double side = k == 0 ? -1 : 1;
            for (int i = 0; i <= make.n(8); ++i) {
                const Vec2 e = unitCircle(i, 2 * make.n(8)) * half[k];
                arm.push_back(p + t * (-side * e.x) + d * (side * e.y));
            }
            ++k;
        }
        append(mesh, extrude(lengthwise(0.088), arm, {}, {0, 0.012}));
        append(mesh,
               lathe(axisAt(from, 0.058), {{0, 0}, {0.0085, 0}, {0.0085, 0.088}, {0, 0.088}}, make.n(16)));
    }
    return mesh;
}

Mesh belt(const Make& make) {
    const auto around = [&](double more) {
        std::vector<Vec2> points;
        for (const auto& [at, r] : {std::pair{crankAt, crankRadius}, std::pair{pumpAt, pumpRadius},
                                    std::pair{alternatorAt, alternatorRadius}})
            for (const Vec2& p : circle(at, r + more, make.n(64))) points.push_back(p);
        return convexHull(points);
    };
    // Dirty: deeper in the grooves.
    return extrude(lengthwise(0), around(0.0032), {around(-make.bite(1.2))}, {beltFrom, beltTo});
}

} // namespace

void addEngineDrive(Parts& parts, const Make& make) {
    parts.push_back({"crank_pulley", crankPulley(make)});
    parts.push_back({"water_pump", waterPump(make)});
    parts.push_back({"alternator", alternator(make)});
    parts.push_back({"drive_belt", belt(make)});
}

} // namespace i2b::samples
