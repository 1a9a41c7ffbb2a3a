// What makes the parts of each sample, before they become one Surface.
#pragma once
#include "i2b/samples/builder.h"
#include "i2b/samples/sample.h"

namespace i2b::samples {

using Parts = std::vector<NamedPart>;

// How the parts of a sample meet, and how finely curves are cut.
struct Make {
    double dirt = 1;
    int resolution = 1;

    bool dirty() const { return dirt > 0; }
    // Distance between two parts that butt: a crack of so many mm, or (clean) an overlap of 0.5 mm.
    double gap(double mm) const { return dirty() ? 1e-3 * mm * dirt : -0.5e-3; }
    // How deep a part runs into its neighbour.
    double bite(double mm) const { return dirty() ? 1e-3 * mm * dirt : 1e-3; }
    int n(int segments) const { return segments * resolution; }
};

Parts boxParts(const Make& make);
Parts sphereParts(const Make& make);
Parts tunnelParts(const Make& make);
Parts missileParts(const Make& make);
Parts wingBodyParts(const Make& make);
Parts engineParts(const Make& make);

// The groups of the engine.
void addEngineBlock(Parts& parts, const Make& make);  // block, crankcase, gasket, head
void addEngineJacket(Parts& parts, const Make& make); // water jacket, its ends, coolant pipes
void addEngineCovers(Parts& parts, const Make& make); // valve cover, filler cap, oil pan, timing cover
void addEngineDrive(Parts& parts, const Make& make);  // pulley, pump, alternator, belt
void addEngineExhaust(Parts& parts, const Make& make);
void addEngineIntake(Parts& parts, const Make& make);
void addEngineRest(Parts& parts, const Make& make); // flywheel housing, filter, dipstick, mounts

// Dimensions that several groups share.
namespace engine {
constexpr double crankHeight = 0.21, front = 0.080, rear = 0.512;
constexpr double panTop = 0.155, crankcaseTop = 0.285, deck = 0.445, headBottom = 0.4475, headTop = 0.56;
constexpr double bore = 0.040, jacketInner = 0.044, jacketOuter = 0.062;
constexpr double headHalf = 0.088; // half the head's width
constexpr double cylinder(int i) { return 0.152 + 0.096 * i; }

// The four bores in plan view, n points each.
std::vector<Loop2> boreCircles(double radius, int n);

// Axes of the coolant bores, from inside the block's wall to 2 mm beyond the plug that closes each.
Path coolantInlet(const Make& make);
Path coolantOutlet(const Make& make);
// The path less its last `d`; its last straight piece must be longer.
Path trimmed(Path path, double d);

// Grows a pipe of `radius` along the path out of the side wall of an upright extrusion (outline, heights),
// through a hole of at least `half` to each side of the path's first point.
void openWall(Mesh& mesh, const Loop2& outline, const std::vector<double>& heights, double half,
              const Path& path, double radius, bool capped);
} // namespace engine

} // namespace i2b::samples
