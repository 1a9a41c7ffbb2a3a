// Proves: the front of random kept cells is a manifold, closed but for the domain's sides, and extrudes: at
// every vertex one direction leaves all faces outwards and keeps to the sides.
#include "carve/kept_checks.h"
#include "i2b/front/front.h"
#include <gtest/gtest.h>
#include <tbb/global_control.h>

namespace i2b::test {
namespace {

class RandomFront : public testing::TestWithParam<unsigned> {};

Vec3 pointOf(const FrontMesh& mesh, FrontMesh::VertexHandle v) {
    const auto& p = mesh.point(v);
    return {p[0], p[1], p[2]};
}

TEST_P(RandomFront, IsManifoldAndExtrudes) {
    for (unsigned seed = 20 * GetParam(); seed < 20 * GetParam() + 20; ++seed) {
        const CarvedAtRandom c(seed, {5, 6, 4}, 1 + static_cast<int>(seed % 3),
                               1 + static_cast<int>(seed / 3 % 2), 0.05 + 0.05 * (seed % 7), seed % 2 == 1);
        const LatticeMesh lattice(c.grid, c.kept);
        const RawVector<Vec3> core = lattice.latticePoints();
        const Front front = buildFront(lattice, 0.07);
        ASSERT_EQ(front.validate(), "") << "seed " << seed;
        const Box domain = lattice.lattice().domain();
        for (auto v : front.mesh.vertices()) {
            const auto i = static_cast<std::size_t>(v.idx());
            ASSERT_TRUE(front.mesh.is_manifold(v)) << "seed " << seed;
            EXPECT_EQ(front.front[i], core[static_cast<std::size_t>(front.corePoint[i])]);
            const Vec3 wall = pointOf(front.mesh, v);
            for (int side = 0; side < 6; ++side) {
                const double plane = side % 2 ? domain.hi[side / 2] : domain.lo[side / 2];
                EXPECT_EQ(front.front[i][side / 2] == plane, (front.outside[i] >> side & 1) != 0);
                if (!(front.outside[i] >> side & 1)) continue;
                EXPECT_EQ(wall[side / 2], plane); // stays in the plane
            }
        }
        for (auto f : front.mesh.faces()) {
            Vec3 normal;
            std::vector<std::size_t> corners;
            for (auto v : front.mesh.fv_range(f)) corners.push_back(static_cast<std::size_t>(v.idx()));
            const Vec3& o = front.front[corners[0]];
            for (std::size_t i = 1; i + 1 < corners.size(); ++i)
                normal += cross(front.front[corners[i]] - o, front.front[corners[i + 1]] - o);
            normal = normalized(normal);
            for (std::size_t i : corners) {
                const Vec3 d{double(front.direction[i][0]), double(front.direction[i][1]),
                             double(front.direction[i][2])};
                ASSERT_GE(dot(d, normal), 1 - 1e-9) << "seed " << seed;
            }
        }
    }
}

TEST_P(RandomFront, IsTheSameOnAnyNumberOfThreads) {
    const CarvedAtRandom c(GetParam(), {9, 8, 7}, 3, 1, 0.2);
    const LatticeMesh lattice(c.grid, c.kept);
    const std::uint64_t expected = buildFront(lattice, 0.07).checksum();
    for (std::size_t threads : {1, 2, 3, 8}) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        EXPECT_EQ(buildFront(LatticeMesh(c.grid, c.kept), 0.07).checksum(), expected)
            << threads << " threads";
    }
}

INSTANTIATE_TEST_SUITE_P(Many, RandomFront, testing::Range(0u, 5u));

// validate() is no rubber stamp: it finds a hole, a lonely vertex, short arrays and faces out of order.
TEST(FrontValidate, NamesTheFault) {
    const CarvedAtRandom c(3, {5, 6, 4}, 1, 1, 0.05);
    const LatticeMesh lattice(c.grid, c.kept);
    const Front sound = buildFront(lattice, 0.07);
    ASSERT_GT(sound.ownerCell.size(), 1u);
    Front front = sound;
    front.h.pop_back();
    EXPECT_NE(front.validate(), "");
    front = sound;
    front.level.pop_back();
    EXPECT_NE(front.validate(), "");
    front = sound;
    std::swap(front.ownerCell.front(), front.ownerCell.back());
    EXPECT_NE(front.validate(), "");
    front = sound;
    front.outside.assign(front.outside.size(), 0); // now no side excuses an open edge
    bool open = false;
    for (auto e : front.mesh.edges()) open = open || front.mesh.is_boundary(e);
    EXPECT_EQ(front.validate().empty(), !open);
    front = sound;
    front.mesh.add_vertex({0, 0, 0});
    front.front.push_back({}), front.corePoint.push_back(0), front.h.push_back(1),
        front.direction.push_back({}), front.outside.push_back(0);
    EXPECT_NE(front.validate(), "");
}

} // namespace
} // namespace i2b::test
