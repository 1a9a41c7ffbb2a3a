// How much of a set of lines of the geometry the wall has: samples are taken every h/4 along them, where the wall comes
// within h/2 and where the line is resolvable (fit_report.h); whoever asks says what it takes to have captured one.
#pragma once
#include "i2b/quality/fit_wall.h"
#include <functional>
#include <optional>

namespace i2b {

// The wall nearest to a sample.
struct WallPlace {
    std::int32_t face = -1; // place in Wall::faces
    double h = 0;           // m, the face's size
    double distance = 0;    // m
    Vec3 point;             // m
};

struct LostSample {
    Vec3 point;             // m
    std::uint32_t line = 0; // its triangle of the lines
    WallPlace at;
};

struct LineSamples {
    std::int64_t samples = 0;
    std::vector<LostSample> lost; // of these, those not captured, in the order of the lines
    double captured() const { return samples > 0 ? 1 - static_cast<double>(lost.size()) / static_cast<double>(samples) : 1; } // share
};

// Asked of a sample, m, and the triangle without area of its line; on any thread.
using LineAsk = std::function<bool(const Vec3& sample, std::uint32_t line, const WallPlace& at)>;

// lines: segments as triangles without area, and an index of them; none give no samples. counts: asked last of all that
// decides whether a sample is one; isCaptured: of these. The same on any number of threads.
LineSamples captureLines(const PolyMesh& mesh, const Wall& wall, const Surface& lines, const SurfaceIndex& lineIndex, const LineAsk& counts,
                         const LineAsk& isCaptured);

// A place in the flow, so many m over the nearest wall: over the inside of its face, since over the rim may be another part.
Vec3 flowOver(const Wall& wall, const WallPlace& at, double height);
// Whether nothing of the geometry is in the way from the flow to a place, but for the last bit (m).
bool isSeenFrom(const SurfaceIndex& index, const Vec3& flow, const Vec3& place, double lastBit);

// The first of two places in the flow, 0.3 h and h over the nearest wall, from which a sample is seen or lies less than 0.05 h behind what is.
std::optional<Vec3> flowThatSees(const Wall& wall, const SurfaceIndex& index, const WallPlace& at, const Vec3& sample);

// Appends a segment as a triangle without area, which a SurfaceIndex takes like any other.
void addSegment(Surface& s, const Vec3& a, const Vec3& b);

} // namespace i2b
