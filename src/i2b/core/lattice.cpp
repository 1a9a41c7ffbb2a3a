#include "i2b/core/lattice.h"

namespace i2b {

Index3 Lattice::cellAt(const LevelTriple& level, const Vec3& p) const {
    const Vec3 s = cellSize(level);
    const Index3 n = cells(level);
    Index3 c{};
    for (std::size_t i = 0; i < 3; ++i) {
        const int axis = static_cast<int>(i);
        const double x = std::floor((p[axis] - origin[axis]) / s[axis]);
        c[i] = static_cast<std::int32_t>(std::clamp(x, 0.0, static_cast<double>(n[i] - 1)));
    }
    return c;
}

} // namespace i2b
