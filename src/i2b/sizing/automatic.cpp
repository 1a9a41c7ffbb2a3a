#include "i2b/sizing/automatic.h"
#include "i2b/core/parallel.h"
#include "i2b/sizing/curvature.h"
#include "i2b/sizing/gaps.h"
#include <fmt/format.h>

namespace i2b {
namespace {

void addCurvature(SizeField& field, const Surface& surface, const SizeOptions& size, double featureAngle, double smallest) {
    const std::vector<double> sizes = curvatureSizes(surface, size.curvature, featureAngle);
    const double least = orderedReduce(
        sizes.size(), field.maxSize,
        [&](std::size_t begin, std::size_t end) { return *std::min_element(sizes.begin() + std::ptrdiff_t(begin), sizes.begin() + std::ptrdiff_t(end)); },
        [](double a, double b) { return std::min(a, b); });
    if (least >= field.maxSize) return;
    std::vector<LevelTriple> levels(sizes.size());
    parallelFor(sizes.size(), [&](std::size_t t) {
        const LevelTriple own = field.target(surface, t);
        levels[t] = sizes[t] >= field.maxSize
                        ? own
                        : finerOf(own, levelFor(field.lattice, sameSize(std::max(sizes[t], smallest))));
    });
    field.triangleLevel = std::move(levels);
    if (least < smallest) {
        field.notes.push_back(fmt::format("curvature asks for cells down to {:.3g} m; the smallest are {:g} m (min-size)", least, smallest));
    }
}

} // namespace

void addAutomaticSizes(SizeField& field, const SurfaceIndex& index, const SizeOptions& size, double featureAngle) {
    const double smallest = std::min(size.min > 0 ? size.min : size.surface / 2, field.maxSize);
    if (size.curvature > 0) addCurvature(field, index.surface(), size, featureAngle, smallest);
    if (size.gapCells > 0) {
        GapCells gaps = findGaps(field, index, size.gapCells, smallest);
        field.gaps = std::move(gaps.levels);
        if (gaps.narrowest > 0) {
            field.notes.push_back(fmt::format(
                "gaps narrower than {:.3g} m hold fewer than {} of the smallest cells, {:g} m (min-size); the narrowest is {:.3g} m, at ({:g} {:g} {:g})",
                size.gapCells * smallest, size.gapCells, smallest, gaps.narrowest, gaps.place.x, gaps.place.y, gaps.place.z));
        }
    }
    settleLevels(field);
}

} // namespace i2b
