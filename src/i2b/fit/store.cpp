#include "i2b/fit/store.h"
#include "i2b/core/collect.h"
#include "i2b/core/parallel.h"
#include "i2b/core/raw_fill.h"
#include <algorithm>

namespace i2b {

void store(const Band& band, const Positions& x, Front& front) {
    parallelFor(band.walls, [&](std::size_t v) {
        front.mesh.set_point(FrontMesh::VertexHandle(static_cast<int>(v)), {x[v].x, x[v].y, x[v].z});
        front.front[v] = x[static_cast<std::size_t>(band.frontNode[v])];
    }, 2048);
    const std::size_t core = band.walls + band.fronts;
    const RawVector<std::uint32_t> moved = collect<std::uint32_t>(band.movable - core, [&](std::size_t i, const auto& put) {
        if (!(x[core + i] == band.start[core + i])) put(static_cast<std::uint32_t>(core + i));
    }, 4096);
    front.movedPoints.resize(moved.size()), front.movedTo.resize(moved.size()), front.movedSize.resize(moved.size()), front.movedOutside.resize(moved.size());
    parallelFor(moved.size(), [&](std::size_t i) {
        const std::size_t n = moved[i];
        front.movedPoints[i] = band.corePoint[n - band.walls];
        front.movedTo[i] = x[n];
        front.movedSize[i] = static_cast<float>(band.h[n]);
        front.movedOutside[i] = band.outside[n];
    }, 4096);
}

void takeStored(const Band& band, const Front& front, Positions& x) {
    copyTo(x, band.start);
    parallelFor(band.walls, [&](std::size_t v) {
        x[v] = front.wall(v);
        x[static_cast<std::size_t>(band.frontNode[v])] = front.front[v]; // the same of all its fans
    }, 2048);
    const std::size_t core = band.walls + band.fronts;
    parallelFor(band.nodes() - core, [&](std::size_t i) {
        const std::int32_t point = band.corePoint[core + i - band.walls];
        const auto found = std::lower_bound(front.movedPoints.begin(), front.movedPoints.end(), point);
        if (found != front.movedPoints.end() && *found == point) x[core + i] = front.movedTo[static_cast<std::size_t>(found - front.movedPoints.begin())];
    }, 2048);
}

} // namespace i2b
