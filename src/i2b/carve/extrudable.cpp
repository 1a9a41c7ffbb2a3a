#include "i2b/carve/extrudable.h"
#include "i2b/core/parallel_sort_unique.h"
#include "i2b/core/sort_unique.h"
#include "i2b/grid/ranked_mask.h"
#include <algorithm>
#include <set>

namespace i2b {
namespace {

constexpr double sheetAtEdge = 0.4; // of an edge: nearer to its middle the geometry passes through it

// A cell that changes sides, and what that is worth.
struct Toggle {
    Place cell{-1, {}};
    bool add = false;
    int gain = 0;          // faults fewer
    double clearance = 0;  // m, from the cell's centre to the geometry
    Displaced displaced{}; // kept cells that go besides
    std::vector<Place> cells() const {
        std::vector<Place> all{cell};
        all.insert(all.end(), displaced.begin(), displaced.end());
        return all;
    }
    friend bool operator<(const Toggle& a, const Toggle& b) {
        if (a.gain != b.gain) return a.gain > b.gain;
        if (a.add != b.add) return a.add;
        if (a.displaced.size() != b.displaced.size()) return a.displaced.size() < b.displaced.size();
        if (a.clearance != b.clearance) return a.add ? a.clearance > b.clearance : a.clearance < b.clearance;
        return a.cell < b.cell;
    }
};

class Shaper {
  public:
    Shaper(std::vector<Mask::Ptr>& kept, const CellGrid& grid, const SurfaceIndex& index, const Room* room)
        : kept_(kept), grid_(grid), index_(index), room_(room) {}
    ShapingSummary run();

  private:
    VertexView view(const Place& v, VertexLookup& lookup, const Toggle* toggle) const;
    FinePoint endOfEdge(const Place& v, const VertexView& view, std::size_t axis, int side, const VertexLookup& lookup) const;
    int faults(const Place& v, VertexLookup& lookup, const Toggle* toggle) const;
    bool tears(Alternation alternation, const Place& v, const Place& end) const;
    int gainOf(const Toggle& toggle, VertexLookup& lookup) const;
    Toggle bestToggle(const Place& v, VertexLookup& lookup) const;
    void removeNearest(const Place& v, VertexLookup& lookup, std::vector<Place>& out) const;
    template <class Ask>
    std::vector<Place> collect(const std::vector<Place>& from, std::size_t chunk, const Ask& ask) const;
    std::vector<Place> faulty(const std::vector<Place>& vertices) const;
    void cellsAround(const Place& cell, VertexLookup& lookup, std::vector<Place>& out) const;
    std::vector<Place> seeing(const std::vector<Place>& cells) const;
    std::vector<Place> improve(const std::vector<Place>& bad);
    std::vector<Place> cutBack(const std::vector<Place>& bad);
    double clearanceOf(const Place& cell) const {
        return index_.closest(grid_.lattice.cellBox(grid_.levels[std::size_t(cell.level)].level, cell.at).centre()).distance;
    }
    void set(const Place& cell, bool on) { kept_[std::size_t(cell.level)]->setValue(toCoord(cell.at), on); }

