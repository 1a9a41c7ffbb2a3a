#include "i2b/core/error.h"
#include "i2b/paint/paint.h"
#include "i2b/paint/spots.h"
#include <fmt/format.h>

namespace i2b {
namespace {

const Region* largest(const Regions& regions, bool touchingBox) {
    const Region* best = nullptr;
    for (const Region& r : regions.table) {
        if (r.touchesDomainBox == touchingBox && (!best || r.volume > best->volume)) best = &r;
    }
    return best;
}

} // namespace

void chooseRegions(Regions& regions, const CellGrid& grid, const SurfaceIndex& index, const DomainOptions& domain) {
    if (regions.table.empty()) {
        throw Error(ErrorKind::input, "the geometry cuts every cell", "", "give a smaller --size");
    }
    for (const Seed& seed : domain.seeds) {
        Region& r = regions.table[static_cast<std::size_t>(spotAt(regions, grid, index, seed.place, "seed").region)];
        r.painted = true;
        if (!seed.name.empty()) r.name = seed.name;
    }
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
