// The engine's parts, put together and dirtied. Coordinates: see sample.h.
#include "i2b/samples/dirt.h"
#include "i2b/samples/parts.h"

namespace i2b::samples {
namespace {

Mesh& meshOf(Parts& parts, const std::string& name) {
    return std::find_if(parts.begin(), parts.end(), [&](const NamedPart& p) { return p.name == name; })->mesh;
}

// The faults that do not depend on how a part is built. Cracks, overlaps, open borders and ribs are the
// builders'.
void addSoup(Parts& parts) {
    duplicateSome(meshOf(parts, "cylinder_head"), 9);
    duplicateSome(meshOf(parts, "timing_cover"), 17);
    flipSome(meshOf(parts, "alternator"), 1);
    flipSome(meshOf(parts, "intake_runner_3"), 1);
    flipSome(meshOf(parts, "valve_cover"), 7);
    addZeroArea(meshOf(parts, "oil_pan"), 8);
    addZeroArea(meshOf(parts, "intake_plenum"), 6);
    // A forgotten sheet beside the exhaust manifold, clear of everything by 15 mm and more.
    const Frame place{{0.10, -0.232, 0.37}, {1, 0, 0}, {0, 0, 1}, {0, -1, 0}};
    append(meshOf(parts, "exhaust_collector"), sheet(place, 0.12, 0.08, 0.006, 12, 8));
}

} // namespace

std::vector<Loop2> engine::boreCircles(double radius, int n) {
    std::vector<Loop2> holes;
    for (int c = 0; c < 4; ++c) holes.push_back(circle({cylinder(c), 0}, radius, n));
    return holes;
}

Path engine::coolantInlet(const Make& make) {
    return bentPath(
        {{cylinder(1), 0.066, 0.350}, {cylinder(1), 0.118, 0.350}, {cylinder(1) - 0.05, 0.135, 0.29}}, 0.03,
        make.n(8));
}
Path engine::coolantOutlet(const Make& make) {
    return bentPath({{0.506, 0, 0.405}, {0.548, 0, 0.405}, {0.556, 0, 0.47}, {0.556, 0, 0.50}}, 0.026,
                    make.n(8));
}

Path engine::trimmed(Path path, double d) {
    path.back() -= normalized(path.back() - path[path.size() - 2]) * d;
    return path;
}

void engine::openWall(Mesh& mesh, const Loop2& outline, const std::vector<double>& heights, double half,
                      const Path& path, double radius, bool capped) {
    const std::size_t n = outline.size();
    const Vec3 from = path.front(), across = normalized(cross(path[1] - from, {0, 0, 1}));
    const auto side = [&](std::size_t i) { // of an outline point, along the wall
        return dot(Vec3{outline[i % n].x - from.x, outline[i % n].y - from.y, 0}, across);
    };
    const std::size_t middle = nearest(outline, {from.x, from.y}) + n;
    std::size_t i0 = middle, i1 = middle, l0 = 0, l1 = heights.size() - 1;
    while (std::abs(side(i0)) < half) --i0;
    while (std::abs(side(i1)) < half) ++i1;
    while (heights[l0 + 1] <= from.z - half) ++l0;
    while (heights[l1 - 1] >= from.z + half) --l1;
    growPipe(mesh, perforate(mesh, n, l0, l1, i0 % n, i0 % n + (i1 - i0)), path, radius, capped);
}

Parts engineParts(const Make& make) {
    Parts parts;
    addEngineBlock(parts, make);
    addEngineJacket(parts, make);
    addEngineCovers(parts, make);
    addEngineDrive(parts, make);
    addEngineExhaust(parts, make);
    addEngineIntake(parts, make);
    addEngineRest(parts, make);
    if (make.dirty()) addSoup(parts);
    return parts;
}

} // namespace i2b::samples
