#include "i2b/geometry/triangle_tree.h"
#include "i2b/core/error.h"
#include "i2b/core/parallel.h"
#include <algorithm>
#include <cmath>
#include <embree3/rtcore.h>

namespace i2b {
namespace {

// What Embree's builder hands back: a node or a leaf, in its own memory; flattened afterwards.
struct BuildNode {
    std::uint32_t leafCount = 0; // 0: an inner node
    std::uint32_t children = 0;
    BuildNode* child[4] = {};
    RTCBounds bounds[4] = {};
    std::uint32_t triangles[4] = {};
};

constexpr unsigned leafSize = 4;

void* createNode(RTCThreadLocalAllocator allocator, unsigned, void*) {
    return new (rtcThreadLocalAlloc(allocator, sizeof(BuildNode), 16)) BuildNode;
}
void setChildren(void* node, void** children, unsigned count, void*) {
    auto* n = static_cast<BuildNode*>(node);
    n->children = count;
    for (unsigned i = 0; i < count; ++i) n->child[i] = static_cast<BuildNode*>(children[i]);
}
void setBounds(void* node, const RTCBounds** bounds, unsigned count, void*) {
    for (unsigned i = 0; i < count; ++i) static_cast<BuildNode*>(node)->bounds[i] = *bounds[i];
}
void* createLeaf(RTCThreadLocalAllocator allocator, const RTCBuildPrimitive* primitives, std::size_t count,
                 void*) {
    auto* n = new (rtcThreadLocalAlloc(allocator, sizeof(BuildNode), 16)) BuildNode;
    n->leafCount = static_cast<std::uint32_t>(count);
    for (std::size_t i = 0; i < count; ++i) n->triangles[i] = primitives[i].primID;
    return n;
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
    TreeNode node;
    for (std::size_t i = 0; i < 4; ++i) {
        const bool used = i < from.children;
        const RTCBounds& b = from.bounds[i];
        const float lo[3] = {b.lower_x, b.lower_y, b.lower_z}, hi[3] = {b.upper_x, b.upper_y, b.upper_z};
        for (int k = 0; k < 3; ++k) {
            node.lo[k][i] = used ? lo[k] : std::numeric_limits<float>::infinity();
            node.hi[k][i] = used ? hi[k] : -std::numeric_limits<float>::infinity();
        }
        node.child[i] = TreeNode::none;
        node.count[i] = used ? from.child[i]->leafCount : 0;
    }
    tree.nodes.push_back(node);
    for (std::size_t i = 0; i < from.children; ++i) {
        const BuildNode& child = *from.child[i];
        if (child.leafCount == 0) {
            const std::uint32_t n = flatten(child, tree);
            tree.nodes[at].child[i] = n;
            continue;
        }
        tree.nodes[at].child[i] = static_cast<std::uint32_t>(tree.triangles.size());
        for (std::uint32_t k = 0; k < child.leafCount; ++k) {
            tree.triangles.emplace_back();
            tree.triangles.back().id = child.triangles[k];
        }
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
    const auto* root = static_cast<const BuildNode*>(rtcBuildBVH(&arguments));
    if (root != nullptr) {
        tree.triangles.reserve(primitives.size());
        tree.nodes.reserve(primitives.size() / 2 + 1);
        if (root->leafCount == 0) {
            flatten(*root, tree);
        } else { // so few triangles that the root is a leaf
            BuildNode top;
            top.children = 1;
            top.child[0] = const_cast<BuildNode*>(root);
            const auto r = floatAbove(tree.reach);
            top.bounds[0] = {-r, -r, -r, 0, r, r, r, 0};
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
