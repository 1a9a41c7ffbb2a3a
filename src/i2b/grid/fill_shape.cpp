#include "i2b/grid/fill_shape.h"
#include "i2b/grid/mask_ops.h"

namespace i2b {
namespace {

// 2^size cells along each axis, aligned to as many.
struct Block {
    Index3 origin;
    int size;
};

constexpr int nodeSize = 3; // a leaf node is 8 cells along each axis

class ShapeFill {
  public:
    ShapeFill(const Shape& shape, const Lattice& lattice, const LevelTriple& level)
        : shape_(shape), lattice_(lattice), level_(level), cells_(lattice.cells(level)), grain_(grainOf(shape)) {}

    Mask::Ptr run();

  private:
    std::vector<Block> firstBlocks() const;
    Cover cover(const Block& block) const;
    bool beyondDomain(const Block& b) const {
        return b.origin[0] >= cells_[0] || b.origin[1] >= cells_[1] || b.origin[2] >= cells_[2];
    }
    bool acrossDomain(const Block& b) const {
        const std::int32_t n = 1 << b.size;
        return b.origin[0] + n > cells_[0] || b.origin[1] + n > cells_[1] || b.origin[2] + n > cells_[2];
    }
    void addBits(const Block& block, const Index3& node, LeafBits& bits) const;
    LeafBits nodeBits(const Index3& origin) const;

