#include "i2b/core/checksum.h"
#include "i2b/grid/neighbours.h"
#include "i2b/grid/ranked_mask.h"
#include "i2b/paint/paint.h"
#include "i2b/paint/union_find.h"
#include <unordered_map>

namespace i2b {
namespace {

// The cells of one level, and the pieces that each node's open (uncut) cells fall into.
struct LevelPieces {
    RankedMask cells;                 // all leaf cells of the level
    Mask::ConstPtr cut;
    std::vector<std::uint32_t> first; // per node: its first piece, plus one past the end
    std::vector<RegionPiece> pieces;
    std::uint32_t base = 0;           // number of the first piece over all levels

    LeafBits open(std::size_t node, MaskReader& walls) const {
        LeafBits b = leafBits(&cells.leaf(node));
        if (const MaskLeaf* wall = walls.probeConstLeaf(cells.leaf(node).origin())) {
            const LeafBits w = leafBits(wall);
            for (std::size_t n = 0; n < 8; ++n) b[n] &= ~w[n];
        }
        return b;
    }
};

template <class F>
void forEachPiece(const LeafBits& open, const F& f) {
    if (std::all_of(open.begin(), open.end(), [](std::uint64_t w) { return w == ~std::uint64_t(0); })) return f(open);
    LeafBits rest = open;
    for (std::size_t x = 0; x < 8; ++x) {
        while (rest[x] != 0) {
            LeafBits seed{};
            seed[x] = rest[x] & -rest[x];
            const LeafBits piece = bits::flood(seed, rest);
            for (std::size_t n = 0; n < 8; ++n) rest[n] &= ~piece[n];
            f(piece);
        }
    }
}

void findPieces(LevelPieces& level) {
    const std::size_t n = level.cells.leafCount();
    level.first.assign(n + 1, 0);
    const auto forEachNode = [&](const auto& body) {
        parallelChunks(n, 256, [&](std::size_t begin, std::size_t end, std::size_t) {
            MaskReader walls(*level.cut);
            for (std::size_t i = begin; i < end; ++i) body(i, level.open(i, walls));
        });
    };
    forEachNode([&](std::size_t i, const LeafBits& open) { forEachPiece(open, [&](const LeafBits&) { ++level.first[i]; }); });
    level.pieces.resize(exclusiveScan(level.first));
    forEachNode([&](std::size_t i, const LeafBits& open) {
        std::uint32_t k = level.first[i];
        const Index3 origin = toIndex(level.cells.leaf(i).origin());
        forEachPiece(open, [&](const LeafBits& b) { level.pieces[k++] = {origin, b, 0}; });
    });
}

bool overlap(const LeafBits& a, const LeafBits& b) {
    std::uint64_t shared = 0;
    for (std::size_t n = 0; n < 8; ++n) shared |= a[n] & b[n];
    return shared != 0;
}

// True if a cell of the last layer of one node's piece touches one in the first layer of the next node's.
bool touchAcross(const LeafBits& a, const LeafBits& b, std::size_t axis) {
    if (axis == 0) return (a[7] & b[0]) != 0;
    std::uint64_t shared = 0;
    for (std::size_t n = 0; n < 8; ++n) shared |= axis == 1 ? a[n] >> 56 & b[n] : a[n] >> 7 & b[n] & bits::zLow;
    return shared != 0;
}

// Pieces of two neighbouring nodes of one level that share a face of cells.
void joinSameLevel(const LevelPieces& level, std::size_t node, RankedMask::Reader& reader, UnionFind& sets) {
    const Index3 origin = toIndex(level.cells.leaf(node).origin());
    for (std::size_t axis = 0; axis < 3; ++axis) {
        Index3 up = origin;
        up[axis] += 8;
        const std::int32_t other = reader.leafIndex(up);
        if (other < 0) continue;
        for (std::uint32_t a = level.first[node]; a < level.first[node + 1]; ++a) {
            for (std::uint32_t b = level.first[std::size_t(other)]; b < level.first[std::size_t(other) + 1]; ++b) {
                if (touchAcross(level.pieces[a].mask, level.pieces[b].mask, axis)) sets.join(level.base + a, level.base + b);
            }
        }
    }
}

// A level that the cells of another may touch, and how to look cells up in it.
struct Across {
    const LevelPieces& level;
    const LevelTriple triple;
    RankedMask::Reader reader;
    bool parents; // one level up on every axis: the parents of cells are found in words
};

std::int64_t pieceOf(const LevelPieces& level, RankedMask::Reader& reader, const Index3& c) {
    const std::int32_t node = reader.leafIndex(c);
    if (node < 0) return -1;
    const int offset = bits::offset(c[0], c[1], c[2]);
    for (std::uint32_t k = level.first[std::size_t(node)]; k < level.first[std::size_t(node) + 1]; ++k) {
        if (bits::test(level.pieces[k].mask, offset)) return level.base + k;
    }
    return -1;
}

// The pieces, one level up, that hold the parent of any of these cells of one node.
template <class F>
void forEachParentPiece(const LeafBits& cells, const Index3& origin, Across& across, const F& f) {
    if (!bits::any(cells) || origin[0] < 0 || origin[1] < 0 || origin[2] < 0) return;
    const Index3 up{origin[0] >> 1, origin[1] >> 1, origin[2] >> 1};
    const std::int32_t node = across.reader.leafIndex(up);
    if (node < 0) return;
    LeafBits parents{};
    bits::restrictInto(parents, cells, up[0] >> 2 & 1, up[1] >> 2 & 1, up[2] >> 2 & 1, true);
    const LevelPieces& level = across.level;
    for (std::uint32_t k = level.first[std::size_t(node)]; k < level.first[std::size_t(node) + 1]; ++k) {
        if (overlap(parents, level.pieces[k].mask)) f(level.base + k);
    }
}

// Open cells of a node, without a neighbour of their own level on that side, beside open cells of other levels.
struct Rim {
    const LeafBits& cells;
    const Index3& origin;
    std::size_t axis;
    int side; // 0 low, 1 high
    std::uint32_t piece;
};

void joinRim(const Rim& rim, const LevelTriple& triple, Across& across, UnionFind& sets) {
    if (across.parents) {
        const int a = static_cast<int>(rim.axis);
        Index3 next = rim.origin;
        next[rim.axis] += rim.side ? 8 : -8;
        const auto join = [&](std::uint32_t p) { sets.join(rim.piece, p); };
        const auto moved = [&](const LeafBits& from, const LeafBits& beside) {
            return rim.side ? bits::neighbourDown(from, beside, a) : bits::neighbourUp(from, beside, a);
        };
        forEachParentPiece(moved(rim.cells, {}), rim.origin, across, join);
        forEachParentPiece(moved({}, rim.cells), next, across, join);
        return;
    }
    bits::forEach(rim.cells, [&](int x, int y, int z) {
        const Index3 c{rim.origin[0] + x, rim.origin[1] + y, rim.origin[2] + z};
        if (!rim.side && c[rim.axis] == 0) return;
        forEachAcross(c, triple, across.triple, rim.axis, rim.side, [&](const Index3& n) {
            const std::int64_t p = pieceOf(across.level, across.reader, n);
            if (p >= 0) sets.join(rim.piece, static_cast<std::uint32_t>(p));
        });
    });
}

void joinLevels(const LevelPieces& level, const LevelTriple& triple, std::size_t node, RankedMask::Reader& cells,
                std::vector<Across>& others, UnionFind& sets) {
    const Index3 origin = toIndex(level.cells.leaf(node).origin());
    const auto nodeBits = [&](const Index3& at) {
        const std::int32_t i = cells.leafIndex(at);
        return i < 0 ? LeafBits{} : leafBits(&level.cells.leaf(static_cast<std::size_t>(i)));
    };
    const LeafBits own = leafBits(&level.cells.leaf(node));
    for (std::size_t axis = 0; axis < 3; ++axis) {
        for (int side = 0; side < 2; ++side) {
            Index3 next = origin;
            next[axis] += side ? 8 : -8;
            const LeafBits other = next[axis] < 0 ? LeafBits{} : nodeBits(next);
            const int a = static_cast<int>(axis);
            const LeafBits has = side ? bits::neighbourUp(own, other, a) : bits::neighbourDown(own, other, a);
            for (std::uint32_t k = level.first[node]; k < level.first[node + 1]; ++k) {
                LeafBits rim = level.pieces[k].mask;
                for (std::size_t n = 0; n < 8; ++n) rim[n] &= ~has[n];
                if (!bits::any(rim)) continue;
                for (Across& across : others) joinRim({rim, origin, axis, side, level.base + k}, triple, across, sets);
            }
        }
    }
}

void joinPieces(const CellGrid& grid, const std::vector<LevelPieces>& levels, UnionFind& sets) {
    const std::vector<std::vector<std::size_t>> touching = touchingLevels(grid);
    for (std::size_t l = 0; l < levels.size(); ++l) {
        const LevelPieces& level = levels[l];
        const LevelTriple& own = grid.levels[l].level;
        parallelChunks(level.cells.leafCount(), 64, [&](std::size_t begin, std::size_t end, std::size_t) {
            RankedMask::Reader cells(level.cells);
            std::vector<Across> others;
            for (std::size_t m : touching[l]) { // each pair of levels once
                const LevelTriple& its = grid.levels[m].level;
                const bool parents = its.x + 1 == own.x && its.y + 1 == own.y && its.z + 1 == own.z;
                if (m < l) others.push_back({levels[m], its, RankedMask::Reader(levels[m].cells), parents});
            }
            for (std::size_t node = begin; node < end; ++node) {
                if (level.first[node] == level.first[node + 1]) continue;
                joinSameLevel(level, node, cells, sets);
                if (!others.empty()) joinLevels(level, own, node, cells, others, sets);
            }
        });
    }
}

// What a region has on one level.
struct Tally {
    std::int32_t region = -1;
    std::uint64_t cells = 0;
    Index3 lo{}, hi{}; // of cells, hi one past the end

