#include "i2b/paint/leaks.h"
#include "i2b/core/collect.h"
#include "i2b/paint/region_cells.h"
#include "i2b/paint/spots.h"
#include "i2b/paint/union_find.h"
#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>

namespace i2b {
namespace {

using Cell = RegionCells::Cell;
enum Side : std::uint8_t { neither, here, beyond };
constexpr double perOctave = 16;  // steps of distance in which cells are flooded
constexpr double narrower = 0.7;  // of the distance at the wider end: what is no nearer to the geometry is no opening
constexpr double together = 1.5;  // edges of its cell: so near to another a face is of one opening with it

// From a cell to the one around which all are nearer to the geometry.
Cell climbed(const RegionCells& cells, Cell cell) {
    RegionCells::Reader reader(cells);
    for (;;) {
        Cell best = cell;
        reader.forEachNeighbour(cell, [&](const Cell& n, const RegionCells::Way&) {
            if (cells.clearance(n) > cells.clearance(best)) best = n;
        });
        if (best.number == cell.number) return cell;
        cell = best;
    }
}

// Per cell, by which of the two floods it is reached.
std::vector<Side> flooded(const RegionCells& cells, const std::vector<Cell>& from, const Cell& to) {
    struct Drop {
        Cell cell;
        Side side;
    };
    const double most = cells.clearance(cells.widest());
    const auto depthOf = [&](const Cell& c) { // 0: the widest
        return static_cast<std::size_t>(std::max(0.0, perOctave * std::log2(most / std::max(cells.clearance(c), 1e-9 * most))));
    };
    std::vector<std::vector<Drop>> waiting(static_cast<std::size_t>(perOctave * std::log2(1e9)) + 2);
    for (const Cell& c : from) waiting[depthOf(c)].push_back({c, here});
    waiting[depthOf(to)].push_back({to, beyond});
    std::vector<Side> sides(cells.size(), neither);
    RegionCells::Reader reader(cells);
    for (std::size_t depth = 0; depth < waiting.size(); ++depth) {
        for (std::size_t i = 0; i < waiting[depth].size(); ++i) { // grows meanwhile
            const Drop drop = waiting[depth][i];
            Side& side = sides[static_cast<std::size_t>(drop.cell.number)];
            if (side != neither) continue;
            side = drop.side;
            reader.forEachNeighbour(drop.cell, [&](const Cell& n, const RegionCells::Way&) {
                if (sides[static_cast<std::size_t>(n.number)] == neither) waiting[std::max(depth, depthOf(n))].push_back({n, drop.side});
            });
        }
        waiting[depth] = {};
    }
    return sides;
}

// Where the two floods meet.
struct Meeting {
    RegionCells::Corners face; // towards what is beyond
    double clearance, h;       // m, the lesser of the two cells'
    Vec3 centre() const { return (face[0] + face[2]) / 2; }
    Vec3 area() const { return cross(face[2] - face[0], face[3] - face[1]) / 2; }
};

std::vector<Meeting> meetings(const RegionCells& cells, const std::vector<Side>& sides) {
    std::vector<Meeting> all;
    for (std::size_t l = 0; l < cells.levels(); ++l) {
        const RankedMask& level = cells.level(l);
        const RawVector<Meeting> found = collect<Meeting>(level.leafCount(), [&](std::size_t i, const auto& put) {
            RegionCells::Reader reader(cells);
            std::int64_t number = level.leafFirst(i);
            const Index3 o = toIndex(level.leaf(i).origin());
            bits::forEach(leafBits(&level.leaf(i)), [&](int x, int y, int z) {
                const Cell c{l, {o[0] + x, o[1] + y, o[2] + z}, number++};
                if (sides[static_cast<std::size_t>(c.number)] != here) return;
                reader.forEachNeighbour(c, [&](const Cell& n, const RegionCells::Way& way) {
                    if (sides[static_cast<std::size_t>(n.number)] != beyond) return;
                    put({cells.faceBetween(c, n, way), std::min(cells.clearance(c), cells.clearance(n)), std::min(cells.h(c), cells.h(n))});
                });
            });
        }, 64);
        all.insert(all.end(), found.begin(), found.end());
    }
    return all;
}

// Those that hang together, in the order of the first of each.
std::vector<std::vector<Meeting>> gathered(const std::vector<Meeting>& all) {
    Surface centres;
    for (const Meeting& m : all) {
        const auto n = static_cast<std::uint32_t>(centres.points.size());
        centres.points.push_back(m.centre());
        centres.triangles.push_back({n, n, n});
        centres.partOf.push_back(0);
    }
    const SurfaceIndex near(centres);
    UnionFind sets(all.size());
    parallelFor(all.size(), [&](std::size_t i) {
        const double reach = together * all[i].h;
        const Vec3 p = all[i].centre(), r{reach, reach, reach};
        near.any({p - r, p + r}, [&](std::uint32_t other) {
            if (norm(centres.points[other] - p) <= reach) sets.join(static_cast<std::uint32_t>(i), other);
            return false;
        });
    }, 64);
    std::vector<std::vector<Meeting>> groups;
    std::vector<std::size_t> groupOf(all.size());
    for (std::size_t i = 0; i < all.size(); ++i) {
        const std::size_t root = sets.find(static_cast<std::uint32_t>(i)); // the first of its set
        if (root == i) groupOf[i] = groups.size(), groups.emplace_back();
        groups[groupOf[root]].push_back(all[i]);
    }
    return groups;
}

// The search for the widest place of an opening, within its bounds and h beyond them: the place is moved across the opening to where the
// geometry is farthest, and along the way through to where that is least.
class Throat {
  public:
    Throat(const Vec3& normal, double h, const Box& bounds, const SurfaceIndex& index)
        : normal_(normal), a_(normalized(cross(normal, std::abs(normal.x) < 0.7 ? Vec3{1, 0, 0} : Vec3{0, 1, 0}))), b_(cross(normal, a_)), h_(h),
          bounds_{bounds.lo - Vec3{h, h, h}, bounds.hi + Vec3{h, h, h}}, index_(index) {}

