#include "i2b/paint/touched_parts.h"
#include "i2b/geometry/triangle_cells.h"
#include "i2b/grid/neighbours.h"
#include "i2b/grid/ranked_mask.h"
#include <atomic>

namespace i2b {
namespace {

// Cut cells of one node that share a face with a region.
struct Rim {
    std::int32_t node, region;
    LeafBits cells;
    bool before(const Rim& o) const { return node != o.node ? node < o.node : region < o.region; }
};

// Sorts, and makes one of those with the same node and region.
void merge(std::vector<Rim>& rims) {
    std::sort(rims.begin(), rims.end(), [](const Rim& a, const Rim& b) { return a.before(b); });
    std::size_t n = 0;
    for (std::size_t i = 0; i < rims.size(); ++i) {
        if (n > 0 && !rims[n - 1].before(rims[i])) {
            for (std::size_t k = 0; k < 8; ++k) rims[n - 1].cells[k] |= rims[i].cells[k];
        } else {
            rims[n++] = rims[i];
        }
    }
    rims.resize(n);
}

struct LevelRims {
    RankedMask cut;
    std::vector<Rim> rims;          // by node, then region
    std::vector<std::size_t> first; // per node of cut, plus one past the end
};

LeafBits both(const LeafBits& a, const LeafBits& b) {
    LeafBits r{};
    for (std::size_t n = 0; n < 8; ++n) r[n] = a[n] & b[n];
    return r;
}

// Finds the cut cells beside pieces of one level. One a thread, since readers remember where they looked.
class RimFinder {
  public:
    RimFinder(const CellGrid& grid, const std::vector<LevelRims>& levels, std::size_t level, const std::vector<std::size_t>& touching)
        : grid_(grid), level_(level), cells_(*grid.levels[level].cells), cut_(levels[level].cut), own_(cut_), rims(levels.size()) {
        for (std::size_t m : touching) others_.push_back({m, grid.levels[m].level, RankedMask::Reader(levels[m].cut)});
    }

    void find(const RegionPiece& piece) {
        LeafBits inside{};
        for (int axis = 0; axis < 3; ++axis) {
            const LeafBits up = bits::neighbourUp(piece.mask, {}, axis), down = bits::neighbourDown(piece.mask, {}, axis);
            for (std::size_t n = 0; n < 8; ++n) inside[n] |= up[n] | down[n];
        }
        emit(piece.origin, inside, piece.region);
        for (std::size_t axis = 0; axis < 3; ++axis) {
            for (int side = 0; side < 2; ++side) across(piece, axis, side);
        }
    }

  private:
    struct Other {
        std::size_t level;
        LevelTriple triple;
        RankedMask::Reader reader;
    };

    void emit(const Index3& origin, const LeafBits& cells, std::int32_t region) {
        const std::int32_t node = bits::any(cells) ? own_.leafIndex(origin) : -1;
        if (node < 0) return;
        const LeafBits cut = both(cells, leafBits(&cut_.leaf(static_cast<std::size_t>(node))));
        if (bits::any(cut)) rims[level_].push_back({node, region, cut});
    }
    void across(const RegionPiece& piece, std::size_t axis, int side);

    const CellGrid& grid_;
    std::size_t level_;
    MaskReader cells_;
    const RankedMask& cut_; // of this level
    RankedMask::Reader own_;
    std::vector<Other> others_;

  public:
    std::vector<std::vector<Rim>> rims; // by level
};

// The cells beyond one side of a piece: of its own level in the next node, and of other levels anywhere.
void RimFinder::across(const RegionPiece& piece, std::size_t axis, int side) {
    const int a = static_cast<int>(axis);
    Index3 next = piece.origin;
    next[axis] += side ? 8 : -8;
    emit(next, side ? bits::neighbourDown({}, piece.mask, a) : bits::neighbourUp({}, piece.mask, a), piece.region);
    if (others_.empty()) return;
    const LeafBits here = leafBits(cells_.probeConstLeaf(toCoord(piece.origin)));
    const LeafBits there = next[axis] < 0 ? LeafBits{} : leafBits(cells_.probeConstLeaf(toCoord(next)));
    const LeafBits has = side ? bits::neighbourUp(here, there, a) : bits::neighbourDown(here, there, a);
    LeafBits edge = piece.mask;
    for (std::size_t n = 0; n < 8; ++n) edge[n] &= ~has[n];
    bits::forEach(edge, [&](int x, int y, int z) {
        const Index3 c{piece.origin[0] + x, piece.origin[1] + y, piece.origin[2] + z};
        if (!side && c[axis] == 0) return;
        for (Other& other : others_) {
            forEachAcross(c, grid_.levels[level_].level, other.triple, axis, side, [&](const Index3& n) {
                const std::int32_t node = other.reader.leafIndex(n);
                if (node < 0 || !other.reader.has(n)) return;
                LeafBits one{};
                one[static_cast<std::size_t>(n[0] & 7)] = std::uint64_t(1) << bits::offset(0, n[1], n[2]);
                rims[other.level].push_back({node, piece.region, one});
            });
        }
    });
}

std::vector<LevelRims> findRims(const Regions& regions, const CellGrid& grid, const CutCells& cut) {
    constexpr std::size_t chunk = 512;
    std::vector<LevelRims> levels(grid.levels.size());
    for (std::size_t l = 0; l < levels.size(); ++l) levels[l].cut = RankedMask(cut.levels[l]);
    const std::vector<std::vector<std::size_t>> touching = touchingLevels(grid);
    for (std::size_t l = 0; l < levels.size(); ++l) {
        const std::vector<RegionPiece>& pieces = regions.pieces[l];
        std::vector<std::vector<std::vector<Rim>>> parts((pieces.size() + chunk - 1) / chunk);
        parallelChunks(pieces.size(), chunk, [&](std::size_t begin, std::size_t end, std::size_t c) {
            RimFinder finder(grid, levels, l, touching[l]);
            for (std::size_t i = begin; i < end; ++i) finder.find(pieces[i]);
            for (std::vector<Rim>& rims : finder.rims) merge(rims);
            parts[c] = std::move(finder.rims);
        });
        for (const auto& part : parts) {
            for (std::size_t m = 0; m < levels.size(); ++m) levels[m].rims.insert(levels[m].rims.end(), part[m].begin(), part[m].end());
        }
    }
    parallelFor(levels.size(), [&](std::size_t l) {
        LevelRims& level = levels[l];
        merge(level.rims);
        level.first.assign(level.cut.leafCount() + 1, 0);
        for (const Rim& rim : level.rims) ++level.first[static_cast<std::size_t>(rim.node)];
        exclusiveScan(level.first);
    }, 1);
    return levels;
}

// Parts by regions, a bit each. Bits are only ever set, so what is found does not depend on who comes first.
class Table {
  public:
    Table(std::size_t parts, std::size_t regions) : words_((regions + 63) / 64), bits_(parts * words_), left_(parts) {
        for (auto& n : left_) n.store(static_cast<std::int64_t>(regions), std::memory_order_relaxed);
    }
    bool has(std::size_t part, std::size_t region) const {
        return bits_[part * words_ + region / 64].load(std::memory_order_relaxed) >> (region % 64) & 1;
    }
    void set(std::size_t part, std::size_t region) {
        const std::uint64_t bit = std::uint64_t(1) << (region % 64);
        if (bits_[part * words_ + region / 64].fetch_or(bit, std::memory_order_relaxed) & bit) return;
        left_[part].fetch_sub(1, std::memory_order_relaxed);
    }
    bool complete(std::size_t part) const { return left_[part].load(std::memory_order_relaxed) <= 0; }

