// The tree behind SurfaceIndex (not for other stages): four children a node, boxes in single precision about
// the soup's own centre and rounded outwards, triangles copied in double precision in the order of the
// leaves. Embree's surface-area builder makes the tree; the walks are ours, so that no answer depends on
// single precision.
#pragma once
#include "i2b/core/vec.h"
#include "i2b/geometry/surface.h"
#include <array>
#include <cstdint>
#include <limits>
#include <vector>

namespace i2b {

struct TreeTriangle {
    Vec3 a, b, c;
    std::uint32_t id = 0; // in the surface
};

struct alignas(64) TreeNode {
    static constexpr std::uint32_t none = ~0u;
    float lo[3][4], hi[3][4];           // m, about the centre; an empty child has lo = inf, hi = -inf
    std::array<std::uint32_t, 4> child; // a node where count is 0, else the first triangle; none: empty
    std::array<std::uint32_t, 4> count; // triangles in the leaf
};

struct TriangleTree {
    Vec3 centre;                 // m
    double reach = 0;            // m, largest coordinate about the centre
    double magnitude = 0;        // m, largest coordinate about the origin
    std::vector<TreeNode> nodes; // the root first; empty without triangles
    std::vector<TreeTriangle> triangles;
};

TriangleTree buildTriangleTree(const Surface& surface);

// Four lanes of the compiler's vector extension (two SSE registers of double, one of float).
using Lanes = double __attribute__((vector_size(32)));
using FloatLanes = float __attribute__((vector_size(16)));

inline Box treeBox(const TreeNode& node, std::size_t i) {
    return {{node.lo[0][i], node.lo[1][i], node.lo[2][i]}, {node.hi[0][i], node.hi[1][i], node.hi[2][i]}};
}

// Children still to visit, nearest first. Sized for any tree: the depth is capped when building.
template <class Key>
struct TreeStack {
    struct Item {
        Key key;
        std::uint32_t child, count;
    };
    std::array<Item, 3 * 64 + 4> items;
    std::size_t size = 0;

    // Pushes and keeps the new items (from `base` on) in descending order of key, so that the nearest is on
    // top.
    void push(std::size_t base, Key key, std::uint32_t child, std::uint32_t count) {
        std::size_t at = size++;
        for (; at > base && items[at - 1].key < key; --at) items[at] = items[at - 1];
        items[at] = {key, child, count};
    }
};

} // namespace i2b
