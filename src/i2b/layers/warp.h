// Thin layers over warped faces of the wall.
#pragma once
#include "i2b/front/front.h"
#include "i2b/geometry/surface_index.h"
#include "i2b/layers/layer_stack.h"
#include <span>

namespace i2b {

// Cuts faces of the wall that are too warped for the layers of the stack on them; wall and front alike, so that each piece
// has a stack of its own. Gives how many were cut; the stack is then to be made anew.
//
// OpenFOAM estimates the centre of a cell from those of its faces, the sides' at mid-edge among them, and weighs with their
// pyramids. Over a face warped by w the estimate is off the middle between wall and layer by a share of w times what the
// columns lean apart (of w itself over more than four corners); it cares little how near the two are. So a cell that is thin
// beside that has its centre beyond one of its faces, and a face pyramid that points the wrong way, however well its points
// lie. Nor does a face between two such cells divide into triangles that both see from their own side. Over triangles there is
// none of this.
std::size_t cutWarped(Front& front, const LayerStack& stack, const SurfaceIndex& index);

// The same of the faces under these cells of the stack, numbered from its first, into triangles.
std::size_t cutUnder(Front& front, const LayerStack& stack, const SurfaceIndex& index, const std::vector<std::int32_t>& cells);

// A prism between two faces of a stack as OpenFOAM sees it.
struct ThinCell {
    Vec3 centre;             // m
    double height = 0;       // m, from the face at the wall to the other
    double centreShare = -1; // height of the centre over either face, the smaller, as a share of the cell's: 0.5 where all is well
};
// Polygons in the same order, their normals towards the wall, of up to 16 points.
ThinCell thinCell(std::span<const Vec3> low, std::span<const Vec3> high);

} // namespace i2b
