// Valve cover, oil filler cap, oil pan, timing cover: thin lids on the castings.
#include "i2b/samples/parts.h"

namespace i2b::samples {
namespace {

using namespace engine;

// A flange, then walls with draft and a fillet at the far rim: growing along w from its open side.
std::vector<Section> lid(const RoundedBox& flange, const RoundedBox& body) {
    std::vector<Section> sections = sectionsOf(flange);
    for (Section& s : sectionsOf(body)) sections.push_back(std::move(s));
    return sections;
}

Mesh valveCover(const Make& make) {
    const double z = headTop + make.gap(0.5);
    const int n = make.n(5);
    const RoundedBox flange{{0.088, -0.080}, {0.504, 0.080}, z, z + 0.008, 0.022, 0.0015, 0, n};
    const RoundedBox body{{0.099, -0.069}, {0.493, 0.069}, z + 0.008, z + 0.062, 0.022, 0.012, 0.12, n};
    Mesh mesh =
        stack(upright({}), lid(flange, body), {!make.dirty(), true}); // dirty: open on the head's side
    for (int i = 0; i < 4; ++i)                                       // ribs along the top
        for (const double side : {-1.0, 1.0}) {
            const double y = side * (0.028 + 0.0085 * i);
            append(mesh, roundedBox(upright({}), {{0.13 + 0.004 * i, y - 0.0022},
                                                  {0.465 - 0.004 * i, y + 0.0022},
                                                  z + 0.055,
                                                  z + 0.0665,
                                                  0.0021,
                                                  0.0015,
                                                  0.05,
                                                  make.n(2)}));
        }
    for (int c = 0; c < 4; ++c) { // ignition coils
        const double x = cylinder(c);
        append(mesh, roundedBox(upright({}), {{x - 0.016, -0.018},
                                              {x + 0.016, 0.022},
                                              z + 0.057,
                                              z + 0.079,
                                              0.006,
                                              0.003,
                                              0.03,
                                              make.n(3)}));
        append(mesh,
               roundedBox(
                   upright({}),
                   {{x - 0.010, 0.015}, {x + 0.010, 0.040}, z + 0.0625, z + 0.0745, 0.002, 0, 0, make.n(1)}));
        append(mesh, boltHead({x, -0.010, z + 0.079}, {0, 0, 1}, 0.010));
    }
    for (int i = 0; i < 6; ++i)
        for (const double y : {-0.0745, 0.0745})
            append(mesh, boltHead({0.116 + 0.072 * i, y, z + 0.008}, {0, 0, 1}, 0.009));
    return mesh;
}

Mesh fillerCap(const Make& make) {
    const Vec2 centre{cylinder(0) - 0.030, 0.046};
    const double z = headTop + 0.060 - make.bite(2);
    Mesh mesh = lathe(upright({centre.x, centre.y, 0}),
                      {{0, z - 0.001}, {0.019, z - 0.001}, {0.019, z + 0.012}, {0, z + 0.012}}, make.n(32));
    const Loop2 knurls = gear(centre, 0.0215, 0.0235, make.n(16));
    append(mesh, stack(upright({}), {{knurls, z + 0.010},
                                     {knurls, z + 0.024},
                                     {gear(centre, 0.0195, 0.0215, make.n(16)), z + 0.026}}));
    append(mesh, roundedBox(upright({}), {{centre.x - 0.017, centre.y - 0.004},
                                          {centre.x + 0.017, centre.y + 0.004},
                                          z + 0.024,
                                          z + 0.033,
                                          0.003,
                                          0.002,
                                          0.05,
                                          make.n(3)}));
    return mesh;
}

// Grows downwards: v is turned round with w. A shallow tray with a deep sump at the rear.
Mesh oilPan(const Make& make) {
    const Frame down{{0, 0, panTop - make.gap(0.8)}, {1, 0, 0}, {0, -1, 0}, {0, 0, -1}};
    const int n = make.n(5);
    const RoundedBox flange{{front + 0.002, -0.120}, {rear - 0.002, 0.120}, 0, 0.007, 0.014, 0.001, 0, n};
    const RoundedBox tray{
        {front + 0.014, -0.108}, {rear - 0.014, 0.108}, 0.007, 0.066, 0.020, 0.014, 0.18, n};
    Mesh mesh = stack(down, lid(flange, tray), {!make.dirty(), true});
    append(mesh, roundedBox(down, {{0.290, -0.094}, {0.482, 0.094}, 0.040, 0.140, 0.022, 0.016, 0.12, n}));
    for (int i = 0; i < 7; ++i) // cooling fins under the sump
        append(mesh, roundedBox(down, {{0.325 + 0.0195 * i - 0.002, -0.058},
                                       {0.325 + 0.0195 * i + 0.002, 0.058},
                                       0.135,
                                       0.147,
                                       0.0019,
                                       0.001,
                                       0.05,
                                       make.n(2)}));
    for (int i = 0; i < 7; ++i)
        for (const double y : {-0.1135, 0.1135})
            append(mesh, boltHead(down.at(0.115 + 0.060 * i, y, 0.007), {0, 0, -1}, 0.0085));
    append(mesh,
           lathe(along(down.at(0.474, 0, 0.115), {1, 0, -0.12}),
                 {{0, -0.006}, {0.013, -0.006}, {0.013, 0.004}, {0.011, 0.005}, {0, 0.005}}, make.n(24)));
    append(mesh, boltHead(down.at(0.479, 0, 0.1156), {1, 0, -0.12}, 0.017)); // drain plug
    return mesh;
}

Mesh timingCover(const Make& make) {
    // Grows towards -x; the outline is drawn in (-y, z) so that it stays counterclockwise.
    const Frame forward{{front - make.gap(0.3), 0, 0}, {0, -1, 0}, {0, 0, 1}, {-1, 0, 0}};
    const Loop2 outline = filletedPolygon({{-0.103, 0.162},
                                           {0.103, 0.162},
                                           {0.103, 0.228},
                                           {0.068, 0.29},
                                           {0.068, 0.552},
                                           {-0.068, 0.552},
                                           {-0.068, 0.29},
                                           {-0.103, 0.228}},
                                          {0.024, 0.024, 0.03, 0.03, 0.03, 0.03, 0.03, 0.03}, make.n(6));
    const Loop2 body = offset(outline, -0.011);
    std::vector<Section> sections{
        {outline, 0}, {outline, 0.006}, {body, 0.006}, {offset(body, -0.001), 0.018}};
    for (int i = 1; i <= make.n(4); ++i) {
        const Vec2 e = unitCircle(i, 4 * make.n(4));
        sections.push_back({offset(body, -0.001 - 0.006 * (1 - e.x)), 0.018 + 0.006 * e.y});
    }
    Mesh mesh = stack(forward, sections, {!make.dirty(), true});
    // Crankshaft seal and cam wheel bulges.
    append(mesh, lathe(Frame{forward.at(0, crankHeight, 0.020), forward.u, forward.v, forward.w},
                       {{0, 0}, {0.040, 0}, {0.036, 0.010}, {0.024, 0.012}, {0, 0.012}}, make.n(32)));
    for (const double y : {-0.026, 0.026})
        append(mesh, lathe(Frame{forward.at(y, 0.510, 0.020), forward.u, forward.v, forward.w},
                           {{0, 0}, {0.027, 0}, {0.026, 0.007}, {0.022, 0.0095}, {0, 0.010}}, make.n(32)));
    for (std::size_t i = 0; i < outline.size(); i += std::size_t(make.n(4))) { // bolts along the flange
        const Vec2 p = offset(outline, -0.0055)[i];
        append(mesh, boltHead(forward.at(p.x, p.y, 0.006), forward.w, 0.008));
    }
    for (const double y : {-0.045, 0.0, 0.045}) // ribs
        append(mesh,
               roundedBox(
                   forward,
                   {{y - 0.002, 0.30}, {y + 0.002, 0.47}, 0.020, 0.0275, 0.0019, 0.001, 0.05, make.n(2)}));
    return mesh;
}

} // namespace

void addEngineCovers(Parts& parts, const Make& make) {
    parts.push_back({"valve_cover", valveCover(make)});
    parts.push_back({"oil_filler_cap", fillerCap(make)});
    parts.push_back({"oil_pan", oilPan(make)});
    parts.push_back({"timing_cover", timingCover(make)});
}

} // namespace i2b::samples
