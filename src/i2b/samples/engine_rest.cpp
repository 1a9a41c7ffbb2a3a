// Flywheel housing with starter, oil filter, dipstick, mounts.
#include "i2b/samples/parts.h"

namespace i2b::samples {
namespace {

using namespace engine;

Mesh flywheelHousing(const Make& make) {
    const Frame axis =
        Frame{{rear - 0.0005 + make.gap(1.0), 0, crankHeight}, {0, 1, 0}, {0, 0, 1}, {1, 0, 0}};
    const int n = make.n(48);
    // A bell, hollow from the rear; the flywheel sits in it.
    Mesh mesh = lathe(axis,
                      {{0, 0},
                       {0.118, 0},
                       {0.124, 0.006},
                       {0.136, 0.052},
                       {0.150, 0.052},
                       {0.152, 0.054},
                       {0.152, 0.062},
                       {0.130, 0.062},
                       {0.119, 0.020},
                       {0, 0.020}},
                      n);
    append(mesh, extrude(axis, gear({}, 0.109, 0.112, make.n(32)), {}, {0.030, 0.042}));
    append(mesh, lathe(axis, {{0, 0.015}, {0.030, 0.015}, {0.030, 0.035}, {0.0, 0.035}}, make.n(32)));
    append(mesh, lathe(axis,
                       {{0, 0.036},
                        {0.095, 0.036},
                        {0.095, 0.046},
                        {0.080, 0.056},
                        {0.040, 0.058},
                        {0.034, 0.048},
                        {0, 0.048}},
                       n)); // clutch
    for (int i = 0; i < 12; ++i) {
        const Vec2 e = unitCircle(2 * i + 1, 24), t{-e.y, e.x};
        // Ribs of the bell and bolts of its flange.
        const Frame rib{axis.at(0.120 * e.x, 0.120 * e.y, 0), {1, 0, 0}, {0, t.x, t.y}, {0, e.x, e.y}};
        append(
            mesh,
            roundedBox(rib, {{0.006, -0.0025}, {0.053, 0.0025}, 0, 0.021, 0.0024, 0.0015, 0.02, make.n(2)}));
        append(mesh, boltHead(axis.at(0.1455 * unitCircle(i, 12).x, 0.1455 * unitCircle(i, 12).y, 0.0528),
                              {-1, 0, 0}, 0.008));
    }
    // Starter motor beside the crankcase.
    const Frame starter{{rear - 0.125, 0.140, 0.175}, {0, 1, 0}, {0, 0, 1}, {1, 0, 0}};
    append(mesh, lathe(starter,
                       {{0, 0},
                        {0.024, 0},
                        {0.029, 0.005},
                        {0.029, 0.080},
                        {0.034, 0.084},
                        {0.034, 0.110},
                        {0.020, 0.130},
                        {0.020, 0.182},
                        {0, 0.182}},
                       make.n(32)));
    append(mesh, lathe(Frame{starter.at(0.012, 0.042, 0), starter.u, starter.v, starter.w},
                       {{0, 0.020}, {0.014, 0.020}, {0.016, 0.022}, {0.016, 0.085}, {0, 0.085}}, make.n(24)));
    append(mesh,
           roundedBox(starter, {{-0.044, -0.030}, {0.040, 0.052}, 0.165, 0.1775, 0.015, 0, 0, make.n(4)}));
    return mesh;
}

Mesh oilFilter(const Make& make) {
    const Vec3 direction = normalized(Vec3{0, -1, -0.25});
    const Frame axis = along(Vec3{0.160, -0.113, 0.212} - direction * make.bite(3), direction);
    Profile p{{0, -0.004},    {0.030, -0.004}, {0.030, 0.010}, {0.036, 0.010},
              {0.038, 0.012}, {0.038, 0.020},  {0.037, 0.022}, {0.037, 0.078}};
    const int n = make.n(6);
    for (int i = 1; i <= n; ++i) {
        const Vec2 e = unitCircle(i, 4 * n);
        p.push_back({0.029 + 0.008 * e.x, 0.078 + 0.010 * e.y});
    }
    p.push_back({0, 0.090});
    Mesh mesh = lathe(axis, p, make.n(32));
    for (int i = 0; i < 16; ++i) { // grips
        const Vec2 e = unitCircle(i, 16) * 0.0368;
        append(mesh, lathe(Frame{axis.at(e.x, e.y, 0), axis.u, axis.v, axis.w},
                           {{0, 0.056}, {0.0016, 0.057}, {0.0016, 0.076}, {0, 0.077}}, 6));
    }
    return mesh;
}

Mesh dipstick(const Make& make) {
    const Path tube = bentPath(
        {{0.470, -0.100, 0.235}, {0.470, -0.128, 0.262}, {0.478, -0.118, 0.47}, {0.470, -0.105, 0.645}}, 0.03,
        make.n(8));
    Mesh mesh = pipe(tube, 0.0048, make.n(10));
    const Vec3 d = normalized(tube.back() - tube[tube.size() - 2]);
    append(mesh,
           lathe(along(tube.back(), d),
                 {{0, -0.006}, {0.0075, -0.006}, {0.0085, 0.010}, {0.004, 0.014}, {0, 0.014}}, make.n(16)));
    const Frame ring{tube.back() + d * 0.026, {1, 0, 0}, {0, 0, 1}, {0, -1, 0}};
    Profile p;
    for (int i = 0; i < make.n(8); ++i) p.push_back(Vec2{0.012, 0} + unitCircle(i, make.n(8)) * 0.0028);
    append(mesh, lathe(ring, p, make.n(24), true));
    // Clip on the head.
    append(mesh, box({0.470, -0.1225, 0.4795}, {0.484, -0.086, 0.4835}));
    return mesh;
}

Mesh mounts(const Make& make) {
    Mesh mesh;
    for (const double side : {-1.0, 1.0}) {
        const double x = side < 0 ? 0.385 : 0.300;
        // Bracket with a window, drawn in (outwards, z).
        const Frame plane{{x, 0, 0}, {0, side, 0}, {0, 0, 1}, {side, 0, 0}};
        const double root = 0.113 - make.bite(2.5);
        const Loop2 bracket = filletedPolygon(
            {{root, 0.170}, {0.150, 0.185}, {0.198, 0.196}, {0.198, 0.212}, {0.150, 0.226}, {root, 0.230}},
            {0, 0.03, 0.004, 0.004, 0.03, 0}, make.n(5));
        append(mesh, extrude(plane, bracket, {circle({0.138, 0.205}, 0.010, make.n(20))}, {-0.022, 0.022}));
        append(mesh, lathe(upright({x, side * 0.186, 0}),
                           {{0, 0.140},
                            {0.024, 0.140},
                            {0.026, 0.143},
                            {0.024, 0.158},
                            {0.019, 0.170},
                            {0.024, 0.182},
                            {0.024, 0.195},
                            {0, 0.195}},
                           make.n(24)));
        append(mesh, boltHead({x, side * 0.186, 0.211}, {0, 0, 1}, 0.016));
    }
    return mesh;
}

} // namespace

void addEngineRest(Parts& parts, const Make& make) {
    parts.push_back({"flywheel_housing", flywheelHousing(make)});
    parts.push_back({"oil_filter", oilFilter(make)});
    parts.push_back({"dipstick_tube", dipstick(make)});
    parts.push_back({"engine_mounts", mounts(make)});
}

} // namespace i2b::samples
