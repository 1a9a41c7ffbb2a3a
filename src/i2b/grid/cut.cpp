#include "i2b/grid/cut.h"
#include "i2b/geometry/triangle_cells.h"
#include "i2b/grid/mask_nodes.h"
#include <tbb/parallel_sort.h>

namespace i2b {
namespace {

constexpr int blockBits = 6; // blocks of 64^3 cells, an eighth of a tree node of 128^3

// A triangle in the coordinates of one level (cell edge 1), and the cells that its box spans there.
struct LevelTriangle {
    LevelTriangle(const Surface& surface, std::size_t t, const Lattice& lattice, const LevelTriple& level) {
        const Vec3 s = lattice.cellSize(level);
        for (std::size_t i = 0; i < 3; ++i) {
            const Vec3 d = surface.points[surface.triangles[t][i]] - lattice.origin;
            corner[i] = {d.x / s.x, d.y / s.y, d.z / s.z};
        }
        const Index3 n = lattice.cells(level);
        for (std::size_t i = 0; i < 3; ++i) {
            const int axis = static_cast<int>(i);
            const double a = std::min({corner[0][axis], corner[1][axis], corner[2][axis]});
            const double b = std::max({corner[0][axis], corner[1][axis], corner[2][axis]});
            const double pad = 1e-12 * (std::abs(a) + std::abs(b) + 1); // rounding of the division above
            // Closed cells: a plane between two cells belongs to both.
            lo[i] = static_cast<std::int32_t>(std::clamp(std::ceil(a - pad) - 1, -1.0, double(n[i])));
            hi[i] = static_cast<std::int32_t>(std::clamp(std::floor(b + pad), -1.0, double(n[i])));
            empty = empty || hi[i] < 0 || lo[i] >= n[i];
            lo[i] = std::max(lo[i], 0);
            hi[i] = std::min(hi[i], n[i] - 1);
        }
    }
    TriangleBoxTest test() const { return {corner[0], corner[1], corner[2]}; }

    std::array<Vec3, 3> corner;
    Index3 lo{}, hi{};
    bool empty = false;
};

// A triangle in a block of cells that it may meet. Ordered so that the blocks of a tree node stand together.
struct BlockEntry {
    Index3 block{};
    std::uint32_t triangle = 0;

    Index3 node() const { return {block[0] >> 1, block[1] >> 1, block[2] >> 1}; }
    friend bool operator<(const BlockEntry& a, const BlockEntry& b) {
        const Index3 na = a.node(), nb = b.node();
        return na != nb ? na < nb : a.block != b.block ? a.block < b.block : a.triangle < b.triangle;
    }
};

// Halves the range of blocks until it is one, dropping what the triangle does not meet; a large triangle so costs its
// area, not its volume.
template <class Found>
void visitBlocks(const TriangleBoxTest& test, const Index3& lo, const Index3& hi, const Found& found) {
    const Index3 n{hi[0] - lo[0] + 1, hi[1] - lo[1] + 1, hi[2] - lo[2] + 1};
    const double edge = 1 << blockBits;
    if (!test.meets({lo[0] * edge, lo[1] * edge, lo[2] * edge}, {(hi[0] + 1) * edge, (hi[1] + 1) * edge, (hi[2] + 1) * edge})) return;
    if (n == Index3{1, 1, 1}) return found(lo);
    const std::size_t axis = n[0] >= n[1] && n[0] >= n[2] ? 0 : n[1] >= n[2] ? 1 : 2;
    Index3 low = hi, high = lo;
    low[axis] = lo[axis] + n[axis] / 2 - 1;
    high[axis] = low[axis] + 1;
    visitBlocks(test, lo, low, found);
    visitBlocks(test, high, hi, found);
}

Index3 blockOf(const Index3& cell) { return {cell[0] >> blockBits, cell[1] >> blockBits, cell[2] >> blockBits}; }

// Every triangle in every block that it meets, sorted.
std::vector<BlockEntry> entriesOf(const Surface& surface, const std::vector<std::uint32_t>& triangles, const Lattice& lattice,
                                  const LevelTriple& level) {
    constexpr std::size_t chunk = 2048;
    std::vector<std::vector<BlockEntry>> parts((triangles.size() + chunk - 1) / chunk);
    parallelChunks(triangles.size(), chunk, [&](std::size_t begin, std::size_t end, std::size_t c) {
        for (std::size_t i = begin; i < end; ++i) {
            const LevelTriangle triangle(surface, triangles[i], lattice, level);
            if (triangle.empty) continue;
            const Index3 lo = blockOf(triangle.lo), hi = blockOf(triangle.hi);
            if (lo == hi) {
                parts[c].push_back({lo, triangles[i]});
            } else {
                visitBlocks(triangle.test(), lo, hi, [&](const Index3& block) { parts[c].push_back({block, triangles[i]}); });
            }
        }
    });
    std::vector<std::size_t> starts;
    for (const auto& part : parts) starts.push_back(part.size());
    std::vector<BlockEntry> entries(exclusiveScan(starts));
    parallelFor(parts.size(), [&](std::size_t c) {
        std::copy(parts[c].begin(), parts[c].end(), entries.begin() + static_cast<std::ptrdiff_t>(starts[c]));
    }, 1);
    tbb::parallel_sort(entries.begin(), entries.end());
    return entries;
}

// Where runs of entries with the same key begin, plus one past the end.
template <class Key>
std::vector<std::size_t> runsOf(const std::vector<BlockEntry>& entries, const Key& key) {
    std::vector<std::size_t> begins;
    for (std::size_t i = 0; i < entries.size(); ++i) {
        if (i == 0 || key(entries[i]) != key(entries[i - 1])) begins.push_back(i);
    }
    begins.push_back(entries.size());
    return begins;
}

// The cells of one block that its triangles meet: at most 512 leaves, found by place without any search.
class BlockCells {
  public:
    explicit BlockCells(const Index3& block) : origin_{block[0] << blockBits, block[1] << blockBits, block[2] << blockBits} {}

