// The built-in geometries: written by the program itself, the same to the last bit on every IEEE machine.
//
// engine   A four-cylinder automobile engine in 32 parts, about 0.6 x 0.5 x 0.7 m; x runs from the pulley to the flywheel,
//          z is up, the crankshaft's axis is y = 0, z = 0.21. Its outside is closed for cells of 2 mm and more, its water
//          jacket (seed "jacket") for cells of 3 mm and more, at dirt <= 1. At dirt > 0 it has:
//            cracks       0.2 to 1 mm times dirt between parts, hidden faces missing behind them
//            overlaps     parts that run 1 to 3 mm (times dirt) and more into one another without a shared edge
//            ribs         sheets glued to a wall: edges shared by three triangles
//            borders      open on both sides with different tessellations (the lid of the water jacket)
//            soup         triangles twice, some reversed, whole parts inside out, triangles of no area
//            stray sheet  in the flow beside the exhaust manifold
// missile  Ogive nose, cylinder, boat tail and four sharp fins, 2 m long, along x, nose at the origin; parts body and
//          fin_1 .. fin_4. Dirty: cracks at the nose and under two fins, deeper roots of the others.
// wing-body  An aircraft of 17 structured patches, each a part, as PLOT3D files bring them: 2 m long along x, nose at the
//          origin, span 1.9 m along y, fin upwards. Dirty: neighbours differ in their counts of points along a shared
//          border, and overlap or gape by a fraction of their cells, up to 3 mm times dirt: closed for cells of 6 mm and
//          more. Clean: they share the border's points. The roots of wings and fin lie open inside the body.
// tunnel   S-bent duct along x, 2 m long, 0.3 m square at the inlet, 0.2 m round at the outlet; parts wall, inlet and
//          outlet, closed together (seed "inside"). Dirty: both end faces cut differently and 0.5 mm away.
// box      The unit cube, sphere: the unit-diameter sphere about the origin (icosphere). Clean at any dirt.
#pragma once
#include "i2b/geometry/surface.h"
#include <optional>
#include <string>
#include <vector>

namespace i2b {

struct SampleOptions {
    double dirt = 1;    // scales cracks and overlaps; 0: the clean twin, each part a closed shell (not: tunnel's, wing-body's)
    int resolution = 1; // 1 to 8; multiplies the segments along curves
};

std::vector<std::string> sampleNames();

// Error (usage) for an unknown name, a negative dirt or a resolution out of range.
Surface makeSample(const std::string& name, const SampleOptions& options = {});

// A good point to paint from: engine "jacket", tunnel "inside", else nothing.
std::optional<Vec3> sampleSeed(const std::string& name, const std::string& region);

} // namespace i2b
