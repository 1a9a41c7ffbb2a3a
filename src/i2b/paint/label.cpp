#include "i2b/core/checksum.h"
#include "i2b/grid/neighbours.h"
#include "i2b/grid/ranked_mask.h"
#include "i2b/paint/paint.h"
#include "i2b/paint/union_find.h"

namespace i2b {
namespace {

// The open (uncut) cells of one level, and the pieces that each node's cells fall into.
struct LevelPieces {
    RankedMask cells;                 // all leaf cells of the level
    RankedMask open;
    std::vector<std::uint32_t> first; // per open node: its first piece, plus one past the end
    std::vector<RegionPiece> pieces;
    std::uint32_t base = 0;           // number of the first piece over all levels
};

template <class F>
void forEachPiece(const LeafBits& open, const F& f) {
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
    const std::size_t n = level.open.leafCount();
    level.first.assign(n + 1, 0);
    parallelFor(n, [&](std::size_t i) {
        forEachPiece(leafBits(&level.open.leaf(i)), [&](const LeafBits&) { ++level.first[i]; });
    });
    level.pieces.resize(exclusiveScan(level.first));
    parallelFor(n, [&](std::size_t i) {
        std::uint32_t k = level.first[i];
        const Index3 origin = toIndex(level.open.leaf(i).origin());
        forEachPiece(leafBits(&level.open.leaf(i)), [&](const LeafBits& b) { level.pieces[k++] = {origin, b, 0}; });
    });
}

// Pieces of two neighbouring nodes of one level that share a face of cells.
void joinSameLevel(const LevelPieces& level, std::size_t node, RankedMask::Reader& reader, UnionFind& sets) {
    const Index3 origin = toIndex(level.open.leaf(node).origin());
    for (std::size_t axis = 0; axis < 3; ++axis) {
        Index3 up = origin;
        up[axis] += 8;
        const std::int32_t other = reader.leafIndex(up);
        if (other < 0) continue;
        for (std::uint32_t a = level.first[node]; a < level.first[node + 1]; ++a) {
            for (std::uint32_t b = level.first[std::size_t(other)]; b < level.first[std::size_t(other) + 1]; ++b) {
                const LeafBits across = bits::neighbourUp({}, level.pieces[b].mask, static_cast<int>(axis));
                std::uint64_t shared = 0;
                for (std::size_t n = 0; n < 8; ++n) shared |= across[n] & level.pieces[a].mask[n];
                if (shared) sets.join(level.base + a, level.base + b);
            }
        }
    }
}

std::int64_t pieceOf(const LevelPieces& level, RankedMask::Reader& reader, const Index3& c) {
    const std::int32_t node = reader.leafIndex(c);
    if (node < 0) return -1;
    const int offset = bits::offset(c[0], c[1], c[2]);
    for (std::uint32_t k = level.first[std::size_t(node)]; k < level.first[std::size_t(node) + 1]; ++k) {
        if (bits::test(level.pieces[k].mask, offset)) return level.base + k;
    }
    return -1;
}

// A level that the cells of another may touch, and how to look cells up in it.
struct Across {
    const LevelPieces& level;
    const LevelTriple triple;
    RankedMask::Reader reader;
};

// Open cells beside an open cell of another level: those whose neighbour is no cell of their own level.
void joinLevels(const LevelPieces& level, const LevelTriple& triple, std::size_t node, RankedMask::Reader& cells,
                std::vector<Across>& others, UnionFind& sets) {
    const Index3 origin = toIndex(level.open.leaf(node).origin());
    const auto nodeBits = [&](const Index3& at) {
        const std::int32_t i = cells.leafIndex(at);
        return i < 0 ? LeafBits{} : leafBits(&level.cells.leaf(static_cast<std::size_t>(i)));
    };
    const LeafBits own = nodeBits(origin);
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
                bits::forEach(rim, [&](int x, int y, int z) {
                    const Index3 c{origin[0] + x, origin[1] + y, origin[2] + z};
                    if (!side && c[axis] == 0) return;
                    for (Across& across : others) {
                        forEachAcross(c, triple, across.triple, axis, side, [&](const Index3& n) {
                            const std::int64_t p = pieceOf(across.level, across.reader, n);
                            if (p >= 0) sets.join(level.base + k, static_cast<std::uint32_t>(p));
                        });
                    }
                });
            }
        }
    }
}

