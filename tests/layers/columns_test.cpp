// Proves: columns leave the wall along its most normal direction and end at the front, never lean more than straight ones in
// their layers, and stay within the sides of the domain; warped faces under thin layers are cut until OpenFOAM's centres of
// their cells are inside, and only these; walls at a sharp angle to a side are steepened.
#include "carve/kept_checks.h"
#include "i2b/layers/layer_stack.h"
#include "i2b/layers/side_angles.h"
#include "i2b/layers/wall_normals.h"
#include "i2b/layers/warp.h"
#include <gtest/gtest.h>
#include <tbb/global_control.h>

namespace i2b::test {
namespace {

// A front of a random shape whose wall positions are pushed aside by up to `lean` cell sizes, along each axis.
struct Leaning {
    explicit Leaning(double lean) : carved(5, {6, 5, 5}, 2, 1, 0.1), lattice(carved.grid, carved.kept), front(buildFront(lattice, 0.4)) {
        for (std::size_t v = 0; v < front.front.size(); ++v) {
            Vec3 b = front.wall(v);
            for (int axis = 0; axis < 3; ++axis) {
                if (front.outside[v] >> (2 * axis) & 3) continue;
                b[axis] += lean * front.h[v] * std::sin(12.9898 * static_cast<double>(v) + 78.233 * axis);
            }
            front.mesh.set_point(FrontMesh::VertexHandle(static_cast<int>(v)), {b.x, b.y, b.z});
        }
    }
    CarvedAtRandom carved;
    LatticeMesh lattice;
    Front front;
};

LayerStack thinStack(const Front& front, int count, double first) {
    LayerOptions o;
    o.count = count, o.first = first, o.growth = 1.2;
    return makeLayers(front, o);
}

std::vector<Vec3> pointsOf(const Front& front, const LayerStack& stack, std::size_t v) {
    std::vector<Vec3> x(static_cast<std::size_t>(stack.pointsOf(v)));
    placeLayers(stack, v, front.front[v], front.wall(v), x.data());
    return x;
}

TEST(MostNormal, IsTheAxisOfTheSmallestCone) {
    const std::vector<Vec3> edge{{1, 0, 0}, {0, 1, 0}};
    EXPECT_NEAR(norm(mostNormal(edge) - normalized(Vec3{1, 1, 0})), 0, 1e-12);
    const std::vector<Vec3> corner{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, normalized(Vec3{1, 1, 0})};
    EXPECT_NEAR(norm(mostNormal(corner) - normalized(Vec3{1, 1, 1})), 0, 1e-12);
    // Many faces on one side do not outweigh one on the other.
    const std::vector<Vec3> uneven{{1, 0, 0}, {1, 0, 0}, normalized(Vec3{1, 0.1, 0}), {0, 1, 0}};
    EXPECT_NEAR(norm(mostNormal(uneven) - normalized(Vec3{1, 1, 0})), 0, 1e-12);
}

TEST(WallNormals, SeeTheWallAndKeepToTheSides) {
    const Leaning s(0.1);
    const std::vector<Vec3> normals = wallNormals(s.front);
    std::size_t found = 0;
    for (std::size_t v = 0; v < normals.size(); ++v) {
        if (normals[v] == Vec3{}) continue;
        ++found;
        EXPECT_NEAR(norm(normals[v]), 1, 1e-12);
        for (int axis = 0; axis < 3; ++axis) {
            if (s.front.outside[v] >> (2 * axis) & 3) {
                EXPECT_EQ(normals[v][axis], 0);
            }
        }
        const std::array<std::int8_t, 3>& d = s.front.direction[v]; // from front to wall
        EXPECT_LT(dot(normals[v], Vec3{double(d[0]), double(d[1]), double(d[2])}), 0);
    }
    EXPECT_GT(found, normals.size() * 9 / 10);
}

// Upright at the wall, as high as asked, at the front in the end; bent further the less they are straight.
TEST(Columns, LeaveTheWallAlongItsNormal) {
    const Leaning s(0.05);
    const double first = 1e-4 * s.front.h[0];
    LayerStack stack = thinStack(s.front, 6, first);
    const LayerStack straight = stack;
    bendColumns(s.front, stack);
    ASSERT_EQ(stack.columns.size(), s.front.front.size());
    std::size_t full = 0;
    for (std::size_t v = 0; v < stack.vertices; ++v) {
        const Column& c = stack.columns[v];
        const std::vector<Vec3> x = pointsOf(s.front, stack, v), y = pointsOf(s.front, straight, v);
        EXPECT_EQ(x.back(), s.front.wall(v));
        if (c.bend == 0) {
            EXPECT_EQ(x, y);
            continue;
        }
        const Vec3 up = x[x.size() - 2] - x.back();
        if (c.bend < 1) continue;
        ++full;
        EXPECT_GT(dot(normalized(up), c.normal()), 0.999);
        EXPECT_NEAR(norm(up), first, 1e-3 * first);
        for (int axis = 0; axis < 3; ++axis) {
            if (s.front.outside[v] >> (2 * axis) & 3) {
                EXPECT_NEAR(up[axis], 0, 1e-12);
            }
        }
    }
    EXPECT_GT(full, stack.vertices / 4);
}

TEST(Columns, OfOneCellHaveNoPointsToBend) {
    const Leaning s(0.2);
    LayerStack stack = makeLayers(s.front, LayerOptions());
    bendColumns(s.front, stack);
    EXPECT_TRUE(stack.columns.empty());
}

TEST(Columns, AreTheSameOnAnyNumberOfThreads) {
    const Leaning s(0.3);
    const LayerStack plain = thinStack(s.front, 4, 0.02 * s.front.h[0]);
    LayerStack one = plain;
    bendColumns(s.front, one);
    for (std::size_t threads : {1, 2, 3}) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        LayerStack again = plain;
        bendColumns(s.front, again);
        for (std::size_t v = 0; v < one.vertices; ++v) ASSERT_EQ(again.columns[v].bend, one.columns[v].bend);
    }
}

// A cell over a flat face has its centre amid however its columns lean; a thin one over a warped face has not
// where they lean each its own way.
TEST(CentreShare, IsHalfOfAFlatCellAndFallsWithWarpAndLean) {
    const auto share = [](double warp, double height, double lean) {
        std::vector<Vec3> low{{0, 0.6, -warp}, {0.7, 1, warp}, {1, 0, -warp}, {0, 0, warp}}, high = low;
        for (Vec3& p : high) p.z += height;
        high[0].x += lean * height;
        return thinCell(low, high).centreShare;
    };
    EXPECT_NEAR(share(0, 1, 0), 0.5, 1e-12);
    EXPECT_NEAR(share(0, 1e-5, 0.5), 0.5, 1e-6);
    EXPECT_NEAR(share(0.05, 1e-3, 0), 0.5, 1e-6); // upright: the middle of a quad's edges lie in one plane
    EXPECT_LT(share(0.1, 1e-3, 1), 0.2);
    EXPECT_GT(share(0.05, 0.5, 1), 0.4);
}

TEST(CutWarped, LeavesNoWarpedFaceUnderThinLayersAndOthersAlone) {
    Leaning s(0.15);
    const std::size_t faces = s.front.ownerCell.size();
    const auto bendAll = [&](double first) {
        LayerStack stack = thinStack(s.front, 3, first);
        bendColumns(s.front, stack);
        return stack;
    };
    Front copy = s.front;
    EXPECT_EQ(cutWarped(copy, makeLayers(copy, LayerOptions()), SurfaceIndex(Surface())), 0u); // one layer: nothing is thin
    LayerStack stack = bendAll(1e-4 * s.front.h[0]);
    EXPECT_GT(cutWarped(s.front, stack, SurfaceIndex(Surface())), faces / 10);
    EXPECT_EQ(s.front.validate(), "");
    stack = bendAll(1e-4 * s.front.h[0]);
    EXPECT_EQ(stack.validate(s.front), "");
    for (std::size_t f = 0; f < s.front.ownerCell.size(); ++f) {
        const auto n = s.front.mesh.valence(FrontMesh::FaceHandle(static_cast<int>(f)));
        EXPECT_GE(n, 3u);
    }
    EXPECT_LT(cutWarped(s.front, stack, SurfaceIndex(Surface())), faces / 10);
}

} // namespace
} // namespace i2b::test