    void add(const LevelTriangle& triangle) {
        Index3 lo = triangle.lo, hi = triangle.hi;
        for (std::size_t i = 0; i < 3; ++i) {
            lo[i] = std::max(lo[i], origin_[i]);
            hi[i] = std::min(hi[i], origin_[i] + (1 << blockBits) - 1);
        }
        const TriangleBoxTest test = triangle.test();
        TriangleCells(test).visit(lo, hi, [&](const Index3& leaf, const LeafBits& b) {
            LeafBits& mine = leaves_[static_cast<std::size_t>(bits::offset(leaf[0] >> 3, leaf[1] >> 3, leaf[2] >> 3))];
            for (std::size_t n = 0; n < 8; ++n) mine[n] |= b[n];
        });
    }
    void addTo(NodeBuilder& node) const {
        for (std::size_t i = 0; i < leaves_.size(); ++i) {
            const auto n = static_cast<std::int32_t>(i);
            node.add({origin_[0] + 8 * (n >> 6), origin_[1] + 8 * (n >> 3 & 7), origin_[2] + 8 * (n & 7)}, leaves_[i]);
        }
    }

  private:
    Index3 origin_;
    std::vector<LeafBits> leaves_ = std::vector<LeafBits>(512);
};

// The cells of a level that any of the triangles meets. Blocks are filled and nodes are put together in parallel.
Mask::Ptr cellsMet(const Surface& surface, const std::vector<std::uint32_t>& triangles, const Lattice& lattice, const LevelTriple& level) {
    const std::vector<BlockEntry> entries = entriesOf(surface, triangles, lattice, level);
    const std::vector<std::size_t> nodes = runsOf(entries, [](const BlockEntry& e) { return e.node(); });
    return treeOfNodes(nodes.size() - 1, [&](std::size_t k) {
        const std::size_t begin = nodes[k], end = nodes[k + 1];
        const Index3 at = entries[begin].node();
        std::vector<std::size_t> blocks;
        for (std::size_t i = begin; i < end; ++i) {
            if (i == begin || entries[i].block != entries[i - 1].block) blocks.push_back(i);
        }
        blocks.push_back(end);
        std::vector<std::unique_ptr<BlockCells>> cells(blocks.size() - 1);
        parallelFor(cells.size(), [&](std::size_t b) {
            cells[b] = std::make_unique<BlockCells>(entries[blocks[b]].block);
            for (std::size_t i = blocks[b]; i < blocks[b + 1]; ++i) cells[b]->add(LevelTriangle(surface, entries[i].triangle, lattice, level));
        }, 1);
        NodeBuilder node(openvdb::Coord(at[0] * nodeEdge, at[1] * nodeEdge, at[2] * nodeEdge));
        for (const auto& block : cells) block->addTo(node);
        return node.take();
    });
}

// Triangles by target, in the order of targets.
std::vector<std::vector<std::uint32_t>> trianglesByTarget(const Surface& surface, const SizeField& field, const std::vector<LevelTriple>& targets) {
    std::vector<std::vector<std::uint32_t>> of(targets.size());
    for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
        const auto slot = std::lower_bound(targets.begin(), targets.end(), field.target(surface, t)) - targets.begin();
        of[static_cast<std::size_t>(slot)].push_back(static_cast<std::uint32_t>(t));
    }
    return of;
}

// Those that meet any cell of the mask.
std::vector<std::uint32_t> trianglesIn(const Mask& cells, const Surface& surface, const std::vector<std::uint32_t>& triangles,
                                       const Lattice& lattice, const LevelTriple& level) {
    std::vector<std::uint8_t> inside(triangles.size());
    parallelChunks(triangles.size(), 512, [&](std::size_t begin, std::size_t end, std::size_t) {
        MaskReader reader(cells);
        for (std::size_t i = begin; i < end; ++i) {
            const LevelTriangle triangle(surface, triangles[i], lattice, level);
            if (triangle.empty) continue;
            const TriangleBoxTest test = triangle.test();
            TriangleCells(test).visit(triangle.lo, triangle.hi, [&](const Index3& leaf, const LeafBits& b) {
                const LeafBits here = leafBits(reader.probeConstLeaf(toCoord(leaf)));
                for (std::size_t n = 0; n < 8; ++n) inside[i] = inside[i] || (here[n] & b[n]) != 0;
            });
        }
    });
    std::vector<std::uint32_t> found;
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        if (inside[i]) found.push_back(triangles[i]);
    }
    return found;
}

} // namespace

