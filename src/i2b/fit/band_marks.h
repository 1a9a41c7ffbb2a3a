// Which cells and points of the lattice mesh belong to the band: rings around the front.
#pragma once
#include "i2b/front/lattice_mesh.h"
#include <cstdint>
#include <vector>

namespace i2b {

// 0: not in the band; else 1 + ring, by number in the LatticeMesh. Points of ring 0 are those of the front; a cell has the
// lowest ring of its points.
struct BandMarks {
    std::vector<std::uint8_t> cells, points;
};

BandMarks markBand(const LatticeMesh& mesh, int rings);

} // namespace i2b
