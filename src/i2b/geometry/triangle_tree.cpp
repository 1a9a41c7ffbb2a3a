#include "i2b/geometry/triangle_tree.h"
#include "i2b/core/error.h"
#include "i2b/core/parallel.h"
#include <algorithm>
#include <cmath>
#include <embree3/rtcore.h>

namespace i2b {
namespace {

constexpr unsigned leafSize = 4;

// What Embree's builder hands back, in its own memory: inner nodes and leaves, told apart by the lowest bit of their address;
// flattened afterwards.
struct BuildLeaf {
    std::uint32_t count = 0;
    std::uint32_t triangles[leafSize] = {};
};
struct BuildNode {
    std::uint32_t children = 0;
    float lo[3][4] = {}, hi[3][4] = {}; // as in TreeNode
    std::uintptr_t child[4] = {};
};

const BuildLeaf* leafOf(std::uintptr_t child) { return child & 1 ? reinterpret_cast<const BuildLeaf*>(child - 1) : nullptr; }

// The user's pointer of what follows is the fence that tells the thread checker when they are done.
void leave(void* fence) { static_cast<const LoopFence*>(fence)->leave(); }

void* createNode(RTCThreadLocalAllocator allocator, unsigned, void* fence) {
    auto* const node = new (rtcThreadLocalAlloc(allocator, sizeof(BuildNode), 16)) BuildNode;
    leave(fence);
    return node;
}
void setChildren(void* node, void** children, unsigned count, void* fence) {
    auto* n = static_cast<BuildNode*>(node);
    n->children = count;
    for (unsigned i = 0; i < count; ++i) n->child[i] = reinterpret_cast<std::uintptr_t>(children[i]);
    leave(fence);
}
void setBounds(void* node, const RTCBounds** bounds, unsigned count, void* fence) {
    auto* n = static_cast<BuildNode*>(node);
    for (unsigned i = 0; i < count; ++i) {
        const RTCBounds& b = *bounds[i];
        n->lo[0][i] = b.lower_x, n->lo[1][i] = b.lower_y, n->lo[2][i] = b.lower_z;
        n->hi[0][i] = b.upper_x, n->hi[1][i] = b.upper_y, n->hi[2][i] = b.upper_z;
    }
    leave(fence);
}
void* createLeaf(RTCThreadLocalAllocator allocator, const RTCBuildPrimitive* primitives, std::size_t count,
                 void* fence) {
    auto* leaf = new (rtcThreadLocalAlloc(allocator, sizeof(BuildLeaf), 16)) BuildLeaf;
    leaf->count = static_cast<std::uint32_t>(count);
    for (std::size_t i = 0; i < count; ++i) leaf->triangles[i] = primitives[i].primID;
    leave(fence);
    return reinterpret_cast<char*>(leaf) + 1;
}

// Rounded outwards: a float that is not above / not below x.
float floatBelow(double x) {
    const float f = static_cast<float>(x);
    return std::nextafter(f, -std::numeric_limits<float>::infinity());
}
float floatAbove(double x) {
    const float f = static_cast<float>(x);
    return std::nextafter(f, std::numeric_limits<float>::infinity());
}

RawVector<RTCBuildPrimitive> buildPrimitives(const Surface& surface, const Vec3& centre) {
    RawVector<RTCBuildPrimitive> primitives(surface.triangles.size());
    parallelFor(primitives.size(), [&](std::size_t t) {
        Box box;
        for (const std::uint32_t p : surface.triangles[t]) box.add(surface.points[p] - centre);
        primitives[t] = {
            floatBelow(box.lo.x), floatBelow(box.lo.y), floatBelow(box.lo.z), 0,
            floatAbove(box.hi.x), floatAbove(box.hi.y), floatAbove(box.hi.z), static_cast<unsigned>(t)};
    });
    return primitives;
}

[[noreturn]] void throwOutOfMemory() {
    throw Error(ErrorKind::internal, "the spatial index of the geometry could not be built", "surface index",
                "free some memory and try again");
}

// How much of the tree's arrays something takes, or where it begins there.
struct Extent {
    std::uint32_t nodes = 0, triangles = 0;
};

// Writes a node at `next` and takes the leaves of it; descend(child, next) gives the place of each inner child. Depth first,
// children in the builder's order.
template <class Descend>
std::uint32_t place(const BuildNode& from, Extent& next, TriangleTree& tree, const Descend& descend) {
    const std::uint32_t at = next.nodes++;
    TreeNode& node = tree.nodes[at];
    for (std::size_t i = 0; i < 4; ++i) {
        const bool used = i < from.children;
        for (std::size_t k = 0; k < 3; ++k) {
            node.lo[k][i] = used ? from.lo[k][i] : std::numeric_limits<float>::infinity();
            node.hi[k][i] = used ? from.hi[k][i] : -std::numeric_limits<float>::infinity();
        }
        const BuildLeaf* leaf = used ? leafOf(from.child[i]) : nullptr;
        node.child[i] = TreeNode::none;
        node.count[i] = leaf ? leaf->count : 0;
        if (!used) continue;
        if (!leaf) {
            node.child[i] = descend(*reinterpret_cast<const BuildNode*>(from.child[i]), next);
            continue;
        }
        node.child[i] = next.triangles;
        for (std::uint32_t k = 0; k < leaf->count; ++k) tree.triangles[next.triangles++].id = leaf->triangles[k];
    }
    return at;
}

std::uint32_t placeAll(const BuildNode& from, Extent& next, TriangleTree& tree) {
    return place(from, next, tree, [&](const BuildNode& child, Extent& n) { return placeAll(child, n, tree); });
}

Extent extentOf(const BuildNode& from) {
    Extent sum{1, 0};
    for (std::size_t i = 0; i < from.children; ++i) {
        if (const BuildLeaf* leaf = leafOf(from.child[i])) {
            sum.triangles += leaf->count;
            continue;
        }
        const Extent e = extentOf(*reinterpret_cast<const BuildNode*>(from.child[i]));
        sum.nodes += e.nodes, sum.triangles += e.triangles;
    }
    return sum;
}

// The nodes so many steps below one, depth first.
void collectBelow(const BuildNode& from, int steps, std::vector<const BuildNode*>& out) {
    if (steps == 0) return out.push_back(&from);
    for (std::size_t i = 0; i < from.children; ++i)
        if (!leafOf(from.child[i])) collectBelow(*reinterpret_cast<const BuildNode*>(from.child[i]), steps - 1, out);
}

// Where the subtrees begin that lie so many steps below a node and take so much each.
void collectStarts(const BuildNode& from, int steps, const std::vector<Extent>& taken, Extent& next, std::vector<Extent>& starts) {
    ++next.nodes;
    for (std::size_t i = 0; i < from.children; ++i) {
        if (const BuildLeaf* leaf = leafOf(from.child[i])) {
            next.triangles += leaf->count;
        } else if (steps > 1) {
            collectStarts(*reinterpret_cast<const BuildNode*>(from.child[i]), steps - 1, taken, next, starts);
        } else {
            const Extent& e = taken[starts.size()];
            starts.push_back(next);
            next.nodes += e.nodes, next.triangles += e.triangles;
        }
    }
}

// The nodes above these subtrees; below: the next of them.
std::uint32_t placeTop(const BuildNode& from, int steps, const std::vector<Extent>& taken, const std::vector<Extent>& starts, std::size_t& below, Extent& next,
                       TriangleTree& tree) {
    return place(from, next, tree, [&](const BuildNode& child, Extent& n) {
        if (steps > 1) return placeTop(child, steps - 1, taken, starts, below, n, tree);
        const Extent &start = starts[below], &e = taken[below];
        ++below;
        n.nodes += e.nodes, n.triangles += e.triangles;
        return start.nodes;
    });
}

// Subtrees some steps below the root are counted and then written side by side, each where it lies depth first; what is above them at
// the end, so that they are the first to touch the memory.
void flatten(const BuildNode& root, TriangleTree& tree) {
    constexpr int steps = 5; // at most 1024 of them
    std::vector<const BuildNode*> below;
    collectBelow(root, steps, below);
    std::vector<Extent> taken(below.size()), starts;
    parallelFor(below.size(), [&](std::size_t i) { taken[i] = extentOf(*below[i]); }, 4);
    Extent all, next;
    collectStarts(root, steps, taken, all, starts);
    if (all.triangles != tree.triangles.size()) throwOutOfMemory();
    tree.nodes.resize(all.nodes);
    parallelFor(below.size(), [&](std::size_t i) {
        Extent from = starts[i];
        placeAll(*below[i], from, tree);
    }, 4);
    std::size_t done = 0;
    placeTop(root, steps, taken, starts, done, next, tree);
}

} // namespace

TriangleTree buildTriangleTree(const Surface& surface) {
    TriangleTree tree;
    if (surface.triangles.empty()) return tree;
    const Box bounds = surface.bounds();
    tree.centre = bounds.centre();
    tree.reach = std::max(maxAbs(bounds.lo - tree.centre), maxAbs(bounds.hi - tree.centre));
    tree.magnitude = std::max(maxAbs(bounds.lo), maxAbs(bounds.hi));

    tree.placeOf.resize(surface.triangles.size());
    RawVector<RTCBuildPrimitive> primitives = buildPrimitives(surface, tree.centre);
    RTCDevice device = rtcNewDevice(nullptr);
    RTCBVH bvh = rtcNewBVH(device);
    RTCBuildArguments arguments = rtcDefaultBuildArguments();
    arguments.maxBranchingFactor = 4;
    arguments.maxDepth = 60;
    arguments.maxLeafSize = leafSize;
    arguments.traversalCost = 1;
    arguments.intersectionCost = 1;
    arguments.bvh = bvh;
    arguments.primitives = primitives.data();
    arguments.primitiveCount = arguments.primitiveArrayCapacity = primitives.size();
    arguments.createNode = createNode;
    arguments.setNodeChildren = setChildren;
    arguments.setNodeBounds = setBounds;
    arguments.createLeaf = createLeaf;
    LoopFence fence;
    arguments.userPtr = &fence;
    const auto root = reinterpret_cast<std::uintptr_t>(rtcBuildBVH(&arguments));
    fence.join();
    if (root != 0) {
        tree.triangles.resize(primitives.size());
        if (!leafOf(root)) {
            flatten(*reinterpret_cast<const BuildNode*>(root), tree);
        } else { // so few triangles that the root is a leaf
            BuildNode top;
            top.children = 1;
            top.child[0] = root;
            const auto r = floatAbove(tree.reach);
            for (std::size_t k = 0; k < 3; ++k) top.lo[k][0] = -r, top.hi[k][0] = r;
            flatten(top, tree);
        }
    }
    rtcReleaseBVH(bvh);
    rtcReleaseDevice(device);
    if (tree.nodes.empty()) throwOutOfMemory();
    parallelFor(tree.triangles.size(), [&](std::size_t i) {
        TreeTriangle& t = tree.triangles[i];
        tree.placeOf[t.id] = static_cast<std::uint32_t>(i);
        const auto& v = surface.triangles[t.id];
        t.a = surface.points[v[0]];
        t.b = surface.points[v[1]];
        t.c = surface.points[v[2]];
    });
    return tree;
}

} // namespace i2b
