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
// lie. Over triangles there is none.
std::size_t cutWarped(Front& front, const LayerStack& stack, const SurfaceIndex& index);

// The same of the faces under these cells of the stack, numbered from its first, into triangles.
std::size_t cutUnder(Front& front, const LayerStack& stack, const SurfaceIndex& index, const std::vector<std::int32_t>& cells);

// The height of a prism's centre, as OpenFOAM has it, over its faces at the wall and away from it, as shares of the height
// from one to the other: 0.5 and 0.5 where all is well. The smaller one. Polygons in
// the same order, their normals towards the wall, of up to 16 points.
double centreShare(std::span<const Vec3> low, std::span<const Vec3> high);

} // namespace i2b
