// The water jacket: a scalloped volume around the four bores, with one bore for the coolant in and one out.
//
//      ____________________________        The bores grow out of the jacket's wall, run inside the coolant
//      pipes
//     (  o    o  | o    o  )=====> outlet  (cups, closed at the far end) and end at the plugs jacket_inlet
//     and
//      `--------||---------'               jacket_outlet.
//               || inlet
#include "i2b/samples/parts.h"

namespace i2b::samples {
namespace {

using namespace engine;

constexpr double jacketBottom = 0.315, jacketTop = 0.432;

// Union of four circles: points of each circle that lie outside of the others, and the crossings between.
Loop2 scalloped(double radius, int n) {
    const double half = (cylinder(1) - cylinder(0)) / 2, cusp = std::sqrt(radius * radius - half * half);
    Loop2 loop;
    const auto arc = [&](int c, int from, int to) {
        for (int i = from; i <= to; ++i) {
            const Vec2 e = unitCircle(i, n) * radius;
            const bool leftOpen = c == 0 || e.x > -half * 0.98, rightOpen = c == 3 || e.x < half * 0.98;
            if (leftOpen && rightOpen) loop.push_back({cylinder(c) + e.x, e.y});
        }
    };
    for (int c = 0; c < 4; ++c) { // below, towards +x
        arc(c, n / 2 + (c == 0 ? 0 : 1), c == 3 ? n : n - 1);
        if (c < 3) loop.push_back({cylinder(c) + half, -cusp});
    }
    for (int c = 3; c >= 0; --c) { // above, back
        arc(c, 1, n / 2 - 1);
        if (c > 0) loop.push_back({cylinder(c) - half, cusp});
    }
    return loop;
}

Mesh jacket(const Make& make) {
    const double z0 = jacketBottom, z1 = jacketTop;
    const int rows = make.n(16), n = make.n(64);
    const Loop2 outline = scalloped(jacketOuter, n);
    Mesh walls = extrude(upright({}), outline, boreCircles(jacketInner, make.n(48)), levels(z0, z1, rows),
                         {true, !make.dirty()});
    for (const Path& path : {coolantOutlet(make), coolantInlet(make)})
        openWall(walls, outline, levels(z0, z1, rows), 0.016, trimmed(path, 0.006), 0.013, !make.dirty());
    if (make.dirty()) { // a lid with other segments, 0.4 mm above the open rim
        Mesh lid =
            extrude(upright({}), scalloped(jacketOuter, make.n(60)), boreCircles(jacketInner, make.n(40)),
                    {z1 - 0.001, z1 + make.gap(0.4)}, {false, true});
        drop(lid, [&](const Vec3&, const Vec3& normal) { return normal.z < 0.5; });
        append(walls, lid);
    }
    return walls;
}

// A disc that closes the bore's end. Clean: 2 mm into the bore; dirty: 0.25 mm short of it.
Mesh plug(const Make& make, const Path& path) {
    const Path end = trimmed(path, 0.006);
    const double start = make.dirty() ? make.gap(0.25) : -0.002;
    return lathe(along(end.back(), end.back() - end[end.size() - 2]),
                 {{0, start}, {0.0145, start}, {0.0145, 0.004}, {0, 0.004}}, make.n(32));
}

// A thick pipe about the bore, closed beyond the plug, with a hose and its clamp over the end.
Mesh coolantPipe(const Make& make, const Path& path) {
    const int n = make.n(20);
    Path longer = path;
    longer.back() += normalized(path.back() - path[path.size() - 2]) * 0.006;
    std::vector<Ring> rings = sweepRings(path, circle({}, 0.0155, n), {0.1, 0.2, 1});
    std::reverse(rings.begin(), rings.end());
    for (const Ring& r : sweepRings(longer, circle({}, 0.0185, n), {0.1, 0.2, 1})) rings.push_back(r);
    Mesh mesh = loft(rings);
    const Vec3 d = normalized(path.back() - path[path.size() - 2]);
    for (const double back : {0.006, 0.022}) // hose clamps
        append(mesh, lathe(along(path.back() - d * back, d),
                           {{0.0178, -0.004}, {0.0205, -0.004}, {0.0205, 0.004}, {0.0178, 0.004}}, n, true));
    return mesh;
}

} // namespace

void addEngineJacket(Parts& parts, const Make& make) {
    parts.push_back({"water_jacket", jacket(make)});
    parts.push_back({"jacket_inlet", plug(make, coolantInlet(make))});
    parts.push_back({"jacket_outlet", plug(make, coolantOutlet(make))});
    Mesh pipes = coolantPipe(make, coolantInlet(make));
    append(pipes, coolantPipe(make, coolantOutlet(make)));
    // A flange where each leaves the block.
    append(pipes, extrude(Frame{{cylinder(1), 0.0715, 0.350}, {1, 0, 0}, {0, 0, -1}, {0, 1, 0}},
                          roundedRectangle({-0.034, -0.022}, {0.034, 0.022}, 0.016, make.n(5)),
                          {circle({}, 0.0180, make.n(28))}, {0, 0.007}));
    append(pipes, extrude(lengthwise(rear - 0.0005),
                          roundedRectangle({-0.034, 0.383}, {0.034, 0.427}, 0.016, make.n(5)),
                          {circle({0, 0.405}, 0.0180, make.n(28))}, {0, 0.007}));
    parts.push_back({"coolant_pipes", pipes});
}

} // namespace i2b::samples
