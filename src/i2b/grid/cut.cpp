#include "i2b/grid/cut.h"
#include "i2b/geometry/triangle_cells.h"
#include "i2b/grid/mask_nodes.h"
#include <tbb/parallel_sort.h>

namespace i2b {
namespace {

constexpr int blockBits = 5;              // blocks of 32^3 cells
constexpr int inNodeBits = 7 - blockBits; // of a block's place along an axis of a tree node, of 128^3
constexpr int inNode = (1 << inNodeBits) - 1;

// Places in the coordinates of one level: cell edge 1.
struct LevelFrame {
    LevelFrame(const Lattice& lattice, const LevelTriple& level) : origin(lattice.origin), size(lattice.cellSize(level)), cells(lattice.cells(level)) {}
    Vec3 place(const Vec3& p) const {
        const Vec3 d = p - origin;
        return {d.x / size.x, d.y / size.y, d.z / size.z};
    }
    Vec3 origin, size;
    Index3 cells;
};

// A triangle there, and the cells that its box spans.
struct LevelTriangle {
    LevelTriangle(const Surface& surface, std::size_t t, const LevelFrame& frame) {
        for (std::size_t i = 0; i < 3; ++i) corner[i] = frame.place(surface.points[surface.triangles[t][i]]);
        for (std::size_t i = 0; i < 3; ++i) {
            const int axis = static_cast<int>(i);
            const double a = std::min({corner[0][axis], corner[1][axis], corner[2][axis]});
            const double b = std::max({corner[0][axis], corner[1][axis], corner[2][axis]});
            const double pad = 1e-12 * (std::abs(a) + std::abs(b) + 1); // rounding of the division above
            const double end = frame.cells[i];
            // Closed cells: a plane between two cells belongs to both.
            lo[i] = ceilToInt(std::clamp(a - pad, 0.0, end + 1)) - 1;
            hi[i] = floorToInt(std::clamp(b + pad, -1.0, end));
            empty = empty || hi[i] < 0 || lo[i] >= frame.cells[i];
            lo[i] = std::max(lo[i], 0);
            hi[i] = std::min(hi[i], frame.cells[i] - 1);
            inside = inside && a >= 0 && b <= end;
        }
    }
    TriangleBoxTest test() const { return {corner[0], corner[1], corner[2]}; }

    std::array<Vec3, 3> corner;
    Index3 lo{}, hi{};
    bool empty = false;
    bool inside = true; // the domain, all of it
};

// A triangle in a block of cells that it may meet. Ordered so that the blocks of a tree node stand together.
struct BlockEntry {
    BlockEntry() = default;
    BlockEntry(const Index3& block, std::uint32_t triangle)
        : xy(std::uint64_t(block[0] >> inNodeBits) << 32 | std::uint64_t(block[1] >> inNodeBits)),
          zbt(std::uint64_t(block[2] >> inNodeBits) << nodeFrom |
              std::uint64_t((block[0] & inNode) << 2 * inNodeBits | (block[1] & inNode) << inNodeBits | (block[2] & inNode)) << 32 | triangle) {}

    Index3 node() const { return {std::int32_t(xy >> 32), std::int32_t(xy & 0xffffffffu), std::int32_t(zbt >> nodeFrom)}; }
    Index3 block() const {
        const Index3 n = node();
        const auto i = static_cast<std::int32_t>(zbt >> 32);
        return {n[0] << inNodeBits | (i >> 2 * inNodeBits & inNode), n[1] << inNodeBits | (i >> inNodeBits & inNode), n[2] << inNodeBits | (i & inNode)};
    }
    std::uint32_t triangle() const { return static_cast<std::uint32_t>(zbt); }
    bool sameBlock(const BlockEntry& o) const { return xy == o.xy && zbt >> 32 == o.zbt >> 32; }
    bool sameNode(const BlockEntry& o) const { return xy == o.xy && zbt >> nodeFrom == o.zbt >> nodeFrom; }
    friend bool operator<(const BlockEntry& a, const BlockEntry& b) { return a.xy != b.xy ? a.xy < b.xy : a.zbt < b.zbt; }

