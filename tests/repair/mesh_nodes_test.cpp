// Proves: every mesh point that hangs on a node goes with it and no other does; a mesh that followed moves point by point is
// the one assembled anew from the moved front; vertices put into edges stay at their edge.
#include "i2b/repair/mesh_nodes.h"
#include "pipeline/stages_run.h"
#include <gtest/gtest.h>
#include <map>
#include <random>
#include <set>

namespace i2b::test {
namespace {

// Random kept cells with divided edges and three layers, some core points moved.
struct Divided {
    explicit Divided(unsigned seed)
        : carved(seed, {5, 6, 4}, 2, 1, 0.15), lattice(carved.grid, carved.kept), front(buildFront(lattice, startThickness)) {
        divideAtRandom(front, seed, 0.2);
        const RawVector<Vec3> at = lattice.latticePoints();
        std::set<std::int32_t> ofFront(front.corePoint.begin(), front.corePoint.end());
        for (std::int32_t p = front.corePoints - 1; p >= 0; p -= 3) { // descending: any order will do
            if (ofFront.contains(p)) continue;
            front.movedPoints.push_back(p), front.movedTo.push_back(at[static_cast<std::size_t>(p)] + Vec3{0.01, 0, 0});
            front.movedSize.push_back(static_cast<float>(p + 1)), front.movedOutside.push_back(static_cast<std::uint8_t>(p % 64));
        }
        LayerOptions options;
        options.count = 3;
        layers = makeLayers(front, options);
        mesh = assembled();
    }
    PolyMesh assembled() const { return assemble({lattice, carved.kept, front, layers, {{"wall", "", 1}}}); }
    std::vector<MeshNode> nodes(const MeshNodes& of) const {
        std::set<MeshNode> found;
        std::vector<MeshNode> some;
        for (std::size_t p = 0; p < mesh.points.size(); ++p) of.nodesOf(static_cast<std::int32_t>(p), some);
        found.insert(some.begin(), some.end());
        return {found.begin(), found.end()};
    }
    CarvedAtRandom carved;
    LatticeMesh lattice;
    Front front;
    LayerStack layers;
    PolyMesh mesh;
};

TEST(MeshNodes, PointsHangOnTheNodesThatTheyFollow) {
    for (const unsigned seed : {1u, 2u, 3u}) {
        Divided d(seed);
        ASSERT_GT(d.front.inserted.size(), 20u);
        const MeshNodes nodes(d.front, d.layers);
        EXPECT_EQ(nodes.corePoints(), d.front.corePoints + static_cast<std::int32_t>(d.front.inserted.size()));
        std::map<std::int32_t, std::set<MeshNode>> hangs, follows;
        std::vector<MeshNode> some;
        for (std::size_t i = 0; i < d.mesh.points.size(); ++i) {
            const auto p = static_cast<std::int32_t>(i);
            some.clear();
            nodes.nodesOf(p, some);
            if (!some.empty()) hangs[p] = {some.begin(), some.end()};
        }
        std::set<MeshNode::Kind> kinds;
        for (const MeshNode& n : d.nodes(nodes)) {
            kinds.insert(n.kind);
            MeshNodes::Moved moved;
            nodes.follow(n, nodes.place(n), moved);
            for (const auto& [p, x] : moved) {
                follows[p].insert(n);
                EXPECT_LT(norm(x - d.mesh.points[static_cast<std::size_t>(p)]), 1e-14); // nothing moves yet
            }
        }
        EXPECT_EQ(kinds.size(), 3u);
        EXPECT_TRUE(hangs == follows) << "seed " << seed;
        const std::vector<std::uint8_t> may = mayMove(d.front, d.mesh.points.size());
        ASSERT_EQ(may.size(), d.mesh.points.size());
        for (std::size_t p = 0; p < may.size(); ++p) EXPECT_EQ(may[p] != 0, hangs.contains(static_cast<std::int32_t>(p)));
    }
}

TEST(MeshNodes, KnowPlaceAndSize) {
    Divided d(2);
    const MeshNodes nodes(d.front, d.layers);
    for (const MeshNode& n : d.nodes(nodes)) {
        const auto id = static_cast<std::size_t>(n.id);
        if (n.kind == MeshNode::core) {
            EXPECT_EQ(nodes.place(n), d.front.movedTo[id]);
            EXPECT_EQ(nodes.h(n), d.front.movedSize[id]);
            EXPECT_EQ(nodes.outside(n), d.front.movedOutside[id]);
            continue;
        }
        const auto [first, last] = nodes.fansOf(n.id);
        if (n.kind == MeshNode::front) {
            ASSERT_LT(first, last);
            for (const std::int32_t* v = first; v != last; ++v) EXPECT_EQ(d.front.corePoint[static_cast<std::size_t>(*v)], n.id);
        }
        const std::size_t v = n.kind == MeshNode::wall ? id : static_cast<std::size_t>(*first);
        EXPECT_EQ(nodes.place(n), n.kind == MeshNode::wall ? wallPoint(d.front, v) : d.front.front[v]);
        EXPECT_EQ(nodes.h(n), d.front.h[v]);
        EXPECT_EQ(nodes.outside(n), d.front.outside[v]);
    }
}

TEST(MeshNodes, MovesAgreeWithTheAssembly) {
    for (const unsigned seed : {1u, 4u}) {
        Divided d(seed);
        MeshNodes nodes(d.front, d.layers);
        std::mt19937 random(seed);
        std::uniform_real_distribution<double> off(-0.02, 0.02);
        for (const MeshNode& n : d.nodes(nodes)) {
            if (random() % 3 == 0) continue;
            const Vec3 to = nodes.place(n) + Vec3{off(random), off(random), off(random)} * d.front.h[0];
            MeshNodes::Moved moved;
            nodes.follow(n, to, moved);
            for (const auto& [p, x] : moved) d.mesh.points[static_cast<std::size_t>(p)] = x;
            nodes.moveTo(n, to);
            ASSERT_EQ(nodes.place(n), to);
        }
        EXPECT_EQ(d.assembled().checksum(), d.mesh.checksum()) << "seed " << seed;
        const std::size_t first = d.front.firstInserted();
        for (std::size_t i = 0; i < d.front.inserted.size(); ++i) {
            const Front::Inserted& inserted = d.front.inserted[i];
            const Vec3 a = d.front.front[static_cast<std::size_t>(inserted.ends[0])], b = d.front.front[static_cast<std::size_t>(inserted.ends[1])];
            EXPECT_EQ(d.front.front[first + i], inserted.frontAt(a, b, wallPoint(d.front, first + i)));
        }
    }
}

// Nothing of the wall goes with a front node, and nothing of the front with a wall node.
TEST(MeshNodes, FrontAndWallMoveApart) {
    Divided d(3);
    const MeshNodes nodes(d.front, d.layers);
    const auto perVertex = static_cast<std::int32_t>(d.layers.count);
    for (std::size_t v = 0; v < d.front.firstInserted(); ++v) {
        const Vec3 by{0.1, 0.2, 0.3};
        MeshNodes::Moved moved;
        const std::int32_t wall = nodes.corePoints() + static_cast<std::int32_t>(v) * perVertex + perVertex - 1;
        nodes.follow({MeshNode::front, d.front.corePoint[v]}, d.front.front[v] + by, moved);
        for (const auto& [p, x] : moved) {
            if (p == wall) { EXPECT_EQ(x, wallPoint(d.front, v)); }
        }
        EXPECT_EQ(moved.front(), (std::pair<std::int32_t, Vec3>{d.front.corePoint[v], d.front.front[v] + by}));
        moved.clear();
        nodes.follow({MeshNode::wall, static_cast<std::int32_t>(v)}, wallPoint(d.front, v) + by, moved);
        ASSERT_EQ(moved.size(), static_cast<std::size_t>(perVertex));
        EXPECT_EQ(moved.back(), (std::pair<std::int32_t, Vec3>{wall, wallPoint(d.front, v) + by}));
        for (const auto& [p, x] : moved) EXPECT_GE(p, nodes.corePoints());
    }
}

} // namespace
} // namespace i2b::test