void joinPieces(const CellGrid& grid, const std::vector<LevelPieces>& levels, UnionFind& sets) {
    const std::vector<std::vector<std::size_t>> touching = touchingLevels(grid);
    for (std::size_t l = 0; l < levels.size(); ++l) {
        const LevelPieces& level = levels[l];
        parallelChunks(level.open.leafCount(), 64, [&](std::size_t begin, std::size_t end, std::size_t) {
            RankedMask::Reader open(level.open), cells(level.cells);
            std::vector<Across> others;
            for (std::size_t m : touching[l]) { // each pair of levels once
                if (m < l) others.push_back({levels[m], grid.levels[m].level, RankedMask::Reader(levels[m].open)});
            }
            for (std::size_t node = begin; node < end; ++node) {
                joinSameLevel(level, node, open, sets);
                if (!others.empty()) joinLevels(level, grid.levels[l].level, node, cells, others, sets);
            }
        });
    }
}

// Adds one piece to its region's figures.
void account(Region& region, const RegionPiece& piece, const Lattice& lattice, const LevelTriple& level) {
    const Vec3 s = lattice.cellSize(level);
    const int n = bits::count(piece.mask);
    const Index3 size = lattice.cells(level);
    if (region.cells == 0) {
        bool found = false;
        bits::forEach(piece.mask, [&](int x, int y, int z) {
            if (found) return;
            found = true;
            region.seed = lattice.cellBox(level, {piece.origin[0] + x, piece.origin[1] + y, piece.origin[2] + z}).centre();
        });
    }
    Index3 lo{8, 8, 8}, hi{0, 0, 0};
    bits::forEach(piece.mask, [&](int x, int y, int z) {
        lo = {std::min(lo[0], x), std::min(lo[1], y), std::min(lo[2], z)};
        hi = {std::max(hi[0], x), std::max(hi[1], y), std::max(hi[2], z)};
    });
    for (std::size_t i = 0; i < 3; ++i) {
        if (piece.origin[i] + lo[i] == 0 || piece.origin[i] + hi[i] + 1 == size[i]) region.touchesDomainBox = true;
        lo[i] += piece.origin[i];
        hi[i] += piece.origin[i] + 1;
    }
    region.box.add(lattice.corner(level, lo));
    region.box.add(lattice.corner(level, hi));
    region.cells += static_cast<std::uint64_t>(n);
    region.volume += n * s.x * s.y * s.z;
}

} // namespace

Regions labelRegions(const CellGrid& grid, const CutCells& cut) {
    std::vector<LevelPieces> levels(grid.levels.size());
    std::uint32_t total = 0;
    for (std::size_t l = 0; l < levels.size(); ++l) {
        levels[l].cells = RankedMask(grid.levels[l].cells);
        levels[l].open = RankedMask(differenceOf(*grid.levels[l].cells, *cut.levels[l]));
        findPieces(levels[l]);
        levels[l].base = total;
        total += static_cast<std::uint32_t>(levels[l].pieces.size());
    }
    UnionFind sets(total);
    joinPieces(grid, levels, sets);

    Regions regions;
    std::vector<std::int32_t> number(total, -1); // of the set whose smallest piece this is
    for (std::size_t l = 0; l < levels.size(); ++l) {
        for (std::size_t k = 0; k < levels[l].pieces.size(); ++k) {
            const std::uint32_t root = sets.find(levels[l].base + static_cast<std::uint32_t>(k));
            if (number[root] < 0) {
                number[root] = static_cast<std::int32_t>(regions.table.size());
                Region& region = regions.table.emplace_back();
                region.id = number[root];
                region.name = "region" + std::to_string(region.id);
            }
            levels[l].pieces[k].region = number[root];
            account(regions.table[static_cast<std::size_t>(number[root])], levels[l].pieces[k], grid.lattice, grid.levels[l].level);
        }
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
            if (piece.region != region) continue;
            MaskLeaf* leaf = write.touchLeaf(toCoord(piece.origin));
            LeafBits b = leafBits(leaf);
            for (std::size_t n = 0; n < 8; ++n) b[n] |= piece.mask[n];
            setLeafBits(*leaf, b);
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
