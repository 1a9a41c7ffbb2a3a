// Exhaust manifold (flange, four runners, collector) and intake manifold (plenum, four runners, throttle
// body).
#include "i2b/samples/parts.h"

namespace i2b::samples {
namespace {

using namespace engine;

constexpr Vec3 collector{0.300, -0.178, 0.345}; // where the runners come in
constexpr double collectorRim = 0.006;          // height of its top above that

Mesh exhaustFlange(const Make& make) {
    // On the head's ribs and port faces; drawn in (x, z), growing towards -y.
    const Frame side{{0, -headHalf - make.gap(0.5), 0}, {1, 0, 0}, {0, 0, 1}, {0, -1, 0}};
    Mesh mesh;
    std::vector<Loop2> holes;
    for (int c = 0; c < 4; ++c) holes.push_back(circle({cylinder(c), 0.505}, 0.0175, make.n(32)));
    append(mesh, extrude(side,
                         roundedRectangle({cylinder(0) - 0.040, 0.474}, {cylinder(3) + 0.040, 0.536}, 0.018,
                                          make.n(6)),
                         holes, {0, 0.009}));
    for (int c = 0; c < 4; ++c)
        for (const Vec2 d : {Vec2{-0.028, 0.02}, Vec2{0.028, -0.02}})
            append(mesh, boltHead(side.at(cylinder(c) + d.x, 0.505 + d.y, 0.009), {0, -1, 0}, 0.011));
    return mesh;
}

Mesh exhaustRunner(const Make& make, int c) {
    // Foot in the collector: two by two.
    const Vec3 foot = collector + Vec3{c < 2 ? -0.017 : 0.017, c == 0 || c == 3 ? -0.015 : 0.015, 0};
    const double reach = c == 0 || c == 3 ? -0.030 : 0;
    const Path path = bentPath({{cylinder(c), -headHalf + make.bite(1), 0.505},
                                {cylinder(c), foot.y + reach * 0.3, 0.505},
                                {foot.x, foot.y, 0.425 + (c == 0 || c == 3 ? 0 : 0.01)},
                                foot + Vec3{0, 0, collectorRim - make.bite(3)}},
                               0.026, make.n(8));
    return pipe(path, 0.0185, make.n(18));
}

// Four into one: from an oval block over a cone to a pipe with a flange, open at its end.
Mesh exhaustCollector(const Make& make) {
    const Frame down{
        {collector.x, collector.y, collector.z + collectorRim}, {1, 0, 0}, {0, -1, 0}, {0, 0, -1}};
    const int n = make.n(6);
    const Loop2 oval = roundedRectangle({-0.040, -0.038}, {0.040, 0.038}, 0.022, n);
    const auto round = [&](double r) { return roundedRectangle({-r, -r}, {r, r}, r * 0.999, n); };
    std::vector<Section> s{{offset(oval, -0.002), 0}, {oval, 0.002}, {oval, 0.022}};
    const Loop2 exit = round(0.029);
    for (int i = 1; i <= make.n(8); ++i) { // smooth blend
        const double t = double(i) / make.n(8), b = t * t * (3 - 2 * t);
        Loop2 blend;
        for (std::size_t k = 0; k < oval.size(); ++k) blend.push_back(oval[k] * (1 - b) + exit[k] * b);
        s.push_back({blend, 0.022 + 0.060 * t});
    }
    for (const auto& [r, h] :
         {std::pair{0.029, 0.125}, {0.046, 0.125}, {0.046, 0.134}, {0.026, 0.134}, {0.026, 0.090}})
        s.push_back({round(r), h});
    return stack(down, s);
}

constexpr double plenumY = 0.215, plenumZ = 0.575, plenumRadius = 0.046, plenumFrom = 0.112, plenumTo = 0.482;

Mesh plenum(const Make& make) {
    Profile p{{0, plenumFrom}, {plenumRadius - 0.006, plenumFrom}, {plenumRadius, plenumFrom + 0.006}};
    const int n = make.n(8);
    for (int i = 1; i <= make.n(6); ++i)
        p.push_back({plenumRadius, plenumFrom + 0.006 +
                                       (plenumTo - plenumRadius * 0.6 - plenumFrom - 0.006) * i / make.n(6)});
    for (int i = 1; i < n; ++i) { // domed rear end
        const Vec2 e = unitCircle(i, 4 * n);
        p.push_back({plenumRadius * e.x, plenumTo - plenumRadius * 0.6 * (1 - e.y)});
    }
    p.push_back({0, plenumTo});
    const Frame axis{{0, plenumY, plenumZ}, {0, 1, 0}, {0, 0, 1}, {1, 0, 0}};
    Mesh mesh = lathe(axis, p, make.n(36));
    for (int i = 0; i < 6; ++i) { // stiffening ribs around
        const double x = 0.160 + 0.054 * i, r = plenumRadius;
        append(mesh, lathe(axis,
                           {{r - 0.002, x - 0.003},
                            {r + 0.003, x - 0.002},
                            {r + 0.003, x + 0.002},
                            {r - 0.002, x + 0.003}},
                           make.n(36), true));
    }
    return mesh;
}

Mesh intakeRunner(const Make& make, int c) {
    const double x = cylinder(c), y0 = headHalf + 0.006;
    const double foot = y0 + make.gap(c == 1 ? 0.6 : 0.4); // on the port's raised face
    const Path path = bentPath({{x, foot, 0.508},
                                {x, 0.165, 0.485},
                                {x, plenumY + 0.012, 0.488},
                                {x, plenumY, plenumZ - plenumRadius + 0.006 + make.bite(2)}},
                               0.026, make.n(8));
    // Upright oval at the head to round at the plenum would twist the eye more than it shows: keep one oval.
    Mesh mesh = sweep(path, roundedRectangle({-0.021, -0.017}, {0.021, 0.017}, 0.0165, make.n(4)), {0, 0, 1});
    // Foot flange.
    append(mesh, roundedBox(Frame{{x, foot, 0.508}, {0, 0, 1}, {1, 0, 0}, {0, 1, 0}},
                            {{-0.024, -0.028}, {0.024, 0.028}, 0, 0.006, 0.015, 0.001, 0, make.n(4)}));
    return mesh;
}

// A bore open to the front with the closed valve in it.
Mesh throttleBody(const Make& make) {
    const Frame forward{{plenumFrom + make.bite(2), plenumY, plenumZ}, {0, -1, 0}, {0, 0, 1}, {-1, 0, 0}};
    const int n = make.n(36);
    Mesh mesh = lathe(forward,
                      {{0, 0},
                       {0.033, 0},
                       {0.033, 0.050},
                       {0.036, 0.052},
                       {0.036, 0.058},
                       {0.034, 0.060},
                       {0.027, 0.060},
                       {0.025, 0.040},
                       {0.025, 0.012},
                       {0, 0.012}},
                      n);
    append(mesh, extrude(forward, roundedRectangle({-0.036, -0.036}, {0.036, 0.036}, 0.010, make.n(4)),
                         {circle({}, 0.0325, n)}, {0.0035, 0.011}));
    for (const double a : {-0.029, 0.029})
        for (const double b : {-0.029, 0.029})
            append(mesh, boltHead(forward.at(a, b, 0.011), forward.w, 0.009));
    const Frame motor{forward.at(0.030, 0, 0.034), {0, 0, 1}, {1, 0, 0}, {0, -1, 0}};
    append(mesh, roundedBox({motor.origin, {1, 0, 0}, {0, 0, 1}, {0, -1, 0}},
                            {{-0.017, -0.024}, {0.017, 0.024}, 0, 0.026, 0.007, 0.003, 0.04, make.n(3)}));
    append(mesh, lathe(along(forward.at(-0.030, 0, 0.034), {0, 1, 0}),
                       {{0, 0}, {0.007, 0}, {0.007, 0.010}, {0, 0.010}}, make.n(16)));
    return mesh;
}

} // namespace

void addEngineExhaust(Parts& parts, const Make& make) {
    parts.push_back({"exhaust_flange", exhaustFlange(make)});
    for (int c = 0; c < 4; ++c)
        parts.push_back({"exhaust_runner_" + std::to_string(c + 1), exhaustRunner(make, c)});
    parts.push_back({"exhaust_collector", exhaustCollector(make)});
}

void addEngineIntake(Parts& parts, const Make& make) {
    parts.push_back({"intake_plenum", plenum(make)});
    for (int c = 0; c < 4; ++c)
        parts.push_back({"intake_runner_" + std::to_string(c + 1), intakeRunner(make, c)});
    parts.push_back({"throttle_body", throttleBody(make)});
}

} // namespace i2b::samples
