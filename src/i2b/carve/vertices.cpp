#include "i2b/carve/vertices.h"

namespace i2b {
namespace {

using Masks = std::vector<Mask::Ptr>;

Masks emptyMasks(int count) {
    Masks masks;
    for (int l = 0; l < count; ++l) masks.push_back(std::make_shared<Mask>(false));
    return masks;
}

Masks removedCells(const CellGrid& grid, const Masks& kept) {
    Masks removed;
    for (std::size_t k = 0; k < kept.size(); ++k) removed.push_back(differenceOf(*grid.levels[k].cells, *kept[k]));
    return removed;
}

// Adds corners of one level's cells to the lattices of vertices.
void addCorners(Masks& vertices, const Mask& cells, const LevelTriple& level) {
    if (isEmpty(cells)) return;
    const int finest = level.finest();
    Mask::Ptr corners = cornersOf(cells);
    if (!level.same()) corners = embeddedVertices(*corners, level, allAxes(finest));
    vertices[static_cast<std::size_t>(finest)]->topologyUnion(*corners);
}

// A superset of the cells of one level that touch cells of another.
Mask::Ptr beside(const Lattice& lattice, const CellLevel& cells, const Mask& others, const LevelTriple& level) {
    const LevelTriple low = coarserOf(cells.level, level);
    const Mask::Ptr mine = overlapping(*cells.cells, cells.level, low);
    const Mask::Ptr theirs = intersectionOf(*overlapping(others, level, low), *dilated(*mine, 1, lattice.cells(low)));
    if (isEmpty(*theirs)) return theirs;
    const Mask::Ptr near = intersectionOf(*mine, *dilated(*theirs, 1, lattice.cells(low)));
    return intersectionOf(*cells.cells, *overlapping(*near, low, cells.level));
}

// Drops the vertices that test() rejects.
template <class Test>
void filter(const CellGrid& grid, const Masks& kept, Mask& vertices, int level, const Test& test) {
    const std::vector<MaskLeaf*> leaves = leavesOf(vertices);
    parallelChunks(leaves.size(), 16, [&](std::size_t begin, std::size_t end, std::size_t) {
        VertexLookup lookup(grid, kept);
        for (std::size_t i = begin; i < end; ++i) {
            const Index3 o = toIndex(leaves[i]->origin());
            const LeafBits all = leafBits(leaves[i]);
            LeafBits passed{};
            bits::forEach(all, [&](int x, int y, int z) {
                if (test(lookup, Place{level, {o[0] + x, o[1] + y, o[2] + z}})) passed[std::size_t(x)] |= std::uint64_t(1) << (y * 8 + z);
            });
            setLeafBits(*leaves[i], passed);
        }
    });
    pruneEmptyLeaves(vertices);
}

// Corners of the cells that lie on the edge or face of a cell of `others`, by level; test() knows such a vertex.
template <class Test>
Masks hangingOn(const CellGrid& grid, const Masks& kept, const Masks& cells, const Masks& others, const Test& test) {
    Masks hanging = emptyMasks(grid.lattice.maxLevel + 1);
    const std::vector<std::vector<std::size_t>> touching = touchingLevels(grid);
    for (std::size_t k = 0; k < cells.size(); ++k) {
        auto near = std::make_shared<Mask>(false);
        const CellLevel own{grid.levels[k].level, cells[k]};
        for (std::size_t m : touching[k]) {
            if (finerOf(grid.levels[m].level, own.level) == grid.levels[m].level) continue; // nowhere longer
            near->topologyUnion(*beside(grid.lattice, own, *others[m], grid.levels[m].level));
        }
        addCorners(hanging, *near, own.level);
    }
    for (std::size_t l = 0; l < hanging.size(); ++l) {
        filter(grid, kept, *hanging[l], static_cast<int>(l), [&](VertexLookup& lookup, const Place& v) { return test(lookup.view(v)); });
    }
    return hanging;
}

// Cells meet across all three planes through the point.
bool isCrossing(const std::array<Octant, 8>& octants) {
    for (int axis = 0; axis < 3; ++axis) {
        bool meet = false;
        for (std::size_t o = 0; o < 8; ++o) {
            const Octant &a = octants[o], &b = octants[o ^ std::size_t(1) << axis];
            meet = meet || a.level != b.level || a.cell != b.cell;
        }
        if (!meet) return false;
    }
    return true;
}

// Crossings, by level, that test() accepts: only where each of two levels is the finer one along some axis.
template <class Test>
Masks crossings(const CellGrid& grid, const Masks& kept, const Test& test) {
    Masks found = emptyMasks(grid.lattice.maxLevel + 1);
    const std::vector<std::vector<std::size_t>> touching = touchingLevels(grid);
    for (std::size_t k = 0; k < grid.levels.size(); ++k) {
        for (std::size_t m : touching[k]) {
            const LevelTriple &a = grid.levels[k].level, &b = grid.levels[m].level, fine = finerOf(a, b);
            if (m < k || fine == a || fine == b) continue;
            const Mask::Ptr near = beside(grid.lattice, grid.levels[k], *grid.levels[m].cells, b);
            if (isEmpty(*near)) continue;
            addCorners(found, *overlapping(*near, a, fine), fine);
        }
    }
    for (std::size_t l = 0; l < found.size(); ++l) {
        filter(grid, kept, *found[l], static_cast<int>(l), [&](VertexLookup& lookup, const Place& v) {
            const std::optional<Place> vertex = lookup.vertexAt(lookup.fine(v));
            return vertex && vertex->level == static_cast<int>(l) && test(lookup.view(v));
        });
    }
    return found;
}

bool touchesKept(const VertexView& v) { return v.kept != 0; }
bool touchesRemoved(const VertexView& v) {
    return std::any_of(v.octants.begin(), v.octants.end(), [](const Octant& o) { return o.level >= 0 && !o.kept; });
}

} // namespace

VertexLookup::VertexLookup(const CellGrid& grid, const std::vector<Mask::Ptr>& kept)
    : grid_(grid), touching_(touchingLevels(grid)) {
    for (const CellLevel& level : grid.levels) cells_.emplace_back(*level.cells);
    for (const Mask::Ptr& mask : kept) kept_.emplace_back(*mask);
}

FinePoint VertexLookup::fine(const LevelTriple& level, const Index3& at) const {
    const int finest = grid_.lattice.maxLevel + 1;
    return {std::int64_t(at[0]) << (finest - level.x), std::int64_t(at[1]) << (finest - level.y),
            std::int64_t(at[2]) << (finest - level.z)};
}

FinePoint VertexLookup::fine(const Place& v) const { return fine(allAxes(v.level), v.at); }

bool VertexLookup::inCell(std::size_t level, const FinePoint& corner, Octant& octant) {
    const LevelTriple& triple = grid_.levels[level].level;
    const int finest = grid_.lattice.maxLevel + 1;
    const Index3 c{static_cast<std::int32_t>(corner[0] >> (finest - triple.x)),
                   static_cast<std::int32_t>(corner[1] >> (finest - triple.y)),
                   static_cast<std::int32_t>(corner[2] >> (finest - triple.z))};
    const bool kept = kept_[level].isValueOn(toCoord(c));
    if (!kept && !cells_[level].isValueOn(toCoord(c))) return false;
    octant = {static_cast<std::int16_t>(level), kept, c};
    last_ = level;
    return true;
}

bool VertexLookup::find(const FinePoint& corner, Octant& octant) {
    if (inCell(last_, corner, octant)) return true;
    for (std::size_t level : touching_[last_]) {
        if (inCell(level, corner, octant)) return true;
    }
    for (std::size_t level = 0; level < cells_.size(); ++level) {
        if (inCell(level, corner, octant)) return true;
    }
    return false;
}

std::array<Octant, 8> VertexLookup::around(const FinePoint& p) {
    std::array<Octant, 8> octants;
    const Index3 n = grid_.lattice.count;
    for (int o = 0; o < 8; ++o) {
        FinePoint corner = p;
        bool outside = false;
        for (std::size_t a = 0; a < 3; ++a) {
            corner[a] -= o >> a & 1 ? 0 : 1;
            outside = outside || corner[a] < 0 || corner[a] >= std::int64_t(n[a]) << (grid_.lattice.maxLevel + 1);
        }
        if (!outside) find(corner, octants[std::size_t(o)]);
    }
    return octants;
}

VertexView VertexLookup::view(int level, const Index3& v) {
    VertexView view;
    const Index3 n = grid_.lattice.cells(level);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        if (v[axis] == 0) view.outside |= 1 << (2 * axis);
        if (v[axis] == n[axis]) view.outside |= 2 << (2 * axis);
    }
    view.octants = around(fine({level, v}));
    int kept = 0;
    for (std::size_t o = 0; o < 8; ++o) kept |= int(view.octants[o].kept) << o;
    view.kept = view.outside ? mirrored(static_cast<std::uint8_t>(kept), view.outside) : static_cast<std::uint8_t>(kept);
    return view;
}

