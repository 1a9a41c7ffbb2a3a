#include "i2b/paint/spots.h"
#include "i2b/core/error.h"
#include "i2b/grid/leaf_cell.h"
#include <algorithm>
#include <fmt/format.h>

namespace i2b {
namespace {

constexpr int around = 3;            // cells
constexpr std::uint64_t pocket = 64; // cells: smaller regions come last

std::string textOf(const Vec3& p) { return fmt::format("({:g} {:g} {:g})", p.x, p.y, p.z); }

// Of an open cell, or -1.
std::int32_t regionOf(const Regions& regions, const LeafCell& cell) {
    const Index3& c = cell.at;
    const Index3 origin{c[0] & ~7, c[1] & ~7, c[2] & ~7};
    const int offset = bits::offset(c[0], c[1], c[2]);
    for (const RegionPiece& piece : regions.pieces[cell.level]) {
        if (piece.origin == origin && bits::test(piece.mask, offset)) return piece.region;
    }
    return -1;
}

// The open cells around, the nearest first.
std::vector<Spot> openAround(const Regions& regions, const CellGrid& grid, const Vec3& place) {
    const Vec3 size = grid.lattice.cellSize(grid.levels[leafCellAt(grid, place)->level].level); // leaf cells cover the domain
    std::vector<Spot> spots;
    for (int x = -around; x <= around; ++x)
        for (int y = -around; y <= around; ++y)
            for (int z = -around; z <= around; ++z) {
                const Vec3 near = place + Vec3{x * size.x, y * size.y, z * size.z};
                const std::optional<LeafCell> cell = leafCellAt(grid, near);
                if (const std::int32_t region = cell ? regionOf(regions, *cell) : -1; region >= 0)
                    spots.push_back({region, grid.lattice.cellBox(grid.levels[cell->level].level, cell->at).centre()});
            }
    std::ranges::stable_sort(spots, {}, [&](const Spot& s) { return norm2(s.place - place); });
    std::ranges::stable_partition(spots, [&](const Spot& s) { return regions.table[static_cast<std::size_t>(s.region)].cells >= pocket; });
    return spots;
}

} // namespace

Spot spotAt(const Regions& regions, const CellGrid& grid, const SurfaceIndex& index, const Vec3& place, const char* what) {
    const Box domain = grid.lattice.domain();
    if (!domain.contains(place)) {
        throw Error(ErrorKind::input, fmt::format("the {} lies outside the domain box", what), textOf(place),
                    fmt::format("choose one between {} and {}", textOf(domain.lo), textOf(domain.hi)));
    }
    if (const std::int32_t region = regionOf(regions, *leafCellAt(grid, place)); region >= 0) return {region, place};
    const std::vector<Spot> spots = openAround(regions, grid, place);
    for (const Spot& spot : spots)
        if (!index.firstHit(place, spot.place)) return spot;
    throw Error(ErrorKind::input, fmt::format("the {} lies in a cell that the geometry cuts", what), textOf(place),
                spots.empty() ? "move it away from the wall, or give a smaller --size"
                              : "move it away from the wall, for example to " + textOf(spots.front().place));
}

} // namespace i2b
