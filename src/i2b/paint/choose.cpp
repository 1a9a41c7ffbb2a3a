#include "i2b/core/error.h"
#include "i2b/grid/mask_ops.h"
#include "i2b/paint/paint.h"
#include <fmt/format.h>

namespace i2b {
namespace {

std::string at(const Vec3& p) { return fmt::format("({:g} {:g} {:g})", p.x, p.y, p.z); }

// The region of an open cell, or -1.
std::int32_t regionAt(const Regions& regions, std::size_t level, const Index3& c) {
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
    if (!grid.lattice.domain().contains(seed.place)) {
        throw Error(ErrorKind::input, "the seed lies outside the domain box", at(seed.place),
                    fmt::format("choose one between {} and {}", at(grid.lattice.domain().lo), at(grid.lattice.domain().hi)));
    }
    for (std::size_t l = 0; l < grid.levels.size(); ++l) {
        const Index3 c = grid.lattice.cellAt(grid.levels[l].level, seed.place);
        if (!grid.levels[l].cells->isValueOn(toCoord(c))) continue;
        const std::int32_t region = regionAt(regions, l, c);
        if (region < 0) {
            const Region* near = nullptr;
            for (const Region& r : regions.table) {
                if (r.box.contains(seed.place) && (!near || r.volume < near->volume)) near = &r;
            }
            throw Error(ErrorKind::input, "the seed lies in a cell that the geometry cuts", at(seed.place),
                        near ? "move it away from the wall, for example to " + at(near->seed)
                             : "move it away from the wall, or give a smaller --size");
        }
        Region& r = regions.table[static_cast<std::size_t>(region)];
        if (r.painted && r.name != seed.name && !seed.name.empty()) {
            regions.leaks.push_back({seed.place, 0,
                                     fmt::format("the seeds '{}' and '{}' reach each other: one region", r.name, seed.name)});
        }
        r.painted = true;
        if (!seed.name.empty()) r.name = seed.name;
        return;
    }
}

} // namespace

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
                    external ? "give a larger --box" : "the walls may have openings wider than a cell: give a larger --size, or --seed");
    }
    regions.table[static_cast<std::size_t>(best->id)].painted = true;
}

} // namespace i2b
