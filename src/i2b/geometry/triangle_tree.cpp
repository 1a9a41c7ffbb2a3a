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

void* createNode(RTCThreadLocalAllocator allocator, unsigned, void*) {
    return new (rtcThreadLocalAlloc(allocator, sizeof(BuildNode), 16)) BuildNode;
}
void setChildren(void* node, void** children, unsigned count, void*) {
    auto* n = static_cast<BuildNode*>(node);
    n->children = count;
    for (unsigned i = 0; i < count; ++i) n->child[i] = reinterpret_cast<std::uintptr_t>(children[i]);
}
void setBounds(void* node, const RTCBounds** bounds, unsigned count, void*) {
    auto* n = static_cast<BuildNode*>(node);
    for (unsigned i = 0; i < count; ++i) {
        const RTCBounds& b = *bounds[i];
        n->lo[0][i] = b.lower_x, n->lo[1][i] = b.lower_y, n->lo[2][i] = b.lower_z;
        n->hi[0][i] = b.upper_x, n->hi[1][i] = b.upper_y, n->hi[2][i] = b.upper_z;
    }
}
void* createLeaf(RTCThreadLocalAllocator allocator, const RTCBuildPrimitive* primitives, std::size_t count,
                 void*) {
    auto* leaf = new (rtcThreadLocalAlloc(allocator, sizeof(BuildLeaf), 16)) BuildLeaf;
    leaf->count = static_cast<std::uint32_t>(count);
    for (std::size_t i = 0; i < count; ++i) leaf->triangles[i] = primitives[i].primID;
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

std::vector<RTCBuildPrimitive> buildPrimitives(const Surface& surface, const Vec3& centre) {
    std::vector<RTCBuildPrimitive> primitives(surface.triangles.size());
    parallelFor(primitives.size(), [&](std::size_t t) {
        Box box;
        for (const std::uint32_t p : surface.triangles[t]) box.add(surface.points[p] - centre);
        primitives[t] = {
            floatBelow(box.lo.x), floatBelow(box.lo.y), floatBelow(box.lo.z), 0,
            floatAbove(box.hi.x), floatAbove(box.hi.y), floatAbove(box.hi.z), static_cast<unsigned>(t)};
    });
    return primitives;
}

// Depth first, children in the builder's order; leaves take the next triangles.
std::uint32_t flatten(const BuildNode& from, TriangleTree& tree) {
    const auto at = static_cast<std::uint32_t>(tree.nodes.size());
    TreeNode& node = tree.nodes.emplace_back();
    for (std::size_t i = 0; i < 4; ++i) {
        const bool used = i < from.children;
        for (std::size_t k = 0; k < 3; ++k) {
            node.lo[k][i] = used ? from.lo[k][i] : std::numeric_limits<float>::infinity();
            node.hi[k][i] = used ? from.hi[k][i] : -std::numeric_limits<float>::infinity();
        }
        const BuildLeaf* leaf = used ? leafOf(from.child[i]) : nullptr;
        node.child[i] = TreeNode::none;
        node.count[i] = leaf ? leaf->count : 0;
    }
    for (std::size_t i = 0; i < from.children; ++i) {
        const BuildLeaf* leaf = leafOf(from.child[i]);
        if (!leaf) {
            const std::uint32_t n = flatten(*reinterpret_cast<const BuildNode*>(from.child[i]), tree);
            tree.nodes[at].child[i] = n;
            continue;
        }
        tree.nodes[at].child[i] = static_cast<std::uint32_t>(tree.triangles.size());
        for (std::uint32_t k = 0; k < leaf->count; ++k) tree.triangles.emplace_back().id = leaf->triangles[k];
    }
    return at;
}

[[noreturn]] void throwOutOfMemory() {
    throw Error(ErrorKind::internal, "the spatial index of the geometry could not be built", "surface index",
                "free some memory and try again");
}

} // namespace

TriangleTree buildTriangleTree(const Surface& surface) {
    TriangleTree tree;
    if (surface.triangles.empty()) return tree;
    Box bounds;
    for (const auto& t : surface.triangles)
        for (const std::uint32_t p : t) bounds.add(surface.points[p]);
    tree.centre = bounds.centre();
    tree.reach = std::max(maxAbs(bounds.lo - tree.centre), maxAbs(bounds.hi - tree.centre));
    tree.magnitude = std::max(maxAbs(bounds.lo), maxAbs(bounds.hi));

    tree.placeOf.resize(surface.triangles.size());
    std::vector<RTCBuildPrimitive> primitives = buildPrimitives(surface, tree.centre);
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
    const auto root = reinterpret_cast<std::uintptr_t>(rtcBuildBVH(&arguments));
    if (root != 0) {
        tree.triangles.reserve(primitives.size());
        tree.nodes.reserve(primitives.size() / 2 + 1);
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
    if (tree.triangles.size() != surface.triangles.size()) throwOutOfMemory();
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