int VertexLookup::vertexLevel(const FinePoint& p, const std::array<Octant, 8>& octants) const {
    int corner = -1, finest = -1;
    for (const Octant& o : octants) {
        if (o.level < 0) continue;
        const LevelTriple& triple = grid_.levels[static_cast<std::size_t>(o.level)].level;
        bool isCorner = true;
        for (std::size_t a = 0; a < 3; ++a) {
            isCorner = isCorner && (p[a] & ((std::int64_t(1) << (grid_.lattice.maxLevel + 1 - triple[a])) - 1)) == 0;
        }
        if (isCorner) corner = std::max(corner, triple.finest());
        finest = std::max(finest, triple.finest());
    }
    return corner >= 0 ? corner : isCrossing(octants) ? finest : -1;
}

std::optional<Place> VertexLookup::vertexAt(const FinePoint& p) {
    const int level = vertexLevel(p, around(p));
    if (level < 0) return std::nullopt;
    const int shift = grid_.lattice.maxLevel + 1 - level;
    return Place{level, {static_cast<std::int32_t>(p[0] >> shift), static_cast<std::int32_t>(p[1] >> shift),
                         static_cast<std::int32_t>(p[2] >> shift)}};
}

std::vector<Mask::Ptr> activeVertices(const CellGrid& grid, const std::vector<Mask::Ptr>& kept) {
    Masks active = hangingOn(grid, kept, removedCells(grid, kept), kept, touchesKept);
    const Masks crossed = crossings(grid, kept, touchesKept);
    for (std::size_t l = 0; l < active.size(); ++l) active[l]->topologyUnion(*crossed[l]);
    for (std::size_t k = 0; k < kept.size(); ++k) addCorners(active, *kept[k], grid.levels[k].level);
    for (std::size_t l = 0; l + 1 < active.size(); ++l) active[l] = differenceOf(*active[l], *evenSamplesOf(*active[l + 1]));
    return active;
}

std::vector<Mask::Ptr> frontVertices(const CellGrid& grid, const std::vector<Mask::Ptr>& kept,
                                     const std::vector<Mask::Ptr>& active) {
    const Masks removed = removedCells(grid, kept);
    Masks touching = hangingOn(grid, kept, kept, removed, touchesRemoved);
    const Masks crossed = crossings(grid, kept, touchesRemoved);
    for (std::size_t l = 0; l < active.size(); ++l) touching[l]->topologyUnion(*crossed[l]);
    for (std::size_t k = 0; k < removed.size(); ++k) addCorners(touching, *removed[k], grid.levels[k].level);
    Masks front;
    for (std::size_t l = 0; l < active.size(); ++l) {
        front.push_back(intersectionOf(*active[l], *touching[l]));
        if (l == 0) continue;
        const Mask::Ptr coarse = intersectionOf(*touching[l - 1], *evenSamplesOf(*active[l])); // corners of both
        const LevelTriple level = allAxes(static_cast<int>(l));
        front[l]->topologyUnion(*intersectionOf(*active[l], *embeddedVertices(*coarse, allAxes(static_cast<int>(l) - 1), level)));
    }
    return front;
}

} // namespace i2b
