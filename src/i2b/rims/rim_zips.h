// Which faces of the wall before the rims of sheets may go, and what their cells become (zip_star.h). Before a rim runs a strip of
// faces whose two rows of nodes want the same line. Nodes across the strip are made one where a front edge joins them; between such
// pairs lies a group of faces. All nodes around it are put on the rim, in one order; edges are led through nodes of the other row; the
// cells over the group's faces, which share no edge of the rim, become one in each layer: a wedge. (Divided, they would have sides from one
// row to the other, twisted by a right angle.)
#pragma once
#include "i2b/edit/zip_star.h"

namespace i2b {

class FeatureIndex;
class SurfaceIndex;
struct Front;
struct Wall;

// index: of the geometry; rims: its rims alone; firstLayerCell: cells from there on are layers. Zips in the order of their first faces.
std::vector<Zip> findRimZips(const PolyMesh& mesh, const Rows& cellFaces, const ZipStar& star, const Wall& wall, const Front& front, const SurfaceIndex& index, const FeatureIndex& rims,
                                std::int32_t firstLayerCell);

} // namespace i2b
