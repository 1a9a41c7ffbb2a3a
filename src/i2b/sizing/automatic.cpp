#include "i2b/sizing/automatic.h"
#include "i2b/core/parallel.h"
#include "i2b/sizing/curvature.h"
#include <fmt/format.h>

namespace i2b {
namespace {

double smallestOf(const SizeField& field, const SizeOptions& size) { return std::min(size.min > 0 ? size.min : size.surface / 2, field.maxSize); }

} // namespace

void addCurvature(SizeField& field, const Surface& surface, const SizeOptions& size, double featureAngle) {
    const double smallest = smallestOf(field, size);
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
    settleLevels(field);
}

std::vector<Gap> findGaps(const SizeField& field, const SurfaceIndex& index, const SizeOptions& size) {
    return findGaps(field, index, size.gapCells, smallestOf(field, size));
}

void addGaps(SizeField& field, const std::vector<Gap>& gaps, const SizeOptions& size) {
    const double smallest = smallestOf(field, size);
    field.gaps = cellsAlong(gaps, field.lattice);
    const auto narrowest = std::min_element(gaps.begin(), gaps.end(), [](const Gap& a, const Gap& b) { return a.width < b.width; });
    if (narrowest != gaps.end() && double(narrowest->width) < size.gapCells * smallest) {
        const Vec3 place = narrowest->middle();
        field.notes.push_back(fmt::format(
            "gaps narrower than {:.3g} m hold fewer than {} of the smallest cells, {:g} m (min-size); the narrowest is {:.3g} m, at ({:g} {:g} {:g})",
            size.gapCells * smallest, size.gapCells, smallest, narrowest->width, place.x, place.y, place.z));
    }
    settleLevels(field);
}

} // namespace i2b
