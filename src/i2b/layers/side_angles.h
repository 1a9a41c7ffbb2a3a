// Walls that meet a side of the domain at a sharp angle, as a tyre does the ground.
#pragma once
#include "i2b/front/front.h"
#include <vector>

namespace i2b {

// The faces of thin layers on a side of the domain are strips along the wall: where the wall is inclined to the side by less
// than 30 degrees or so the centre of a cell is too far aside of its strip (skewness). There wall positions on the side go
// towards the front, within the side, until the wall rises steeply enough. Gives per vertex whether it has moved.
std::vector<std::uint8_t> steepenAtSides(Front& front);

} // namespace i2b
