// Topology operations on mask trees that OpenVDB does not have: between levels, and from cells to their vertices.
// All run leaf-parallel on words; all keep trees of leaf nodes only, and none depends on the number of threads.
#pragma once
#include "i2b/core/parallel.h"
#include "i2b/grid/cell_grid.h"
#include "i2b/grid/leaf_bits.h"

namespace i2b {

using MaskLeaf = Mask::LeafNodeType;
using MaskReader = openvdb::tree::ValueAccessor<const Mask>;

inline LeafBits leafBits(const MaskLeaf* leaf) {
    LeafBits b{};
    if (leaf) {
        for (openvdb::Index n = 0; n < 8; ++n) b[n] = leaf->getValueMask().getWord<openvdb::Index64>(n);
    }
    return b;
}
inline void setLeafBits(MaskLeaf& leaf, const LeafBits& b) {
    openvdb::util::NodeMask<3> m = leaf.getValueMask();
    for (openvdb::Index n = 0; n < 8; ++n) m.getWord<openvdb::Index64>(n) = b[n];
    leaf.setValueMask(m);
}
inline void setLeafBitsOn(openvdb::tree::ValueAccessor<Mask>& write, const openvdb::Coord& origin, const LeafBits& b) {
    MaskLeaf* leaf = write.touchLeaf(origin);
    LeafBits all = leafBits(leaf);
    for (std::size_t n = 0; n < 8; ++n) all[n] |= b[n];
    setLeafBits(*leaf, all);
}
inline openvdb::Coord toCoord(const Index3& c) { return {c[0], c[1], c[2]}; }
inline Index3 toIndex(const openvdb::Coord& c) { return {c.x(), c.y(), c.z()}; }

// Leaf nodes in tree order, which depends on topology alone.
std::vector<MaskLeaf*> leavesOf(Mask& mask);
std::vector<const MaskLeaf*> leavesOf(const Mask& mask);

// fill(origin) gives the bits of every leaf in topology (in parallel); empty leaves are dropped.
template <class Fill>
Mask::Ptr fillLeaves(Mask::Ptr topology, const Fill& fill) {
    const std::vector<MaskLeaf*> leaves = leavesOf(*topology);
    parallelChunks(leaves.size(), 64, [&](std::size_t begin, std::size_t end, std::size_t) {
        auto local = fill(); // one set of readers a chunk
        for (std::size_t i = begin; i < end; ++i) setLeafBits(*leaves[i], local(leaves[i]->origin()));
    });
    return topology;
}
void pruneEmptyLeaves(Mask& mask);

Mask::Ptr parentsOf(const Mask& fine);                   // parents of any cell
Mask::Ptr evenSamplesOf(const Mask& fine);               // coarse v where fine 2v is set (vertices)
Mask::Ptr childrenOf(const Mask& coarse);
Mask::Ptr cornersOf(const Mask& cells);                  // vertices c + {0,1}^3
Mask::Ptr unionOf(const Mask& a, const Mask& b);
Mask::Ptr differenceOf(const Mask& a, const Mask& b);
Mask::Ptr intersectionOf(const Mask& a, const Mask& b);
// Grown by n cells in all 26 directions, within [0, size).
Mask::Ptr dilated(const Mask& cells, int n, const Index3& size);
std::uint64_t countOf(const Mask& mask);
// No cells; Mask::empty() asks for no nodes either, which remain where leaves were pruned.
inline bool isEmpty(const Mask& mask) { return !mask.cbeginLeaf(); }
void addTo(class Checksum& sum, const Mask& mask);

} // namespace i2b