std::vector<CellLevel> cutAtTargetLevels(const Surface& surface, const SizeField& field) {
    const std::vector<LevelTriple> targets = field.targets();
    const std::vector<std::vector<std::uint32_t>> triangles = trianglesByTarget(surface, field, targets);
    std::vector<CellLevel> cut;
    for (std::size_t i = 0; i < targets.size(); ++i) cut.push_back({targets[i], cellsMet(surface, triangles[i], field.lattice, targets[i])});
    return cut;
}

CutCells cutLeafCells(const Surface& surface, const SizeField& field, const CellGrid& grid,
                      const std::vector<CellLevel>& atTarget) {
    CutCells cut;
    for (const CellLevel& level : grid.levels) {
        const auto same = std::find_if(atTarget.begin(), atTarget.end(), [&](const CellLevel& c) { return c.level == level.level; });
        cut.levels.push_back(same == atTarget.end() ? std::make_shared<Mask>(false) : intersectionOf(*same->cells, *level.cells));
    }
    // Where the place was refined beyond a triangle's level, look at it again on the finer levels.
    const std::vector<LevelTriple> targets = field.targets();
    const std::vector<std::vector<std::uint32_t>> triangles = trianglesByTarget(surface, field, targets);
    for (std::size_t i = 0; i < targets.size(); ++i) {
        const auto at = std::find_if(atTarget.begin(), atTarget.end(), [&](const CellLevel& c) { return c.level == targets[i]; });
        const auto own = std::find_if(grid.levels.begin(), grid.levels.end(), [&](const CellLevel& c) { return c.level == targets[i]; });
        const Mask::Ptr beyond = own == grid.levels.end() ? at->cells : differenceOf(*at->cells, *own->cells);
        if (isEmpty(*beyond)) continue;
        const std::vector<std::uint32_t> again = trianglesIn(*beyond, surface, triangles[i], field.lattice, targets[i]);
        for (std::size_t l = 0; l < grid.levels.size(); ++l) {
            const LevelTriple& level = grid.levels[l].level;
            if (level == targets[i] || finerOf(level, targets[i]) != level) continue;
            cut.levels[l]->topologyUnion(*intersectionOf(*cellsMet(surface, again, field.lattice, level), *grid.levels[l].cells));
        }
    }
    return cut;
}

} // namespace i2b
