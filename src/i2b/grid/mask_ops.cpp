#include "i2b/grid/mask_ops.h"
#include "i2b/core/checksum.h"
#include "i2b/grid/mask_nodes.h"
#include "i2b/grid/octree.h"

namespace i2b {
namespace {

// A second reading of the same tree: probes a leaf and gives its bits, or none.
struct LeafReader {
    explicit LeafReader(const Mask& mask) : accessor(mask) {}
    LeafBits operator()(const openvdb::Coord& origin) { return leafBits(accessor.probeConstLeaf(origin)); }
    MaskReader accessor;
};

openvdb::Coord leafOrigin(const openvdb::Coord& c) { return {c.x() & ~7, c.y() & ~7, c.z() & ~7}; }

Mask::Ptr restricted(const Mask& fine, bool any) {
    auto coarse = std::make_shared<Mask>(false);
    openvdb::tree::ValueAccessor<Mask> touch(*coarse);
    for (const MaskLeaf* leaf : leavesOf(fine)) {
        const openvdb::Coord& o = leaf->origin();
        touch.touchLeaf(leafOrigin({o.x() >> 1, o.y() >> 1, o.z() >> 1}));
    }
    coarse = fillLeaves(coarse, [&] {
        return [reader = LeafReader(fine), any](const openvdb::Coord& o) mutable {
            LeafBits r{};
            for (int i = 0; i < 8; ++i) {
                const int x = i >> 2, y = i >> 1 & 1, z = i & 1;
                const LeafBits b = reader(openvdb::Coord(2 * o.x() + 8 * x, 2 * o.y() + 8 * y, 2 * o.z() + 8 * z));
                if (bits::any(b)) bits::restrictInto(r, b, x, y, z, any);
            }
            return r;
        };
    });
    pruneEmptyLeaves(*coarse);
    return coarse;
}

// Each cell and the one above it along the axis.
Mask::Ptr grownUp(const Mask& mask, int axis) {
    auto grown = std::make_shared<Mask>(false);
    openvdb::tree::ValueAccessor<Mask> touch(*grown);
    for (const MaskLeaf* leaf : leavesOf(mask)) {
        const LeafBits b = leafBits(leaf);
        touch.touchLeaf(leaf->origin());
        const LeafBits carry = bits::neighbourDown({}, b, axis);
        if (bits::any(carry)) {
            openvdb::Coord next = leaf->origin();
            next[axis] += 8;
            touch.touchLeaf(next);
        }
    }
    return fillLeaves(grown, [&] {
        return [reader = LeafReader(mask), axis](const openvdb::Coord& o) mutable {
            openvdb::Coord previous = o;
            previous[axis] -= 8;
            LeafBits b = reader(o);
            const LeafBits below = bits::neighbourDown(b, reader(previous), axis);
            for (std::size_t n = 0; n < 8; ++n) b[n] |= below[n];
            return b;
        };
    });
}

// Every cell and the n <= 8 before and after it along the axis, within [0, size).
Mask::Ptr grownBothWays(const Mask& mask, int axis, int n, const Index3& size) {
    auto grown = std::make_shared<Mask>(false);
    openvdb::tree::ValueAccessor<Mask> touch(*grown);
    const std::int32_t end = size[static_cast<std::size_t>(axis)];
    for (const MaskLeaf* leaf : leavesOf(mask)) {
        const openvdb::Coord& o = leaf->origin();
        for (int step : {-8, 0, 8}) {
            openvdb::Coord at = o;
            at[axis] += step;
            if (at[axis] >= 0 && at[axis] < end) touch.touchLeaf(at);
        }
    }
    grown = fillLeaves(grown, [&] {
        return [reader = LeafReader(mask), axis, n, end](const openvdb::Coord& o) mutable {
            openvdb::Coord before = o, after = o;
            before[axis] -= 8, after[axis] += 8;
            std::array<LeafBits, 3> b{reader(before), reader(o), reader(after)};
            for (int step = 0; step < n; ++step) {
                const std::array<LeafBits, 3> up{bits::neighbourUp(b[0], b[1], axis), bits::neighbourUp(b[1], b[2], axis), bits::neighbourUp(b[2], {}, axis)};
                const std::array<LeafBits, 3> down{bits::neighbourDown(b[0], {}, axis), bits::neighbourDown(b[1], b[0], axis), bits::neighbourDown(b[2], b[1], axis)};
                for (std::size_t i = 0; i < 3; ++i) {
                    for (std::size_t w = 0; w < 8; ++w) b[i][w] |= up[i][w] | down[i][w];
                }
            }
            bits::clip(b[1], axis, end - o[axis]);
            return b[1];
        };
    });
    pruneEmptyLeaves(*grown);
    return grown;
}

// Node by node of a; what b has beside it counts for nothing.
template <class Combine>
Mask::Ptr combined(const Mask& a, const Mask& b, const Combine& combine) {
    const std::vector<const MaskNode*> nodes = nodesOf(a);
    return treeOfNodes(nodes.size(), [&](std::size_t i) {
        const MaskNode* other = MaskReader(b).probeConstNode<MaskNode>(nodes[i]->origin());
        NodeBuilder out(nodes[i]->origin());
        for (auto leaf = nodes[i]->cbeginChildOn(); leaf; ++leaf) {
            LeafBits x = leafBits(&*leaf);
            const LeafBits y = leafBits(leafAt(other, leaf.pos()));
            for (std::size_t n = 0; n < 8; ++n) x[n] = combine(x[n], y[n]);
            out.add(leaf->origin(), x);
        }
        return out.take();
    });
}

} // namespace

std::vector<MaskLeaf*> leavesOf(Mask& mask) {
    std::vector<MaskLeaf*> leaves;
    leaves.reserve(mask.leafCount());
    mask.getNodes(leaves);
    return leaves;
}

std::vector<const MaskLeaf*> leavesOf(const Mask& mask) {
    std::vector<const MaskLeaf*> leaves;
    leaves.reserve(mask.leafCount());
    mask.getNodes(leaves);
    return leaves;
}

void pruneEmptyLeaves(Mask& mask) {
    std::vector<openvdb::Coord> empty;
    for (const MaskLeaf* leaf : leavesOf(std::as_const(mask))) {
        if (leaf->isEmpty()) empty.push_back(leaf->origin());
    }
    for (const openvdb::Coord& o : empty) mask.addTile(1, o, false, false);
}

Mask::Ptr parentsOf(const Mask& fine) { return restricted(fine, true); }
Mask::Ptr evenSamplesOf(const Mask& fine) { return restricted(fine, false); }

Mask::Ptr childrenOf(const Mask& coarse) { return childrenLess(coarse, Mask(false)); }

Mask::Ptr cornersOf(const Mask& cells) { return grownUp(*grownUp(*grownUp(cells, 0), 1), 2); }

Mask::Ptr unionOf(const Mask& a, const Mask& b) {
    auto result = std::make_shared<Mask>(a);
    result->topologyUnion(b);
    return result;
}
Mask::Ptr differenceOf(const Mask& a, const Mask& b) {
    return combined(a, b, [](std::uint64_t x, std::uint64_t y) { return x & ~y; });
}
Mask::Ptr intersectionOf(const Mask& a, const Mask& b) {
    return combined(a, b, [](std::uint64_t x, std::uint64_t y) { return x & y; });
}

// Separable: a 26-neighbour dilation by n is one by n along each axis in turn. (OpenVDB's own dilation with several
// iterations in one call leaves out cells of the Chebyshev ball.)
Mask::Ptr dilated(const Mask& cells, int n, const Index3& size) {
    auto result = std::make_shared<Mask>(cells);
    for (; n > 0; n -= 8) { // one node to each side is looked at in a pass
        for (int axis = 0; axis < 3; ++axis) result = grownBothWays(*result, axis, std::min(n, 8), size);
    }
    return result;
}

std::uint64_t countOf(const Mask& mask) { return mask.activeVoxelCount(); }

void addTo(Checksum& sum, const Mask& mask) {
    for (const MaskLeaf* leaf : leavesOf(mask)) {
        const Index3 o = toIndex(leaf->origin());
        const LeafBits b = leafBits(leaf);
        sum.bytes(o.data(), sizeof o);
        sum.bytes(b.data(), sizeof b);
    }
}

} // namespace i2b