    std::vector<Mask::Ptr>& kept_;
    const CellGrid& grid_;
    const SurfaceIndex& index_;
    const Room* room_;
    std::set<Place> gone_; // cut back: never to return, so that the work ends
    ShapingSummary summary_;
};

VertexView Shaper::view(const Place& v, VertexLookup& lookup, const Toggle* toggle) const {
    VertexView view = lookup.view(v);
    if (!toggle) return view;
    int kept = 0;
    for (std::size_t o = 0; o < 8; ++o) {
        Octant& octant = view.octants[o];
        const Place at{octant.level, octant.cell};
        if (at == toggle->cell) octant.kept = toggle->add;
        else if (std::find(toggle->displaced.begin(), toggle->displaced.end(), at) != toggle->displaced.end()) octant.kept = false;
        kept |= int(octant.kept) << o;
    }
    view.kept = view.outside ? mirrored(static_cast<std::uint8_t>(kept), view.outside) : static_cast<std::uint8_t>(kept);
    return view;
}

// Where the lattice edge that leaves a vertex ends: at the nearest far end of the cells around it, each of which has
// it for an edge, since kept and removed ones alternate.
FinePoint Shaper::endOfEdge(const Place& v, const VertexView& view, std::size_t axis, int side, const VertexLookup& lookup) const {
    const FinePoint start = lookup.fine(v);
    std::int64_t length = std::numeric_limits<std::int64_t>::max();
    for (int o = 0; o < 8; ++o) {
        const Octant& octant = view.octants[std::size_t(o)];
        if ((o >> axis & 1) != side || octant.level < 0) continue;
        Index3 far = octant.cell;
        far[axis] += side;
        const FinePoint end = lookup.fine(grid_.levels[std::size_t(octant.level)].level, far);
        length = std::min(length, std::abs(end[axis] - start[axis]));
    }
    FinePoint end = start;
    end[axis] += side ? length : -length;
    return end;
}

int Shaper::faults(const Place& v, VertexLookup& lookup, const Toggle* toggle) const {
    const VertexView here = view(v, lookup, toggle);
    const VertexPattern& pattern = vertexPattern(here.kept);
    int count = 0;
    for (std::size_t f = 0; f < pattern.fans; ++f) count += !pattern.good[f];
    for (int e = 0; e < 6 && pattern.fans > 0; ++e) {
        if (pattern.edge[std::size_t(e)] == Alternation::none || here.outside >> e & 1) continue;
        const std::optional<Place> end = lookup.vertexAt(endOfEdge(v, here, std::size_t(e >> 1), e & 1, lookup));
        if (!end) continue;
        const VertexPattern& other = vertexPattern(view(*end, lookup, toggle).kept);
        const Alternation own = pattern.edge[std::size_t(e)];
        count += other.edge[std::size_t(e ^ 1)] != own || tears(own, v, *end);
    }
    return count;
}

// Do removed cells come apart at a lattice edge that a sheet passes from one to the other? What is cut off there would become a
// wall of its own.
bool Shaper::tears(Alternation alternation, const Place& v, const Place& end) const {
    if (alternation != Alternation::removedApart) return false;
    const Vec3 a = grid_.lattice.corner(v.level, v.at), b = grid_.lattice.corner(end.level, end.at);
    return bool(index_.closest((a + b) * 0.5, sheetAtEdge * norm(b - a)));
}

int Shaper::gainOf(const Toggle& toggle, VertexLookup& lookup) const {
    int gain = 0;
    for (const Place& v : verticesOf(toggle.cells(), lookup, grid_)) gain += faults(v, lookup, nullptr) - faults(v, lookup, &toggle);
    return gain;
}

// The change among the cells around a vertex that helps most; gain 0 where none helps.
Toggle Shaper::bestToggle(const Place& v, VertexLookup& lookup) const {
    const VertexView here = lookup.view(v);
    Toggle best;
    std::set<Place> seen;
    for (const Octant& o : here.octants) {
        const Place cell{o.level, o.cell};
        if (o.level < 0 || !seen.insert(cell).second) continue;
        Toggle t{cell, !o.kept, 0, 0};
        if (t.add && (!room_ || gone_.count(cell) || !room_->mayJoin(cell, t.clearance, t.displaced))) continue;
        t.gain = gainOf(t, lookup);
        if (t.gain <= 0) continue;
        if (!t.add) t.clearance = clearanceOf(cell);
        if (best.gain == 0 || t < best) best = t;
    }
    return best;
}

// Of each fan at fault, and each edge that does not fit its other end, the kept cell nearest to the geometry.
void Shaper::removeNearest(const Place& v, VertexLookup& lookup, std::vector<Place>& out) const {
    const VertexView here = lookup.view(v);
    const VertexPattern& pattern = vertexPattern(here.kept);
    const auto pick = [&](const auto& take) {
        Place choice{-1, {}};
        double least = std::numeric_limits<double>::infinity();
        for (int o = 0; o < 8; ++o) {
            const Octant& octant = here.octants[std::size_t(o)];
            if (!octant.kept || octant.level < 0 || !take(o)) continue;
            const Place cell{octant.level, octant.cell};
            const double d = clearanceOf(cell);
            if (d < least) least = d, choice = cell;
        }
        if (choice.level >= 0) out.push_back(choice);
    };
    for (std::size_t f = 0; f < pattern.fans; ++f) {
        if (!pattern.good[f]) pick([&](int o) { return pattern.component[std::size_t(o)] == pattern.fanComponent[f]; });
    }
    for (int e = 0; e < 6; ++e) {
        if (pattern.edge[std::size_t(e)] == Alternation::none || here.outside >> e & 1) continue;
        const std::optional<Place> end = lookup.vertexAt(endOfEdge(v, here, std::size_t(e >> 1), e & 1, lookup));
        if (!end) continue;
        const Alternation other = vertexPattern(lookup.view(*end).kept).edge[std::size_t(e ^ 1)];
        if (other == pattern.edge[std::size_t(e)] && !tears(other, v, *end)) continue;
        pick([&](int o) { return (o >> (e >> 1) & 1) == (e & 1); });
    }
}

// What ask(place, lookup, out) gives for each place, in their order.
template <class Ask>
std::vector<Place> Shaper::collect(const std::vector<Place>& from, std::size_t chunk, const Ask& ask) const {
    std::vector<std::vector<Place>> parts((from.size() + chunk - 1) / chunk);
    parallelChunks(from.size(), chunk, [&](std::size_t begin, std::size_t end, std::size_t c) {
        VertexLookup lookup(grid_, kept_);
        for (std::size_t i = begin; i < end; ++i) ask(from[i], lookup, parts[c]);
    });
    std::vector<Place> all;
    for (const std::vector<Place>& part : parts) all.insert(all.end(), part.begin(), part.end());
    return all;
}

std::vector<Place> Shaper::faulty(const std::vector<Place>& vertices) const {
    return collect(vertices, 128, [&](const Place& v, VertexLookup& lookup, std::vector<Place>& out) {
        if (faults(v, lookup, nullptr) > 0) out.push_back(v);
    });
}

// Cells that share a vertex with one, it among them.
void Shaper::cellsAround(const Place& cell, VertexLookup& lookup, std::vector<Place>& out) const {
    for (const Place& v : verticesOf({cell}, lookup, grid_)) {
        for (const Octant& o : lookup.view(v).octants) {
            if (o.level >= 0) out.push_back({o.level, o.cell});
        }
    }
}

// Vertices that a change of these cells tells on: those around, and what their neighbours' edges see at the other end.
std::vector<Place> Shaper::seeing(const std::vector<Place>& cells) const {
    std::vector<Place> around = collect(cells, 4, [&](const Place& cell, VertexLookup& lookup, std::vector<Place>& out) { cellsAround(cell, lookup, out); });
    parallelSortUnique(around);
    return collect(around, 16, [&](const Place& cell, VertexLookup& lookup, std::vector<Place>& out) {
        const std::vector<Place> vertices = verticesOf({cell}, lookup, grid_);
        out.insert(out.end(), vertices.begin(), vertices.end());
    });
}

// Makes the best changes that do not look at each other's vertices: their gains add up. Gives the changed cells.
std::vector<Place> Shaper::improve(const std::vector<Place>& bad) {
    std::vector<Toggle> toggles(bad.size());
    parallelChunks(bad.size(), 4, [&](std::size_t begin, std::size_t end, std::size_t) {
        VertexLookup lookup(grid_, kept_);
        for (std::size_t i = begin; i < end; ++i) toggles[i] = bestToggle(bad[i], lookup);
    });
    std::erase_if(toggles, [](const Toggle& t) { return t.gain <= 0; });
    std::sort(toggles.begin(), toggles.end());
    struct Sight { std::vector<Place> own, near; }; // vertices of the cells, and those one edge further: faults look that far
    std::vector<Sight> sights(toggles.size());
    parallelChunks(toggles.size(), 4, [&](std::size_t begin, std::size_t end, std::size_t) {
        VertexLookup lookup(grid_, kept_);
        for (std::size_t i = begin; i < end; ++i) {
            std::vector<Place> around;
            const std::vector<Place> cells = toggles[i].cells();
            for (const Place& cell : cells) cellsAround(cell, lookup, around);
            sortUnique(around);
            sights[i] = {verticesOf(cells, lookup, grid_), verticesOf(around, lookup, grid_)};
        }
    });
    std::set<Place> near;
    std::vector<Toggle> accepted;
    for (std::size_t i = 0; i < toggles.size(); ++i) {
        const auto isNear = [&](const Place& v) { return near.count(v) > 0; };
        if (std::any_of(sights[i].own.begin(), sights[i].own.end(), isNear)) continue;
        near.insert(sights[i].near.begin(), sights[i].near.end());
        accepted.push_back(toggles[i]);
    }
    std::vector<Place> changed;
    for (const Toggle& t : accepted) {
        set(t.cell, t.add);
        (t.add ? summary_.added : summary_.removed) += 1;
        changed.push_back(t.cell);
        for (const Place& cell : t.displaced) {
            set(cell, false);
            ++summary_.removed;
            changed.push_back(cell);
        }
    }
    return changed;
}

// Where no single change helps. Gives the cells taken away.
std::vector<Place> Shaper::cutBack(const std::vector<Place>& bad) {
    std::vector<Place> cells;
    VertexLookup lookup(grid_, kept_);
    for (const Place& v : bad) removeNearest(v, lookup, cells);
    parallelSortUnique(cells);
    for (const Place& cell : cells) {
        set(cell, false);
        gone_.insert(cell);
    }
    summary_.removed += cells.size();
    return cells;
}

ShapingSummary Shaper::run() {
    std::vector<Place> bad = faulty(placesOf(frontVertices(grid_, kept_, activeVertices(grid_, kept_))));
    while (!bad.empty()) {
        std::vector<Place> changed = improve(bad);
        if (changed.empty()) changed = cutBack(bad);
        std::vector<Place> around = seeing(changed);
        around.insert(around.end(), bad.begin(), bad.end());
        parallelSortUnique(around);
        bad = faulty(around);
    }
    return summary_;
}

} // namespace

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

std::vector<Place> verticesOf(const std::vector<Place>& cells, VertexLookup& lookup, const CellGrid& grid) {
    std::vector<Place> vertices;
    for (const Place& cell : cells) {
        const LevelTriple half = halvedLevel(grid.levels[std::size_t(cell.level)].level);
        for (int i = 0; i < 27; ++i) {
            const Index3 p{2 * cell.at[0] + i % 3, 2 * cell.at[1] + i / 3 % 3, 2 * cell.at[2] + i / 9};
            if (const std::optional<Place> v = lookup.vertexAt(lookup.fine(half, p))) vertices.push_back(*v);
        }
    }
    parallelSortUnique(vertices);
    return vertices;
}

ShapingSummary makeExtrudable(std::vector<Mask::Ptr>& kept, const CellGrid& grid, const SurfaceIndex& index, const Room* room) {
    return Shaper(kept, grid, index, room).run();
}

} // namespace i2b