  private:
    std::size_t words_;
    std::vector<std::atomic<std::uint64_t>> bits_;
    std::vector<std::atomic<std::int64_t>> left_; // per part: regions that it may still be new to
};

// The cells of a level that the bounds of a triangle meet, closed and to the safe side, and the triangle there.
struct Placed {
    Placed(const Surface& s, std::size_t t, const Lattice& lattice, const LevelTriple& level) {
        const Vec3 size = lattice.cellSize(level);
        const Index3 n = lattice.cells(level);
        for (std::size_t i = 0; i < 3; ++i) {
            const Vec3 d = s.points[s.triangles[t][i]] - lattice.origin;
            corner[i] = {d.x / size.x, d.y / size.y, d.z / size.z};
        }
        for (std::size_t i = 0; i < 3; ++i) {
            const int a = static_cast<int>(i);
            const double low = std::min({corner[0][a], corner[1][a], corner[2][a]});
            const double high = std::max({corner[0][a], corner[1][a], corner[2][a]});
            const double pad = 1e-12 * (std::abs(low) + std::abs(high) + 1); // rounding of the division above
            empty = empty || high + pad < 0 || low - pad > n[i];
            lo[i] = static_cast<std::int32_t>(std::clamp(std::ceil(low - pad) - 1, 0.0, n[i] - 1.0));
            hi[i] = static_cast<std::int32_t>(std::clamp(std::floor(high + pad), 0.0, n[i] - 1.0));
        }
    }
    std::array<Vec3, 3> corner;
    Index3 lo{}, hi{};
    bool empty = false;
};

void lookAt(const LevelRims& level, RankedMask::Reader& reader, const Placed& triangle, std::size_t part, Table& table) {
    const TriangleBoxTest test(triangle.corner[0], triangle.corner[1], triangle.corner[2]);
    TriangleCells(test).visit(triangle.lo, triangle.hi, [&](const Index3& origin, const LeafBits& met) {
        const std::int32_t node = reader.leafIndex(origin);
        if (node < 0) return;
        const auto n = static_cast<std::size_t>(node);
        for (std::size_t i = level.first[n]; i < level.first[n + 1]; ++i) {
            const Rim& rim = level.rims[i];
            const auto region = static_cast<std::size_t>(rim.region);
            if (!table.has(part, region) && bits::any(both(rim.cells, met))) table.set(part, region);
        }
    });
}

} // namespace

void findTouchedParts(Regions& regions, const Surface& surface, const SizeField& field, const CellGrid& grid,
                      const CutCells& cut) {
    const std::vector<LevelRims> levels = findRims(regions, grid, cut);
    Table table(surface.parts.size(), regions.table.size());
    parallelChunks(surface.triangles.size(), 256, [&](std::size_t begin, std::size_t end, std::size_t) {
        std::vector<RankedMask::Reader> readers;
        for (const LevelRims& level : levels) readers.emplace_back(level.cut);
        for (std::size_t t = begin; t < end; ++t) {
            const auto part = static_cast<std::size_t>(surface.partOf[t]);
            const LevelTriple start = field.target(surface, t);
            for (std::size_t l = 0; l < levels.size() && !table.complete(part); ++l) {
                const LevelTriple& level = grid.levels[l].level;
                if (levels[l].rims.empty() || finerOf(level, start) != level) continue;
                const Placed triangle(surface, t, grid.lattice, level);
                if (!triangle.empty) lookAt(levels[l], readers[l], triangle, part, table);
            }
        }
    });
    for (std::size_t r = 0; r < regions.table.size(); ++r) {
        regions.table[r].parts.clear();
        for (std::size_t p = 0; p < surface.parts.size(); ++p) {
            if (table.has(p, r)) regions.table[r].parts.push_back(static_cast<std::int32_t>(p));
        }
    }
}

} // namespace i2b
