#include "i2b/carve/carve.h"
#include "i2b/carve/vertices.h"
#include "i2b/core/checksum.h"
#include "i2b/core/error.h"
#include "i2b/grid/ranked_mask.h"
#include "i2b/paint/paint.h"
#include <algorithm>
#include <fmt/format.h>

namespace i2b {
namespace {

void sortUnique(std::vector<Place>& places) {
    std::sort(places.begin(), places.end());
    places.erase(std::unique(places.begin(), places.end()), places.end());
}

std::vector<Place> placesOf(const std::vector<Mask::Ptr>& masks) {
    std::vector<Place> places;
    for (std::size_t l = 0; l < masks.size(); ++l) {
        const RankedMask ranked(masks[l]);
        const std::size_t start = places.size();
        places.resize(start + static_cast<std::size_t>(ranked.size()));
        ranked.forEach([&](std::int64_t rank, const Index3& c) { places[start + std::size_t(rank)] = {int(l), c}; });
    }
    return places;
}

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
    sortUnique(all);
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

// The nearest to the geometry of the octants' cells that take() accepts.
template <class Take>
void pickNearest(const VertexView& view, const CellGrid& grid, const SurfaceIndex& index, const Take& take,
                 std::vector<Place>& out) {
    double best = std::numeric_limits<double>::infinity();
    int choice = -1;
    for (int o = 0; o < 8; ++o) {
        const Octant& octant = view.octants[std::size_t(o)];
        if (!octant.kept || octant.level < 0 || !take(o)) continue;
        const double d = index.closest(grid.lattice.cellBox(grid.levels[std::size_t(octant.level)].level, octant.cell).centre()).distance;
        if (d < best) best = d, choice = o;
    }
    if (choice >= 0) out.push_back({view.octants[std::size_t(choice)].level, view.octants[std::size_t(choice)].cell});
}

// Where the lattice edge that leaves a vertex ends: at the nearest far end of the cells around it, each of which has
// it for an edge, since kept and removed ones alternate.
FinePoint endOfEdge(const Place& v, const VertexView& view, std::size_t axis, int side, const CellGrid& grid,
                    const VertexLookup& lookup) {
    const FinePoint start = lookup.fine(v);
    std::int64_t length = std::numeric_limits<std::int64_t>::max();
    for (int o = 0; o < 8; ++o) {
        const Octant& octant = view.octants[std::size_t(o)];
        if ((o >> axis & 1) != side || octant.level < 0) continue;
        Index3 far = octant.cell;
        far[axis] += side;
        const FinePoint end = lookup.fine(grid.levels[std::size_t(octant.level)].level, far);
        length = std::min(length, std::abs(end[axis] - start[axis]));
    }
    FinePoint end = start;
    end[axis] += side ? length : -length;
    return end;
}

// An edge at which kept and removed cells alternate must come apart in the same way at both of its ends.
void judgeEdges(const Place& v, const VertexView& view, const VertexPattern& pattern, const CellGrid& grid,
                VertexLookup& lookup, const SurfaceIndex& index, std::vector<Place>& out) {
    for (int e = 0; e < 6; ++e) {
        const int axis = e >> 1, side = e & 1;
        if (pattern.edge[std::size_t(e)] == Alternation::none || view.outside >> e & 1) continue;
        const std::optional<Place> end = lookup.vertexAt(endOfEdge(v, view, std::size_t(axis), side, grid, lookup));
        if (!end) continue;
        const VertexPattern& other = vertexPattern(lookup.view(*end).kept);
        if (other.edge[std::size_t(e ^ 1)] == pattern.edge[std::size_t(e)]) continue;
        pickNearest(view, grid, index, [&](int o) { return (o >> axis & 1) == side; }, out);
    }
}

std::vector<Place> notExtrudable(const std::vector<Place>& vertices, const CellGrid& grid,
                                 const std::vector<Mask::Ptr>& kept, const SurfaceIndex& index) {
    return collect(vertices, grid, kept, [&](const Place& v, VertexLookup& lookup, std::vector<Place>& out) {
        const VertexView view = lookup.view(v);
        const VertexPattern& pattern = vertexPattern(view.kept);
        if (pattern.fans == 0) return;
        for (std::size_t f = 0; f < pattern.fans; ++f) {
            if (pattern.good[f]) continue;
            pickNearest(view, grid, index,
                        [&](int o) { return pattern.component[std::size_t(o)] == pattern.fanComponent[f]; }, out);
        }
        judgeEdges(v, view, pattern, grid, lookup, index, out);
    });
}

// Vertices on the closed cells, each on its own level.
std::vector<Place> verticesOf(const std::vector<Place>& cells, const CellGrid& grid, const std::vector<Mask::Ptr>& kept) {
    std::vector<Place> vertices;
    VertexLookup lookup(grid, kept);
    for (const Place& cell : cells) {
        const LevelTriple half = halvedLevel(grid.levels[std::size_t(cell.level)].level);
        for (int i = 0; i < 27; ++i) {
            const Index3 p{2 * cell.at[0] + i % 3, 2 * cell.at[1] + i / 3 % 3, 2 * cell.at[2] + i / 9};
            if (const std::optional<Place> v = lookup.vertexAt(lookup.fine(half, p))) vertices.push_back(*v);
        }
    }
    sortUnique(vertices);
    return vertices;
}

// Keeps the largest connected part of each kept region; gives the number of cells dropped.
std::uint64_t dropIslands(std::vector<Mask::Ptr>& kept, const CellGrid& grid) {
    CutCells closed;
    for (std::size_t l = 0; l < kept.size(); ++l) closed.levels.push_back(differenceOf(*grid.levels[l].cells, *kept[l]));
    const Regions pieces = labelRegions(grid, closed);
    if (pieces.table.size() < 2) return 0;
    const auto best = std::max_element(pieces.table.begin(), pieces.table.end(),
                                       [](const Region& a, const Region& b) { return a.volume < b.volume; });
    std::uint64_t dropped = 0;
    for (const Region& r : pieces.table) dropped += r.id == best->id ? 0 : r.cells;
    kept = pieces.cellsOf(best->id);
    return dropped;
}

struct Carved {
    std::vector<Mask::Ptr> cells;
    std::uint64_t clearance = 0, front = 0, islands = 0;
};

Carved carveRegion(const CellGrid& grid, const CutCells& cut, const Regions& regions, const Region& region,
                   const SurfaceIndex& index, double clearance) {
    Carved result;
    result.cells = regions.cellsOf(region.id);
    const std::vector<Place> close = tooClose(grid, cut, result.cells, index, clearance);
    removeCells(result.cells, close);
    result.clearance = close.size();
    result.islands = dropIslands(result.cells, grid);
    std::vector<Place> vertices = placesOf(frontVertices(grid, result.cells, activeVertices(grid, result.cells)));
    while (!vertices.empty()) {
        const std::vector<Place> bad = notExtrudable(vertices, grid, result.cells, index);
        removeCells(result.cells, bad);
        result.front += bad.size();
        // A cell's removal changes the vertices around it, and what their neighbours' edges see at the other end.
        std::vector<Place> around = verticesOf(bad, grid, result.cells);
        vertices = std::move(around);
    }
    for (Mask::Ptr& mask : result.cells) pruneEmptyLeaves(*mask);
    result.islands += dropIslands(result.cells, grid);
    if (std::all_of(result.cells.begin(), result.cells.end(), [](const Mask::Ptr& m) { return m->empty(); })) {
        throw Error(ErrorKind::input, fmt::format("nothing is left of region '{}'", region.name),
                    fmt::format("near ({:g} {:g} {:g})", region.seed.x, region.seed.y, region.seed.z),
                    "it is narrower than two cells everywhere: give a smaller --size");
    }
    return result;
}

} // namespace

KeptCells carve(const CellGrid& grid, const CutCells& cut, const Regions& regions, const SurfaceIndex& index,
                const FitOptions& options) {
    KeptCells kept;
    for (const Region& region : regions.table) {
        if (!region.painted) continue;
        Carved carved = carveRegion(grid, cut, regions, region, index, options.clearance);
        kept.carvedForClearance += carved.clearance;
        kept.carvedForFront += carved.front;
        kept.droppedIslands += carved.islands;
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
