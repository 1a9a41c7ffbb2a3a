// Zips all rims that can be (rim_zips.h): all at once, for one at a time would leave slivers beside it; columns around those that leave
// something worse are moved (shape_zip.h), and those where that does not help are opened again, of those side by side the worst first.
#pragma once
#include "i2b/rims/rim_zips.h"

namespace i2b {

// Leaves star as it is with the zips that stay; their number. The same on any number of threads.
std::int64_t zipRims(ZipStar& star, const PolyMesh& mesh, const Rows& cellFaces, const Wall& wall, const Front& front, const SurfaceIndex& index, const FeatureIndex& rims,
                     const DictionaryLimits& limits, std::int32_t firstLayerCell);

} // namespace i2b
