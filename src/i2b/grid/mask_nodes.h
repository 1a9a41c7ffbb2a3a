// Trees made node by node: the unit of parallel work is the tree's node of 16^3 leaves (128^3 cells), which one task
// makes on its own, leaves and all. Nothing is touched in advance or pruned afterwards, and no tree is shared.
#pragma once
#include "i2b/grid/mask_ops.h"
#include <algorithm>
#include <memory>

namespace i2b {

using MaskNode = Mask::RootNodeType::ChildNodeType::ChildNodeType;
static_assert(MaskNode::DIM == 128 && MaskNode::NUM_VALUES == 4096);

inline constexpr std::int32_t nodeEdge = 128; // cells
inline openvdb::Coord nodeOrigin(const openvdb::Coord& c) { return {c.x() & ~127, c.y() & ~127, c.z() & ~127}; }

inline std::vector<const MaskNode*> nodesOf(const Mask& mask) {
    std::vector<const MaskNode*> nodes;
    mask.getNodes(nodes);
    return nodes;
}

// Each once, in order.
inline void sortUnique(std::vector<openvdb::Coord>& origins) {
    std::sort(origins.begin(), origins.end());
    origins.erase(std::unique(origins.begin(), origins.end()), origins.end());
}

inline const MaskLeaf* leafAt(const MaskNode* node, openvdb::Index n) {
    return node && node->isChildMaskOn(n) ? node->getTable()[n].getChild() : nullptr;
}

// A node under way: leaves are added where there are any bits.
class NodeBuilder {
  public:
    explicit NodeBuilder(const openvdb::Coord& origin) : origin_(origin) {}
    void add(const openvdb::Coord& origin, const LeafBits& b) {
        if (!bits::any(b)) return;
        auto leaf = std::make_unique<MaskLeaf>(origin);
        setLeafBits(*leaf, b);
        add(std::move(leaf));
    }
    void add(std::unique_ptr<MaskLeaf> leaf) {
        if (!node_) node_ = std::make_unique<MaskNode>(origin_, false);
        node_->addLeaf(leaf.release());
    }
    std::unique_ptr<MaskNode> take() { return std::move(node_); }

  private:
    openvdb::Coord origin_;
    std::unique_ptr<MaskNode> node_;
};

// The tree of the nodes that make(index) gives for indices below n; it may give none, and no two at one place.
template <class Make>
Mask::Ptr treeOfNodes(std::size_t n, const Make& make) {
    std::vector<std::unique_ptr<MaskNode>> nodes(n);
    parallelFor(n, [&](std::size_t i) { nodes[i] = make(i); }, 1);
    auto mask = std::make_shared<Mask>(false);
    using Upper = Mask::RootNodeType::ChildNodeType;
    Upper* upper = nullptr;
    for (std::unique_ptr<MaskNode>& node : nodes) {
        if (!node) continue;
        const openvdb::Coord origin = node->origin();
        if (!upper || upper->origin() != (origin & ~(Upper::DIM - 1))) {
            upper = mask->root().probeNode<Upper>(origin);
            if (!upper) mask->root().addChild(upper = new Upper(origin & ~(Upper::DIM - 1), false));
        }
        upper->addChild(node.release());
    }
    return mask;
}

} // namespace i2b
