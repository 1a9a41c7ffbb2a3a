#include "i2b/carve/carve.h"
#include "i2b/carve/extrudable.h"
#include "i2b/carve/gaps.h"
#include "i2b/carve/islands.h"
#include "i2b/carve/passages.h"
#include "i2b/core/checksum.h"
#include "i2b/core/error.h"
#include "i2b/core/parallel_sort_unique.h"
#include "i2b/grid/ranked_mask.h"
#include <algorithm>
#include <fmt/format.h>
#include <utility>

namespace i2b {
namespace {

// Every place asks for cells to go; the list is the same whatever the threads did.
template <class Ask>
std::vector<Place> collect(const std::vector<Place>& places, const CellGrid& grid, const std::vector<Mask::Ptr>& kept,
                           const Ask& ask) {
    constexpr std::size_t chunk = 1024;
    std::vector<std::vector<Place>> parts((places.size() + chunk - 1) / chunk);
    parallelChunks(places.size(), chunk, [&](std::size_t begin, std::size_t end, std::size_t c) {
        VertexLookup lookup(grid, kept);
        for (std::size_t i = begin; i < end; ++i) ask(places[i], lookup, parts[c]);
    });
    std::vector<Place> all;
    for (const std::vector<Place>& part : parts) all.insert(all.end(), part.begin(), part.end());
    parallelSortUnique(all);
    return all;
}

void removeCells(std::vector<Mask::Ptr>& kept, const std::vector<Place>& cells) {
    for (const Place& cell : cells) kept[std::size_t(cell.level)]->setValueOff(toCoord(cell.at));
}

// Points of a level's lattice on cut cells: all of its vertices there and some more.
Mask::Ptr pointsOnCuts(const CellGrid& grid, const CutCells& cut, int level) {
    auto points = std::make_shared<Mask>(false);
    for (std::size_t k = 0; k < cut.levels.size(); ++k) {
        const LevelTriple& own = grid.levels[k].level;
        const int finest = own.finest();
        // A vertex on a finer cell is its corner, and on that cell's level, unless it hangs on a long edge.
        if (std::abs(finest - level) > 1 || (finest > level && own.same()) || isEmpty(*cut.levels[k])) continue;
        points->topologyUnion(*cornersOf(*overlapping(*cut.levels[k], own, allAxes(level))));
    }
    return points;
}

// Cells with a vertex closer to the geometry than clearance * h. Such a vertex touches a cut cell.
std::vector<Place> tooClose(const CellGrid& grid, const CutCells& cut, const std::vector<Mask::Ptr>& kept,
                            const SurfaceIndex& index, double clearance) {
    std::vector<Mask::Ptr> near = activeVertices(grid, kept);
    for (std::size_t l = 0; l < near.size(); ++l) near[l] = intersectionOf(*near[l], *pointsOnCuts(grid, cut, static_cast<int>(l)));
    return collect(placesOf(near), grid, kept, [&](const Place& v, VertexLookup& lookup, std::vector<Place>& out) {
        const double radius = clearance * grid.lattice.h(v.level);
        if (!index.closest(grid.lattice.corner(v.level, v.at), radius)) return;
        for (const Octant& o : lookup.view(v).octants) {
            if (o.kept) out.push_back({o.level, o.cell});
        }
    });
}

struct Carved {
    std::vector<Mask::Ptr> cells;
    std::uint64_t clearance = 0, given = 0, front = 0, islands = 0;
    std::vector<Region> leftOut;
};

void give(std::vector<Mask::Ptr>& kept, const std::vector<Place>& cells) {
    for (const Place& cell : cells) kept[std::size_t(cell.level)]->setValueOn(toCoord(cell.at));
}

// taken: cells of other zones, by level; none where there are no others.
Carved carveRegion(const CellGrid& grid, const CutCells& cut, const Regions& regions, const Region& region, const SurfaceIndex& index,
                   const FitOptions& options, const std::vector<Mask::Ptr>& taken) {
    Carved result;
    result.cells = regions.cellsOf(region.id);
    const std::vector<Place> close = tooClose(grid, cut, result.cells, index, options.clearance);
    removeCells(result.cells, close);
    result.clearance = close.size();
    Islands islands(result.cells, grid);
    if (options.passages) {
        const Room room(grid, cut, regions, region, result.cells, taken, index);
        std::vector<Place> inPassages = passageCells(room);
        while (islands.bringBack(result.cells, inPassages)) inPassages = passageCells(room);
        give(result.cells, inPassages);
        const GapFilling inGaps = fillGaps(room);
        removeCells(result.cells, inGaps.displaced);
        give(result.cells, inGaps.given);
        islands.bringBack(result.cells, inGaps.given);
        const ShapingSummary shaped = makeExtrudable(result.cells, grid, index, &room);
        result.given = inPassages.size() + inGaps.given.size() - inGaps.displaced.size() + shaped.added;
        result.front = shaped.removed;
    } else {
        result.front = makeExtrudable(result.cells, grid, index, nullptr).removed;
    }
    for (Mask::Ptr& mask : result.cells) pruneEmptyLeaves(*mask);
    const Islands late(result.cells, grid);
    result.islands = islands.cells() + late.cells();
    for (const Islands* out : {&std::as_const(islands), &late}) out->addLargest(result.leftOut, RoomOptions{}.pocketCells); // smaller ones are ends of grooves
    if (std::all_of(result.cells.begin(), result.cells.end(), [](const Mask::Ptr& m) { return countOf(*m) == 0; })) {
        throw Error(ErrorKind::input, fmt::format("nothing is left of region '{}'", region.name),
                    fmt::format("near ({:g} {:g} {:g})", region.seed.x, region.seed.y, region.seed.z),
                    "it is narrower than two cells everywhere: give a smaller --size");
    }
    return result;
}

// What a zone's cells must not touch: those of the zones carved before, and all painted cells of those to come.
std::vector<Mask::Ptr> otherZones(const CellGrid& grid, const Regions& regions, const Region& own, const std::vector<std::vector<Mask::Ptr>>& carved) {
    std::vector<Mask::Ptr> others;
    const auto add = [&](const std::vector<Mask::Ptr>& cells) {
        for (std::size_t l = 0; l < grid.levels.size(); ++l) {
            if (others.size() <= l) others.push_back(std::make_shared<Mask>(false));
            others[l]->topologyUnion(*cells[l]);
        }
    };
    for (const std::vector<Mask::Ptr>& zone : carved) add(zone);
    for (const Region& region : regions.table) {
        if (region.painted && region.id > own.id) add(regions.cellsOf(region.id));
    }
    return others;
}

} // namespace

KeptCells carve(const CellGrid& grid, const CutCells& cut, const Regions& regions, const SurfaceIndex& index,
                const FitOptions& options) {
    KeptCells kept;
    for (const Region& region : regions.table) {
        if (!region.painted) continue;
        Carved carved = carveRegion(grid, cut, regions, region, index, options, otherZones(grid, regions, region, kept.zones));
        kept.carvedForClearance += carved.clearance;
        kept.givenInPassages += carved.given;
        kept.carvedForFront += carved.front;
        kept.droppedIslands += carved.islands;
        kept.leftOut.insert(kept.leftOut.end(), carved.leftOut.begin(), carved.leftOut.end());
        kept.zoneNames.push_back(region.name);
        kept.zones.push_back(std::move(carved.cells));
    }
    if (kept.zones.empty()) throw Error(ErrorKind::input, "no region was chosen to be meshed", "", "give --seed x y z");
    for (std::size_t l = 0; l < grid.levels.size(); ++l) {
        Mask::Ptr all = kept.zones.front()[l];
        for (std::size_t z = 1; z < kept.zones.size(); ++z) all = unionOf(*all, *kept.zones[z][l]);
        kept.levels.push_back(all);
    }
    if (kept.zones.size() == 1) kept.zones.clear();
    return kept;
}

std::uint64_t KeptCells::cellCount() const {
    std::uint64_t n = 0;
    for (const Mask::Ptr& level : levels) n += countOf(*level);
    return n;
}

std::uint64_t KeptCells::checksum() const {
    Checksum sum;
    for (const Mask::Ptr& level : levels) addTo(sum, *level);
    return sum.value();
}

} // namespace i2b
