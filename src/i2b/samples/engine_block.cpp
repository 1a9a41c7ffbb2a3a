// The engine's castings: block, crankcase, water jacket, gasket, head, valve cover, oil pan.
#include "i2b/samples/dirt.h"
#include "i2b/samples/parts.h"

namespace i2b::samples {
namespace {

using namespace engine;

Mesh block(const Make& make) {
    const double bottom = crankcaseTop + make.gap(0.6);
    const Loop2 outline = subdivided(roundedRectangle({front, -0.072}, {rear, 0.072}, 0.004, make.n(3)),
                                     0.013 / make.resolution);
    const int rows = make.n(8);
    // In the dirty twin the bottom face, hidden on the crankcase, is missing: a hollow casting behind a
    // crack.
    Mesh mesh = extrude(upright({}), outline, boreCircles(bore, make.n(40)), levels(bottom, deck, rows),
                        {!make.dirty(), true});
    if (make.dirty())
        for (int c = 0; c < 4; ++c) { // rib sheets on the intake side
            const std::uint32_t i = nearest(outline, {cylinder(c) + 0.048, 0.072});
            std::vector<std::uint32_t> chain;
            for (int l = 1; l < rows; ++l)
                chain.push_back(std::uint32_t(l) * std::uint32_t(outline.size()) + i);
            addRib(mesh, chain, {0, 0.012, 0});
        }
    for (Path path : {coolantInlet(make), coolantOutlet(make)}) { // spigots about the jacket's two bores
        path.front() += normalized(path[1] - path[0]) * 0.009;
        openWall(mesh, outline, levels(bottom, deck, rows), 0.0155, trimmed(path, 0.001), 0.0152, true);
    }
    for (int c = 0; c < 5; ++c) // cast ribs between the cylinders, on the exhaust side, with draft
        append(mesh, roundedBox(Frame{{0, -0.0705, 0}, {1, 0, 0}, {0, 0, 1}, {0, -1, 0}},
                                {{cylinder(c) - 0.054, bottom + 0.006},
                                 {cylinder(c) - 0.042, deck - 0.006},
                                 0,
                                 0.011,
                                 0.003,
                                 0.002,
                                 0.1,
                                 make.n(2)}));
    for (int c = 0; c < 4; ++c) // core plugs
        append(mesh, lathe(along({cylinder(c), -0.0712, 0.345}, {0, -1, 0}),
                           {{0, 0}, {0.019, 0}, {0.019, 0.004}, {0.016, 0.004}, {0.014, 0.0022}, {0, 0.0022}},
                           make.n(24)));
    for (int c = 0; c < 5; ++c) // bosses of the head bolts, half in the wall
        for (const double y : {-0.070, 0.070})
            append(mesh, lathe(upright({cylinder(c) - 0.048 +
                                            (c == 0   ? 0.006
                                             : c == 4 ? -0.006
                                                      : 0),
                                        y, 0}),
                               {{0, deck - 0.05},
                                {0.004, deck - 0.0495},
                                {0.0095, deck - 0.035},
                                {0.0095, deck - 0.0012},
                                {0, deck - 0.0012}},
                               make.n(12)));
    return mesh;
}

Mesh crankcase(const Make& make) {
    const double x0 = front + 0.0005, x1 = rear - 0.0005;
    const std::vector<Vec2> corners{
        {-0.122, panTop}, {0.122, panTop}, {0.122, panTop + 0.012},  {0.113, panTop + 0.014},
        {0.113, 0.232},   {0.080, 0.275},  {0.080, crankcaseTop},    {-0.080, crankcaseTop},
        {-0.080, 0.275},  {-0.113, 0.232}, {-0.113, panTop + 0.014}, {-0.122, panTop + 0.012}};
    const std::vector<double> radii{0, 0, 0.002, 0, 0.03, 0.006, 0, 0, 0.006, 0.03, 0, 0.002};
    Mesh mesh =
        extrude(lengthwise(0), filletedPolygon(corners, radii, make.n(6)), {}, levels(x0, x1, make.n(8)));
    for (int c = 0; c < 5; ++c) // webs at the main bearings
        for (const double side : {-1.0, 1.0}) {
            const double x = cylinder(c) - 0.048 + (c == 0 ? 0.012 : c == 4 ? -0.012 : 0);
            Loop2 web{{0.085, panTop + 0.006},
                      {0.119, panTop + 0.006},
                      {0.119, 0.225},
                      {0.083, 0.283},
                      {0.0745, 0.283}};
            for (Vec2& p : web) p.x *= side;
            if (side < 0) std::reverse(web.begin(), web.end());
            append(mesh, extrude(lengthwise(x), web, {}, {-0.004, 0.004}));
        }
    for (int i = 0; i < 7; ++i) // flange bolts, heads up
        for (const double y : {-0.1185, 0.1185})
            append(mesh, boltHead({0.125 + 0.058 * i, y, panTop + 0.0128}, {0, 0, 1}, 0.008));
    return mesh;
}

Mesh gasket(const Make& make) {
    return extrude(
        upright({}), roundedRectangle({front - 0.0015, -0.0735}, {rear + 0.0015, 0.0735}, 0.004, make.n(4)),
        boreCircles(bore + 0.001, make.n(36)), {deck + make.gap(0.2), headBottom - 0.001 - make.gap(0.1)});
}

// Ports of the head: a raised face each, round on the exhaust side, upright oval on the intake side.
void addPortFaces(Mesh& mesh, const Make& make) {
    for (int c = 0; c < 4; ++c) {
        const Frame in{{cylinder(c), headHalf - 0.004, 0.508}, {0, 0, 1}, {1, 0, 0}, {0, 1, 0}};
        append(mesh,
               roundedBox(in, {{-0.027, -0.031}, {0.027, 0.031}, 0, 0.010, 0.020, 0.002, 0.05, make.n(5)}));
        for (const double d : {-1.0, 1.0})
            append(mesh, boltHead(in.at(0.019 * d, 0.0245 * d, 0.010), {0, 1, 0}, 0.009));
    }
}

Mesh head(const Make& make) {
    const double h = headHalf;
    const std::vector<Vec2> corners{{-0.084, headBottom}, {0.084, headBottom}, {h, 0.462},  {h, 0.543},
                                    {0.084, headTop},     {-0.084, headTop},   {-h, 0.543}, {-h, 0.462}};
    Mesh mesh =
        extrude(lengthwise(0), filletedPolygon(corners, {0, 0, 0.004, 0.010, 0, 0, 0.010, 0.004}, make.n(5)),
                {}, levels(front + 0.0003, rear - 0.0003, make.n(6)));
    addPortFaces(mesh, make);
    for (int c = 0; c < 5; ++c) // water core plugs and ribs between the exhaust ports
        append(mesh, roundedBox(Frame{{0, -h + 0.001, 0}, {1, 0, 0}, {0, 0, 1}, {0, -1, 0}},
                                {{cylinder(c) - 0.052, 0.458},
                                 {cylinder(c) - 0.044, 0.548},
                                 0,
                                 0.007,
                                 0.003,
                                 0.0015,
                                 0.1,
                                 make.n(2)}));
    for (const double y : {-0.055, 0.055}) // rear: plugs of the camshaft bores
        append(mesh, lathe(along({rear - 0.001, y, 0.538}, {1, 0, 0}),
                           {{0, 0}, {0.017, 0}, {0.017, 0.005}, {0.013, 0.005}, {0.011, 0.003}, {0, 0.003}},
                           make.n(24)));
    // Lifting eye.
    append(mesh, extrude(lengthwise(rear - 0.0015),
                         filletedPolygon({{-0.02, 0.465}, {0.02, 0.465}, {0.016, 0.60}, {-0.016, 0.60}},
                                         {0.004, 0.004, 0.015, 0.015}, make.n(6)),
                         {circle({0, 0.583}, 0.009, make.n(20))}, {0, 0.005}));
    return mesh;
}

} // namespace

void addEngineBlock(Parts& parts, const Make& make) {
    parts.push_back({"cylinder_block", block(make)});
    parts.push_back({"crankcase", crankcase(make)});
    parts.push_back({"head_gasket", gasket(make)});
    parts.push_back({"cylinder_head", head(make)});
}

} // namespace i2b::samples
