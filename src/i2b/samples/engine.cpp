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
