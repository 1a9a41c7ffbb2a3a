#include "i2b/layers/y_plus.h"
#include <cmath>

namespace i2b {

double plateFriction(double reynolds) { return std::pow(2 * std::log10(reynolds) - 0.65, -2.3); }

double firstHeightOf(double yPlus, double velocity, double viscosity, double length) {
    const double frictionVelocity = velocity * std::sqrt(plateFriction(velocity * length / viscosity) / 2);
    return 2 * yPlus * viscosity / frictionVelocity;
}

} // namespace i2b
