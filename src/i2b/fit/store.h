// Between the positions of a band's nodes and those that a front has.
#pragma once
#include "i2b/fit/band.h"

namespace i2b {

// Gives the front its wall and front positions, and the core points that are not where the lattice has them.
void store(const Band& band, const Positions& x, Front& front);
// The other way round.
void takeStored(const Band& band, const Front& front, Positions& x);

} // namespace i2b
