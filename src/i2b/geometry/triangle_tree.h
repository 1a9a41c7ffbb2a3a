// The tree behind SurfaceIndex (not for other stages): four children a node, boxes in single precision about
// the soup's own centre and rounded outwards, triangles copied in double precision in the order of the
// leaves. Embree's surface-area builder makes the tree; the walks are ours, so that no answer depends on
// single precision.
#pragma once
#include "i2b/core/raw_vector.h"
#include "i2b/core/vec.h"
#include "i2b/geometry/surface.h"
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

namespace i2b {

inline double maxAbs(const Vec3& v) { return std::max(std::abs(v.x), std::max(std::abs(v.y), std::abs(v.z))); }

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
    RawVector<TreeNode> nodes;   // the root first; empty without triangles
    RawVector<TreeTriangle> triangles;
    RawVector<std::uint32_t> placeOf;   // per triangle of the surface: where it is among these
};

TriangleTree buildTriangleTree(const Surface& surface);

// Four lanes of the compiler's vector extension (two SSE registers of double, one of float).
using Lanes = double __attribute__((vector_size(32)));
using FloatLanes = float __attribute__((vector_size(16)));

// Bit i: there is a child i.
inline unsigned childrenOf(const TreeNode& node) {
    unsigned bits = 0;
    for (unsigned i = 0; i < 4; ++i) bits |= node.child[i] != TreeNode::none ? 1u << i : 0u;
    return bits;
}

inline Box treeBox(const TreeNode& node, std::size_t i) {
    return {{node.lo[0][i], node.lo[1][i], node.lo[2][i]}, {node.hi[0][i], node.hi[1][i], node.hi[2][i]}};
}

// Bit i: lane i of a comparison holds.
template <class Mask>
unsigned bitsOf(const Mask& m) {
#if defined(__SSE2__)
    if constexpr (sizeof m == sizeof(FloatLanes)) return static_cast<unsigned>(__builtin_ia32_movmskps(FloatLanes(m)));
#endif
    unsigned bits = 0;
    for (unsigned i = 0; i < 4; ++i) bits |= m[i] ? 1u << i : 0u;
    return bits;
}

// Children still to visit, nearest last. Sized for any tree: the depth is capped when building.
template <class Key>
struct TreeStack {
    struct Item {
        Key key;
        std::uint32_t child, count;
    };
    std::array<Item, 3 * 64 + 4> items;
    std::size_t size = 0;

    // Goes on to the nearest of the children named by bits, most often the only one; the others wait, and their memory is
    // asked for meanwhile. False: there is none.
    bool enter(const TriangleTree& tree, const TreeNode& node, const Key* key, unsigned bits, Item& item) {
        if (bits == 0) return false;
        const auto take = [&] {
            const auto i = static_cast<unsigned>(std::countr_zero(bits));
            bits &= bits - 1;
            return Item{key[i], node.child[i], node.count[i]};
        };
        item = take();
        const std::size_t base = size;
        while (bits != 0) {
            Item next = take();
            if (next.key < item.key) std::swap(next, item);
            std::size_t at = size++;
            for (; at > base && items[at - 1].key < next.key; --at) items[at] = items[at - 1];
            items[at] = next;
            fetch(tree, next);
        }
        return true;
    }
    // The next one no farther than the limit; false: none.
    bool pop(Key limit, Item& item) {
        while (size > 0) {
            item = items[--size];
            if (item.key <= limit) return true;
        }
        return false;
    }

  private:
    static void fetch(const TriangleTree& tree, const Item& item) {
        const void* const at = item.count == 0 ? static_cast<const void*>(&tree.nodes[item.child]) : &tree.triangles[item.child];
        __builtin_prefetch(at);
        __builtin_prefetch(static_cast<const char*>(at) + 64);
    }
};

} // namespace i2b
