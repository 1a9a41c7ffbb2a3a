#include "i2b/core/error.h"
#include "i2b/grid/mask_ops.h"
#include "i2b/paint/paint.h"
#include <fmt/format.h>

namespace i2b {
namespace {

std::string at(const Vec3& p) { return fmt::format("({:g} {:g} {:g})", p.x, p.y, p.z); }

// Of the open cell of a level, or -1.
std::int32_t regionOf(const Regions& regions, std::size_t level, const Index3& c) {
    const Index3 origin{c[0] & ~7, c[1] & ~7, c[2] & ~7};
    const int offset = bits::offset(c[0], c[1], c[2]);
    for (const RegionPiece& piece : regions.pieces[level]) {
        if (piece.origin == origin && bits::test(piece.mask, offset)) return piece.region;
    }
    return -1;
}

const Region* largest(const Regions& regions, bool touchingBox) {
    const Region* best = nullptr;
    for (const Region& r : regions.table) {
        if (r.touchesDomainBox == touchingBox && (!best || r.volume > best->volume)) best = &r;
    }
    return best;
}

void paintSeed(Regions& regions, const CellGrid& grid, const Seed& seed) {
    Region& r = regions.table[static_cast<std::size_t>(regionAt(regions, grid, seed.place, "seed"))];
    r.painted = true;
    if (!seed.name.empty()) r.name = seed.name;
}

} // namespace

std::int32_t regionAt(const Regions& regions, const CellGrid& grid, const Vec3& place, const char* what) {
    if (!grid.lattice.domain().contains(place)) {
        throw Error(ErrorKind::input, fmt::format("the {} lies outside the domain box", what), at(place),
                    fmt::format("choose one between {} and {}", at(grid.lattice.domain().lo), at(grid.lattice.domain().hi)));
    }
    for (std::size_t l = 0; l < grid.levels.size(); ++l) {
        const Index3 c = grid.lattice.cellAt(grid.levels[l].level, place);
        if (!grid.levels[l].cells->isValueOn(toCoord(c))) continue;
        if (const std::int32_t region = regionOf(regions, l, c); region >= 0) return region;
    }
    const Region* near = nullptr;
    for (const Region& r : regions.table) {
        if (r.box.contains(place) && (!near || r.volume < near->volume)) near = &r;
    }
    throw Error(ErrorKind::input, fmt::format("the {} lies in a cell that the geometry cuts", what), at(place),
                near ? "move it away from the wall, for example to " + at(near->seed)
                     : "move it away from the wall, or give a smaller --size");
}

void chooseRegions(Regions& regions, const CellGrid& grid, const CutCells&, const DomainOptions& domain) {
    if (regions.table.empty()) {
        throw Error(ErrorKind::input, "the geometry cuts every cell", "", "give a smaller --size");
    }
    for (const Seed& seed : domain.seeds) paintSeed(regions, grid, seed);
    const bool external = domain.flow == Flow::external || (domain.flow == Flow::automatic && domain.seeds.empty());
    const bool internal = domain.flow == Flow::internal && domain.seeds.empty();
    if (!external && !internal) return;
    const Region* best = largest(regions, external);
    if (!best) {
        throw Error(ErrorKind::input,
                    external ? "no region touches the domain box" : "the geometry encloses no region",
                    fmt::format("{} region{} found", regions.table.size(), regions.table.size() == 1 ? "" : "s"),
                    external ? "give a larger --box" : "the walls may have openings wider than a cell: a --seed in the flow and a --keep-out outside tell where; or give a larger --size");
    }
    regions.table[static_cast<std::size_t>(best->id)].painted = true;
}

} // namespace i2b
