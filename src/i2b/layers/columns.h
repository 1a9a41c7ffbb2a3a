// The columns of layer points from wall to front. A straight column leans against the wall's normal wherever the front
// does not stand right over the wall, and every thin cell of it is sheared by that much. So columns leave the wall along its
// normal n and bend over to the front position f, the further from the wall the more (s: share of the height, d = f - b):
//
//        f            P(s) = b + s d + (s - s^2) bend (|d| n - d)
//       /
//      |              bend 1: upright at the wall, its first point as high over it as asked; bend 0: straight. The layers of
//      b ~~~~~~       a thin stack are all in the upright part, and the cell over them takes the lean.
#pragma once
#include "i2b/core/vec.h"

namespace i2b {

struct Column {
    float x = 0, y = 0, z = 0; // unit vector off the wall
    float bend = 0;            // 0 to 1

    Vec3 normal() const { return {double(x), double(y), double(z)}; }
};

struct Front;
struct LayerStack;

// Gives the stack its columns, bent as far as every prism of every layer keeps its corners right, the layers lean no more
// than straight ones would, and the innermost cell not much more. None where the layers fill one cell from front to wall.
void bendColumns(const Front& front, LayerStack& stack);

} // namespace i2b