    void add(const Tally& o) {
        for (std::size_t i = 0; i < 3; ++i) {
            lo[i] = cells ? std::min(lo[i], o.lo[i]) : o.lo[i];
            hi[i] = cells ? std::max(hi[i], o.hi[i]) : o.hi[i];
        }
        cells += o.cells;
    }
};

Tally tallyOf(const RegionPiece& piece) {
    std::uint64_t all = 0;
    unsigned xs = 0, ys = 0, zs = 0;
    for (std::size_t x = 0; x < 8; ++x) {
        all |= piece.mask[x];
        xs |= unsigned(piece.mask[x] != 0) << x;
    }
    for (unsigned y = 0; y < 8; ++y) {
        const auto row = static_cast<unsigned>(all >> (8 * y) & 0xff);
        ys |= unsigned(row != 0) << y;
        zs |= row;
    }
    Tally t{piece.region, static_cast<std::uint64_t>(bits::count(piece.mask)), {}, {}};
    const std::array<unsigned, 3> used{xs, ys, zs};
    for (std::size_t i = 0; i < 3; ++i) {
        t.lo[i] = piece.origin[i] + std::countr_zero(used[i]);
        t.hi[i] = piece.origin[i] + 32 - std::countl_zero(used[i]);
    }
    return t;
}

// Figures of all regions on one level: by chunks of pieces, in the order of first pieces in each.
void account(std::vector<Region>& table, const std::vector<RegionPiece>& pieces, const Lattice& lattice, const LevelTriple& level) {
    constexpr std::size_t chunk = 8192;
    std::vector<std::vector<Tally>> parts((pieces.size() + chunk - 1) / chunk);
    parallelChunks(pieces.size(), chunk, [&](std::size_t begin, std::size_t end, std::size_t c) {
        std::unordered_map<std::int32_t, std::size_t> place;
        for (std::size_t i = begin; i < end; ++i) {
            const auto [at, fresh] = place.try_emplace(pieces[i].region, parts[c].size());
            if (fresh) parts[c].emplace_back().region = pieces[i].region;
            parts[c][at->second].add(tallyOf(pieces[i]));
        }
    });
    std::vector<Tally> sum(table.size());
    for (const std::vector<Tally>& part : parts) {
        for (const Tally& t : part) sum[static_cast<std::size_t>(t.region)].add(t);
    }
    const Vec3 s = lattice.cellSize(level);
    const Index3 size = lattice.cells(level);
    for (std::size_t r = 0; r < table.size(); ++r) {
        const Tally& t = sum[r];
        if (t.cells == 0) continue;
        for (std::size_t i = 0; i < 3; ++i) table[r].touchesDomainBox = table[r].touchesDomainBox || t.lo[i] == 0 || t.hi[i] == size[i];
        table[r].box.add(lattice.corner(level, t.lo));
        table[r].box.add(lattice.corner(level, t.hi));
        table[r].cells += t.cells;
        table[r].volume += static_cast<double>(t.cells) * s.x * s.y * s.z;
    }
}

Vec3 centreOfFirst(const RegionPiece& piece, const Lattice& lattice, const LevelTriple& level) {
    Index3 c = piece.origin;
    for (std::size_t x = 0; x < 8; ++x) {
        if (piece.mask[x] == 0) continue;
        const int bit = std::countr_zero(piece.mask[x]);
        c[0] += static_cast<std::int32_t>(x), c[1] += bit >> 3, c[2] += bit & 7;
        break;
    }
    return lattice.cellBox(level, c).centre();
}

// Sets are numbered by their smallest piece, which stands for them.
void numberRegions(Regions& regions, std::vector<LevelPieces>& levels, const CellGrid& grid, UnionFind& sets, std::uint32_t total) {
    std::vector<std::int32_t> number(total, -1);
    for (std::size_t l = 0; l < levels.size(); ++l) {
        for (std::uint32_t k = 0; k < levels[l].pieces.size(); ++k) {
            if (sets.find(levels[l].base + k) != levels[l].base + k) continue;
            Region& region = regions.table.emplace_back();
            region.id = number[levels[l].base + k] = static_cast<std::int32_t>(regions.table.size()) - 1;
            region.name = "region" + std::to_string(region.id);
            region.seed = centreOfFirst(levels[l].pieces[k], grid.lattice, grid.levels[l].level);
        }
    }
    for (LevelPieces& level : levels) {
        parallelFor(level.pieces.size(), [&](std::size_t k) { level.pieces[k].region = number[sets.find(level.base + static_cast<std::uint32_t>(k))]; });
    }
}

} // namespace

Regions labelRegions(const CellGrid& grid, const CutCells& cut) {
    std::vector<LevelPieces> levels(grid.levels.size());
    std::uint32_t total = 0;
    for (std::size_t l = 0; l < levels.size(); ++l) {
        levels[l].cells = RankedMask(grid.levels[l].cells);
        levels[l].cut = cut.levels[l];
        findPieces(levels[l]);
        levels[l].base = total;
        total += static_cast<std::uint32_t>(levels[l].pieces.size());
    }
    UnionFind sets(total);
    joinPieces(grid, levels, sets);

    Regions regions;
    numberRegions(regions, levels, grid, sets, total);
    for (std::size_t l = 0; l < levels.size(); ++l) {
        account(regions.table, levels[l].pieces, grid.lattice, grid.levels[l].level);
        regions.pieces.push_back(std::move(levels[l].pieces));
    }
    return regions;
}

std::vector<Mask::Ptr> Regions::cellsOf(std::int32_t region) const {
    std::vector<Mask::Ptr> masks;
    for (const std::vector<RegionPiece>& level : pieces) {
        auto mask = std::make_shared<Mask>(false);
        openvdb::tree::ValueAccessor<Mask> write(*mask);
        for (const RegionPiece& piece : level) {
            if (piece.region == region) setLeafBitsOn(write, toCoord(piece.origin), piece.mask);
        }
        masks.push_back(mask);
    }
    return masks;
}

std::uint64_t Regions::checksum() const {
    Checksum sum;
    for (const std::vector<RegionPiece>& level : pieces) {
        for (const RegionPiece& p : level) {
            sum.bytes(p.origin.data(), sizeof p.origin);
            sum.bytes(p.mask.data(), sizeof p.mask);
            sum.add(p.region);
        }
    }
    return sum.value();
}

} // namespace i2b
