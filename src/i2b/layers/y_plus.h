// The height of the first layer from the y+ that a turbulence model or wall function wants, as on a flat plate.
#pragma once

namespace i2b {

// Local coefficient of skin friction of a turbulent boundary layer on a smooth flat plate, from the Reynolds number of
// the distance to the leading edge, over 1e3 (the fit holds from about 5e5 to 1e9): (2 log10 Re - 0.65)^-2.3,
// H. Schlichting, Boundary-Layer Theory, 7th edition, McGraw-Hill 1979, chapter 21, equation 21.16.
double plateFriction(double reynolds);

// m. yPlus: wanted at the centre of the cell at the wall, where solvers of finite volumes keep their values, so that the
// cell is twice as high: 2 y+ nu / u_tau, u_tau = U sqrt(Cf / 2). velocity: m/s; viscosity: kinematic, m^2/s; length: m.
double firstHeightOf(double yPlus, double velocity, double viscosity, double length);

} // namespace i2b
