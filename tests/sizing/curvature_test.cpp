// Proves: the size asked for along cylinders and spheres is the arc that the number of cells per circle gives, however
// they are triangulated and oriented; flat walls, sharp edges and slivers ask for nothing.
#include "i2b/sizing/automatic.h"
#include "i2b/sizing/curvature.h"
#include "sizing/soups.h"
#include <gmock/gmock.h>
#include <tbb/global_control.h>

namespace i2b::test {
namespace {

double arc(double radius, double cells) { return 2 * std::numbers::pi * radius / cells; }

TEST(Curvature, CylindersOfAnyTriangulation) {
    for (const int segments : {16, 24, 100}) {
        for (const int rows : {1, 7, 60}) { // needles, and triangles as high as long
            const std::vector<double> sizes = curvatureSizes(cylinder(0.5, segments, 3, rows), 36, 40);
            for (const double s : sizes) {
                EXPECT_GT(s, 0.9 * arc(0.5, 36));
                EXPECT_LT(s, 1.1 * arc(0.5, 36));
            }
        }
    }
}

// Where triangles are neither needles nor tiny, as at the poles.
TEST(Curvature, Spheres) {
    const Surface ball = sphere(2, 48);
    const std::vector<double> sizes = curvatureSizes(ball, 24, 40);
    int low = 0;
    for (std::size_t t = 0; t < sizes.size(); ++t) {
        EXPECT_LT(sizes[t], 1.5 * arc(2, 24));
        low += sizes[t] < 0.67 * arc(2, 24);
    }
    EXPECT_EQ(low, 0);
}

TEST(Curvature, FlatWallsAndSharpEdgesAskForNothing) {
    Surface s; // a corner of three plates, each of many triangles
    for (int i = 0; i < 6; ++i) {
        for (int j = 0; j < 6; ++j) {
            const double x = i + 0.3 * (j % 2), u = i + 1 + 0.3 * (j % 2), y = j, v = j + 1;
            addQuad(s, {x, y, 0}, {u, y, 0}, {u, v, 0}, {x, v, 0});
            addQuad(s, {0, x, y}, {0, u, y}, {0, u, v}, {0, x, v});
            addQuad(s, {x, 0, y}, {u, 0, y}, {u, 0, v}, {x, 0, v});
        }
    }
    for (const double size : curvatureSizes(s, 360, 40)) EXPECT_TRUE(std::isinf(size));
}

// A plate with slivers whose corners are off by rounding: their normals are anything, their edges are no curvature.
TEST(Curvature, SliversOfAPlateAskForNothing) {
    Surface s;
    std::mt19937 random(1);
    const auto noise = [&] { return 2e-7 * (static_cast<double>(random()) / 2147483648.0 - 1); };
    for (int i = 0; i < 50; ++i) {
        const double x = 0.02 * i, y = 1e-6 * (1 + i % 3);
        const Vec3 a{x, 0.5, noise()}, b{x + 0.02, 0.5, noise()}, c{x + 0.013, 0.5 + y, noise()};
        addTriangle(s, a, b, c);
        addTriangle(s, a, {x + 0.01, 0, 0}, b);
        addTriangle(s, a, c, {x, 1, 0});
        addTriangle(s, c, b, {x + 0.02, 1, 0});
    }
    for (const double size : curvatureSizes(s, 36, 40)) EXPECT_GT(size, 0.5);
}

TEST(Curvature, NeitherOrientationNorRepeatedTrianglesMatter) {
    const Surface ball = sphere(2, 24);
    const std::vector<double> sizes = curvatureSizes(ball, 24, 40);
    EXPECT_EQ(curvatureSizes(reversedAtRandom(ball, 5), 24, 40), sizes);
    Surface twice = ball;
    twice.triangles.insert(twice.triangles.end(), ball.triangles.begin(), ball.triangles.end());
    twice.partOf.resize(twice.triangles.size());
    const std::vector<double> repeated = curvatureSizes(twice, 24, 40);
    for (std::size_t t = 0; t < sizes.size(); ++t) EXPECT_EQ(repeated[t], sizes[t]);
    for (const std::size_t threads : {1, 2, 3, 8}) {
        const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
        EXPECT_EQ(curvatureSizes(ball, 24, 40), sizes);
    }
}

// In a size field: cells per 360 degrees are reached to within one level, down to the smallest size, with a note.
TEST(Curvature, GivesTrianglesTheirLevel) {
    const Surface pipe = cylinder(0.5, 48, 2, 4);
    SizeOptions size;
    size.surface = 0.2, size.max = 0.4, size.min = 0.02, size.curvature = 30;
    DomainOptions domain;
    domain.box = Box{{-1.6, -1.6, -1.6}, {1.6, 1.6, 3.2}};
    SizeField field = makeSizeField(pipe, size, domain);
    addCurvature(field, pipe, size, 40);
    ASSERT_EQ(field.triangleLevel.size(), pipe.triangles.size());
    for (const LevelTriple& level : field.triangleLevel) {
        EXPECT_LE(field.lattice.h(level), 1.1 * arc(0.5, 30));
        EXPECT_GT(2 * field.lattice.h(level), 0.9 * arc(0.5, 30));
    }
    EXPECT_TRUE(field.notes.empty());
    size.curvature = 3000;
    field = makeSizeField(pipe, size, domain);
    addCurvature(field, pipe, size, 40);
    EXPECT_LE(field.minSize, 0.02);
    EXPECT_GT(field.minSize, 0.01);
    EXPECT_THAT(field.notes, testing::ElementsAre(testing::HasSubstr("the smallest are 0.02 m")));
}

} // namespace
} // namespace i2b::test