    // Moves the place; gives how far the geometry is, m.
    double find(Vec3& place) const {
        double least = widen(place);
        for (const double step : steps)
            for (bool moved = true; moved;) {
                moved = false;
                for (const double way : {step, -step}) {
                    Vec3 to = place + normal_ * (way * h_);
                    if (!bounds_.contains(to)) continue;
                    if (const double far = widen(to); far < least * (1 - gain)) least = far, place = to, moved = true;
                }
            }
        return least;
    }

  private:
    double widen(Vec3& place) const {
        double most = index_.closest(place).distance;
        for (const double step : steps)
            for (bool moved = true; moved;) {
                moved = false;
                for (const Vec3& way : {a_, -a_, b_, -b_, a_ + b_, -a_ - b_, a_ - b_, b_ - a_}) {
                    const Vec3 to = place + way * (step * h_);
                    const double far = bounds_.contains(to) ? index_.closest(to).distance : 0;
                    if (far > most * (1 + gain)) most = far, place = to, moved = true;
                }
            }
        return most;
    }

    static constexpr std::array<double, 4> steps{0.5, 0.25, 0.125, 0.0625}; // of h
    static constexpr double gain = 1e-6;
    Vec3 normal_, a_, b_; // unit, square to each other
    double h_;            // m
    Box bounds_;
    const SurfaceIndex& index_;
};

Leak openingOf(const std::vector<Meeting>& faces, const SurfaceIndex& index) {
    Leak leak;
    Vec3 way;
    const Meeting* widest = &faces.front();
    for (const Meeting& m : faces) {
        way += m.area();
        leak.box.add(m.centre());
        leak.faces.push_back(m.face);
        if (m.clearance > widest->clearance) widest = &m;
    }
    leak.area = norm(way); // of steps that lean to and fro what is seen along the way
    leak.place = widest->centre();
    leak.width = 2 * Throat(normalized(norm2(way) > 0 ? way : widest->area()), widest->h, leak.box, index).find(leak.place);
    leak.part = index.surface().partOf[index.closest(leak.place).triangle];
    return leak;
}

std::vector<Leak> openings(const RegionCells& cells, const SurfaceIndex& index, const std::vector<Cell>& from, const Cell& to) {
    std::vector<Leak> leaks;
    const std::vector<Meeting> all = meetings(cells, flooded(cells, from, to));
    for (const std::vector<Meeting>& group : gathered(all)) leaks.push_back(openingOf(group, index));
    std::ranges::stable_sort(leaks, std::greater{}, &Leak::width);
    return leaks;
}

std::string nameOf(const Seed& seed) {
    return seed.name.empty() ? fmt::format("({:g} {:g} {:g})", seed.place.x, seed.place.y, seed.place.z) : "'" + seed.name + "'";
}

// What is asked of one region.
class Search {
  public:
    Search(const Regions& regions, std::int32_t region, const CellGrid& grid, const SurfaceIndex& index)
        : cells_(regions, region, grid, index), index_(index) {}

