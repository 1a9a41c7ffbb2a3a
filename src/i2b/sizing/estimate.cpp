#include "i2b/sizing/estimate.h"
#include "i2b/core/parallel.h"

namespace i2b {

double estimateBytes(const Surface& surface, const SizeField& field, int layers, bool gridOnly) {
    // Cells that a triangle cuts: its area over h^2, half as much again for slanted ones, and one for itself; the
    // grid then has about ten cells beside every cut one, over all levels.
    double cut = 0, wall = 0;
    const Box domain = field.lattice.domain();
    const double sum = orderedReduce(
        surface.triangles.size(), 0.0,
        [&](std::size_t begin, std::size_t end) {
            double s = 0;
            for (std::size_t t = begin; t < end; ++t) {
                Box box;
                for (std::uint32_t v : surface.triangles[t]) box.add(surface.points[v]);
                if (!box.overlaps(domain)) continue;
                const Vec3& a = surface.points[surface.triangles[t][0]];
                const double area = 0.5 * norm(cross(surface.points[surface.triangles[t][1]] - a,
                                                     surface.points[surface.triangles[t][2]] - a));
                const double h = field.lattice.h(field.target(surface, t));
                s += area / (h * h);
            }
            return s;
        },
        [](double a, double b) { return a + b; });
    wall = sum;
    cut = 1.5 * sum;
    double cells = 8 * cut + field.lattice.count[0] * double(field.lattice.count[1]) * field.lattice.count[2];
    for (const LevelBox& rule : field.boxes) {
        double n = 1;
        const Vec3 h = field.lattice.cellSize(rule.level);
        for (int i = 0; i < 3; ++i) {
            n *= std::max(0.0, std::min(rule.box.hi[i], domain.hi[i]) - std::max(rule.box.lo[i], domain.lo[i])) / h[i] + 1;
        }
        cells += n;
    }
    for (const LevelShape& rule : field.shapes) {
        const Vec3 h = field.lattice.cellSize(rule.level), e = domain.extent();
        cells += std::min(volumeOf(rule.shape), e.x * e.y * e.z) / (h.x * h.y * h.z);
    }
    for (const LevelCells& gap : field.gaps) cells += 8.0 * static_cast<double>(gap.cells.size());
    const double fixed = 150e6 + 250.0 * static_cast<double>(surface.triangles.size());
    return fixed + (gridOnly ? 3 * cells : 250 * cells + 800 * wall + 150 * wall * layers);
}

} // namespace i2b