    static constexpr int nodeFrom = 32 + 3 * inNodeBits;
    std::uint64_t xy = 0, zbt = 0; // node x, y; node z, block in the node, triangle
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
std::vector<BlockEntry> entriesOf(const Surface& surface, const std::vector<std::uint32_t>& triangles, const LevelFrame& frame) {
    constexpr std::size_t chunk = 2048;
    std::vector<std::vector<BlockEntry>> parts((triangles.size() + chunk - 1) / chunk);
    parallelChunks(triangles.size(), chunk, [&](std::size_t begin, std::size_t end, std::size_t c) {
        for (std::size_t i = begin; i < end; ++i) {
            const LevelTriangle triangle(surface, triangles[i], frame);
            if (triangle.empty) continue;
            const Index3 lo = blockOf(triangle.lo), hi = blockOf(triangle.hi);
            if (lo == hi) {
                parts[c].emplace_back(lo, triangles[i]);
            } else {
                visitBlocks(triangle.test(), lo, hi, [&](const Index3& block) { parts[c].emplace_back(block, triangles[i]); });
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

// Where runs of entries of begin .. end that are the same begin, plus the end.
template <class Same>
std::vector<std::size_t> runsOf(const std::vector<BlockEntry>& entries, std::size_t begin, std::size_t end, const Same& same) {
    std::vector<std::size_t> begins;
    for (std::size_t i = begin; i < end; ++i) {
        if (i == begin || !same(entries[i], entries[i - 1])) begins.push_back(i);
    }
    begins.push_back(end);
    return begins;
}

// The cells of one block that its triangles meet: at most 64 leaves, found by place without any search.
class BlockCells {
  public:
    explicit BlockCells(const Index3& block) : origin_{block[0] << blockBits, block[1] << blockBits, block[2] << blockBits} {}

    void add(const LevelTriangle& triangle) {
        Index3 lo = triangle.lo, hi = triangle.hi;
        for (std::size_t i = 0; i < 3; ++i) {
            lo[i] = std::max(lo[i], origin_[i]);
            hi[i] = std::min(hi[i], origin_[i] + (1 << blockBits) - 1);
        }
        if (triangle.lo == triangle.hi && triangle.inside) return set(lo); // it lies in one cell
        const TriangleBoxTest test = triangle.test();
        if ((hi[0] - lo[0] + 1) * (hi[1] - lo[1] + 1) * (hi[2] - lo[2] + 1) <= 8) return addFew(test, lo, hi);
        TriangleCells(test).visit(lo, hi, [&](const Index3& at, const LeafBits& b) {
            LeafBits& mine = leaf(at);
            for (std::size_t n = 0; n < 8; ++n) mine[n] |= b[n];
        });
    }
    void addTo(NodeBuilder& node) const {
        for (std::size_t i = 0; i < leaves_.size(); ++i) {
            const auto n = static_cast<std::int32_t>(i);
            node.add({origin_[0] + 8 * (n >> 2 * leafAtBits), origin_[1] + 8 * (n >> leafAtBits & inBlock), origin_[2] + 8 * (n & inBlock)}, leaves_[i]);
        }
    }

  private:
    static constexpr int leafAtBits = blockBits - 3; // of a leaf's place along an axis of the block
    static constexpr int inBlock = (1 << leafAtBits) - 1;
    LeafBits& leaf(const Index3& c) {
        return leaves_[static_cast<std::size_t>((c[0] >> 3 & inBlock) << 2 * leafAtBits | (c[1] >> 3 & inBlock) << leafAtBits | (c[2] >> 3 & inBlock))];
    }
    void set(const Index3& c) { leaf(c)[static_cast<std::size_t>(c[0] & 7)] |= std::uint64_t(1) << (bits::offset(0, c[1], c[2])); }
    // One by one: sooner done than columns are set up.
    void addFew(const TriangleBoxTest& test, const Index3& lo, const Index3& hi) {
        for (std::int32_t x = lo[0]; x <= hi[0]; ++x) {
            for (std::int32_t y = lo[1]; y <= hi[1]; ++y) {
                for (std::int32_t z = lo[2]; z <= hi[2]; ++z) {
                    const Vec3 low{double(x), double(y), double(z)};
                    if (test.meets(low, low + Vec3{1, 1, 1})) set({x, y, z});
                }
            }
        }
    }

    Index3 origin_;
    std::vector<LeafBits> leaves_ = std::vector<LeafBits>(std::size_t(1) << 3 * leafAtBits);
};

// The cells of a level that any of the triangles meets. Blocks are filled and nodes are put together in parallel.
Mask::Ptr cellsMet(const Surface& surface, const std::vector<std::uint32_t>& triangles, const Lattice& lattice, const LevelTriple& level) {
    const LevelFrame frame(lattice, level);
    const std::vector<BlockEntry> entries = entriesOf(surface, triangles, frame);
    const std::vector<std::size_t> nodes = runsOf(entries, 0, entries.size(), [](const BlockEntry& a, const BlockEntry& b) { return a.sameNode(b); });
    return treeOfNodes(nodes.size() - 1, [&](std::size_t k) {
        const std::vector<std::size_t> blocks = runsOf(entries, nodes[k], nodes[k + 1], [](const BlockEntry& a, const BlockEntry& b) { return a.sameBlock(b); });
        std::vector<std::unique_ptr<BlockCells>> cells(blocks.size() - 1);
        parallelFor(cells.size(), [&](std::size_t b) {
            cells[b] = std::make_unique<BlockCells>(entries[blocks[b]].block());
            for (std::size_t i = blocks[b]; i < blocks[b + 1]; ++i) cells[b]->add(LevelTriangle(surface, entries[i].triangle(), frame));
        }, 1);
        const Index3 at = entries[nodes[k]].node();
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
    const LevelFrame frame(lattice, level);
    std::vector<std::uint8_t> inside(triangles.size());
    parallelChunks(triangles.size(), 512, [&](std::size_t begin, std::size_t end, std::size_t) {
        MaskReader reader(cells);
        for (std::size_t i = begin; i < end; ++i) {
            const LevelTriangle triangle(surface, triangles[i], frame);
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
