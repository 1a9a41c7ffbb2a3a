// Points at which two faces may share points as they should not: a filter, so that only there all faces of a point are listed.
#pragma once
#include "i2b/assemble/poly_mesh.h"
#include <cstdint>
#include <vector>

namespace i2b {

struct OddPoints {
    std::vector<std::uint8_t> marks; // per point
    bool isAnyTwice = false;         // has a face a point twice? Then all are marked
};

// Two faces that have the same points, or share some that do not follow each other on both outlines, share two points that are no edge of
// one of them but a diagonal of it; or they are the same triangle; or one has a point twice. So a point is marked where a diagonal to a
// higher point is that of another face, or an edge of one, too; and where two triangles with this point for their lowest are the same. A
// few others may be marked.
OddPoints oddPoints(const PolyMesh& mesh);

} // namespace i2b