    // From these seeds, or the widest place where there are none.
    void add(const std::vector<Seed>& seeds, const Seed& to, bool keepOut, std::vector<Leak>& leaks) const {
        std::vector<Cell> from;
        for (const Seed& seed : seeds) from.push_back(climbed(cells_, *cells_.cellAt(seed.place)));
        if (from.empty()) from.push_back(cells_.widest());
        const Cell end = climbed(cells_, *cells_.cellAt(to.place));
        const std::string text = fmt::format("{} and {} reach each other", seeds.empty() ? "the flow" : nameOf(seeds.front()), nameOf(to));
        std::vector<Leak> found = openings(cells_, index_, from, end);
        double wide = cells_.clearance(end);
        for (const Cell& c : from) wide = std::max(wide, cells_.clearance(c));
        if (found.empty() || found.front().width > 2 * narrower * wide) {
            found.assign(1, {});
            found.front().place = to.place, found.front().width = 2 * cells_.clearance(end), found.front().box.add(to.place);
            found.front().text = text + ": nothing narrow is between them";
        } else {
            for (Leak& leak : found) leak.text = text + ": an opening beside " + index_.surface().parts[static_cast<std::size_t>(leak.part)].name;
        }
        const std::int32_t pair = leaks.empty() ? 0 : leaks.back().pair + 1;
        for (Leak& leak : found) leak.pair = pair, leak.keepOut = keepOut, leak.beyond = cells_.centre(end);
        leaks.insert(leaks.end(), found.begin(), found.end());
    }

  private:
    RegionCells cells_;
    const SurfaceIndex& index_;
};

} // namespace

std::vector<Leak> findLeaks(const Regions& regions, const CellGrid& grid, const SurfaceIndex& index, const DomainOptions& domain) {
    std::vector<std::vector<Seed>> seedsOf(regions.table.size()), placesOf(regions.table.size());
    const auto add = [&](const Seed& named, const char* what, std::vector<std::vector<Seed>>& places) {
        const Spot spot = spotAt(regions, grid, index, named.place, what);
        places[static_cast<std::size_t>(spot.region)].push_back({named.name, spot.place});
    };
    for (const Seed& seed : domain.seeds) add(seed, "seed", seedsOf);
    for (const Seed& place : domain.keepOut) add(place, "place to keep out of", placesOf);
    std::vector<Leak> leaks;
    if (index.surface().triangles.empty()) return leaks; // nothing holds places apart
    for (const Region& region : regions.table) {
        const std::vector<Seed>&seeds = seedsOf[static_cast<std::size_t>(region.id)], &places = placesOf[static_cast<std::size_t>(region.id)];
        std::vector<Seed> others; // of other names than the first
        for (const Seed& seed : seeds)
            if (!seed.name.empty() && !seeds.front().name.empty() && seed.name != seeds.front().name) others.push_back(seed);
        if (!region.painted || (others.empty() && places.empty())) continue;
        const Search search(regions, region.id, grid, index);
        for (const Seed& other : others) search.add({seeds.front()}, other, false, leaks);
        for (const Seed& place : places) search.add(seeds, place, true, leaks);
    }
    return leaks;
}

} // namespace i2b
