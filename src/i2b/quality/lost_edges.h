// Where the wall has missed the geometry's sharp edges: samples of them that are not captured (fit_report.h), in places.
//
// A place is a set of samples that hang together, each within h/2 of another; its cause is that of most of them. Order: longest first, then
// as the samples lie.
#pragma once
#include "i2b/geometry/surface_index.h"
#include "i2b/quality/fit_report.h"
#include "i2b/quality/line_capture.h"

namespace i2b {

// What the wall is like at a sample; lines: as for captureLines(), which gave it.
LostCause causeOf(const LostSample& sample, const PolyMesh& mesh, const Wall& wall, const Surface& lines);

// causes: one for each sample. At most `most` places are kept. index: of the geometry. The same on any number of threads.
LostEdges gatherLostEdges(const std::vector<LostSample>& samples, const std::vector<LostCause>& causes, const SurfaceIndex& index, std::size_t most = 100);

} // namespace i2b