    const Shape& shape_;
    const Lattice& lattice_;
    LevelTriple level_;
    Index3 cells_;
    double grain_;
};

// The smallest aligned blocks of one size that hold the shape, two along each axis at most.
std::vector<Block> ShapeFill::firstBlocks() const {
    const Box bounds = boundsOf(shape_), domain = lattice_.domain();
    if (!bounds.overlaps(domain)) return {};
    Index3 lo = lattice_.cellAt(level_, bounds.lo), hi = lattice_.cellAt(level_, bounds.hi);
    int size = nodeSize;
    for (std::size_t i = 0; i < 3; ++i) {
        lo[i] = std::max(lo[i] - 1, 0), hi[i] = std::min(hi[i] + 1, cells_[i] - 1); // a plane belongs to both cells
        while ((hi[i] >> size) - (lo[i] >> size) > 1) ++size;
    }
    std::vector<Block> blocks;
    for (std::int32_t x = lo[0] >> size; x <= hi[0] >> size; ++x) {
        for (std::int32_t y = lo[1] >> size; y <= hi[1] >> size; ++y) {
            for (std::int32_t z = lo[2] >> size; z <= hi[2] >> size; ++z) {
                blocks.push_back({{x << size, y << size, z << size}, size});
            }
        }
    }
    return blocks;
}

Cover ShapeFill::cover(const Block& block) const {
    if (beyondDomain(block)) return Cover::none;
    const std::int32_t n = 1 << block.size;
    const Index3& o = block.origin;
    const Box box{lattice_.corner(level_, o), lattice_.corner(level_, {o[0] + n, o[1] + n, o[2] + n})};
    const Vec3 e = box.extent();
    if (block.size == 0 || std::max(e.x, std::max(e.y, e.z)) <= grain_) return meets(shape_, box) ? Cover::all : Cover::none;
    return coverOf(shape_, box);
}

void ShapeFill::addBits(const Block& block, const Index3& node, LeafBits& bits) const {
    const Cover here = cover(block);
    if (here == Cover::none) return;
    const int n = 1 << block.size;
    if (here == Cover::all) {
        const int z = block.origin[2] - node[2];
        const std::uint64_t row = ((std::uint64_t(1) << n) - 1) << z;
        for (int x = block.origin[0] - node[0], endX = x + n; x < endX; ++x) {
            for (int y = block.origin[1] - node[1], endY = y + n; y < endY; ++y) bits[std::size_t(x)] |= row << (8 * y);
        }
        return;
    }
    for (int i = 0; i < 8; ++i) {
        const Index3& o = block.origin;
        addBits({{o[0] + (i >> 2) * n / 2, o[1] + (i >> 1 & 1) * n / 2, o[2] + (i & 1) * n / 2}, block.size - 1}, node, bits);
    }
}

LeafBits ShapeFill::nodeBits(const Index3& origin) const {
    LeafBits bits{};
    const Block node{origin, nodeSize};
    if (cover(node) == Cover::all) {
        bits.fill(~std::uint64_t(0));
    } else {
        for (int i = 0; i < 8; ++i) {
            addBits({{origin[0] + (i >> 2) * 4, origin[1] + (i >> 1 & 1) * 4, origin[2] + (i & 1) * 4}, 2}, origin, bits);
        }
    }
    for (int a = 0; a < 3; ++a) bits::clip(bits, a, cells_[std::size_t(a)] - origin[std::size_t(a)]);
    return bits;
}

// Round by round, each of blocks of one size: judged in parallel, sorted out in order.
Mask::Ptr ShapeFill::run() {
    auto mask = std::make_shared<Mask>(false);
    std::vector<Block> blocks = firstBlocks();
    std::vector<Index3> nodes; // that the border runs through, or the domain's
    while (!blocks.empty()) {
        std::vector<Cover> covers(blocks.size());
        parallelFor(blocks.size(), [&](std::size_t i) { covers[i] = cover(blocks[i]); }, 64);
        std::vector<Block> next;
        for (std::size_t i = 0; i < blocks.size(); ++i) {
            const auto& [o, size] = blocks[i];
            const std::int32_t n = 1 << size;
            if (covers[i] == Cover::none) continue;
            if (covers[i] == Cover::all && !acrossDomain(blocks[i])) {
                mask->sparseFill(openvdb::CoordBBox(toCoord(o), {o[0] + n - 1, o[1] + n - 1, o[2] + n - 1}), true, true);
            } else if (size == nodeSize) {
                nodes.push_back(o);
            } else {
                for (int k = 0; k < 8; ++k) {
                    next.push_back({{o[0] + (k >> 2) * n / 2, o[1] + (k >> 1 & 1) * n / 2, o[2] + (k & 1) * n / 2}, size - 1});
                }
            }
        }
        blocks = std::move(next);
    }
    mask->voxelizeActiveTiles();
    std::vector<LeafBits> bits(nodes.size());
    parallelFor(nodes.size(), [&](std::size_t i) { bits[i] = nodeBits(nodes[i]); }, 16);
    openvdb::tree::ValueAccessor<Mask> write(*mask);
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        if (bits::any(bits[i])) setLeafBits(*write.touchLeaf(toCoord(nodes[i])), bits[i]);
    }
    return mask;
}

} // namespace

Mask::Ptr cellsOf(const Shape& shape, const Lattice& lattice, const LevelTriple& level) {
    return ShapeFill(shape, lattice, level).run();
}

Mask::Ptr cellsOf(const Box& box, const Lattice& lattice, const LevelTriple& level) {
    auto mask = std::make_shared<Mask>(false);
    if (!box.overlaps(lattice.domain())) return mask;
    const Index3 n = lattice.cells(level);
    const Vec3 s = lattice.cellSize(level);
    openvdb::Coord lo, hi;
    for (int a = 0; a < 3; ++a) {
        // A box that ends on the plane between two cells, but for rounding, does not reach into the next.
        const double from = (box.lo[a] - lattice.origin[a]) / s[a], to = (box.hi[a] - lattice.origin[a]) / s[a];
        const double slack = 1e-9 * (1 + std::abs(from) + std::abs(to));
        const double last = double(n[std::size_t(a)]) - 1;
        lo[a] = static_cast<std::int32_t>(std::clamp(std::floor(from + slack), 0.0, last));
        hi[a] = static_cast<std::int32_t>(std::clamp(std::ceil(to - slack) - 1, double(lo[a]), last));
    }
    mask->sparseFill(openvdb::CoordBBox(lo, hi), true, true);
    mask->voxelizeActiveTiles();
    return mask;
}

} // namespace i2b
