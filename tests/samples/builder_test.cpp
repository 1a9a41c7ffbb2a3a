#include "i2b/samples/builder.h"
#include <gmock/gmock.h>

namespace i2b::samples {
namespace {

double areaOf(const std::vector<Loop2>& loops) {
    Loop2 all;
    for (const Loop2& l : loops) all.insert(all.end(), l.begin(), l.end());
    double sum = 0;
    for (const auto& [a, b, c] : triangulate(loops)) {
        const double twice = cross(all[b] - all[a], all[c] - all[a]);
        EXPECT_GT(twice, 0); // no triangle is reversed or flat
        sum += twice / 2;
    }
    return sum;
}

double areaOf(const Loop2& loop) {
    double twice = 0;
    for (std::size_t i = 0; i < loop.size(); ++i) twice += cross(loop[i], loop[(i + 1) % loop.size()]);
    return twice / 2;
}

double volumeOf(const Mesh& m) {
    double six = 0;
    for (const auto& [a, b, c] : m.triangles) six += dot(m.points[a], cross(m.points[b], m.points[c]));
    return six / 6;
}

// The circle is right to the last digits and exactly symmetric, without libm's sine.
TEST(Outline, UnitCircleIsExactAndSymmetric) {
    for (const int n : {3, 7, 12, 64, 96, 1000})
        for (int i = -2; i < n + 2; ++i) {
            const Vec2 e = unitCircle(i, n);
            EXPECT_NEAR(e.x, std::cos(2 * M_PI * i / n), 4e-16 * (2 + std::abs(i)));
            EXPECT_NEAR(e.y, std::sin(2 * M_PI * i / n), 4e-16 * (2 + std::abs(i)));
        }
    for (int i = 0; i < 64; ++i) {
        EXPECT_EQ(unitCircle(i + 16, 64).x, -unitCircle(i, 64).y);
        EXPECT_EQ(unitCircle(i + 16, 64).y, unitCircle(i, 64).x);
    }
}

// Triangulation keeps the area of concave outlines with holes and collinear points, so nothing overlaps or is
// lost.
TEST(Outline, TriangulationKeepsArea) {
    const Loop2 cross{{1, 0}, {2, 0}, {2, 1}, {3, 1}, {3, 2}, {2, 2},
                      {2, 3}, {1, 3}, {1, 2}, {0, 2}, {0, 1}, {1, 1}};
    EXPECT_NEAR(areaOf(std::vector{cross}), 5, 1e-12);
    const Loop2 plate = subdivided({{0, 0}, {8, 0}, {8, 2}, {0, 2}}, 0.3);
    std::vector<Loop2> loops{plate};
    double expected = 16;
    for (int i = 0; i < 4; ++i) {
        loops.push_back(circle({1.0 + 2 * i, 1}, 0.9, 24));
        expected -= areaOf(loops.back());
    }
    EXPECT_NEAR(areaOf(loops), expected, 1e-12);
    const Loop2 star = gear({}, 1, 2, 16);
    EXPECT_NEAR(areaOf(std::vector{star}), areaOf(star), 1e-12);
}

// Fillets keep inside a convex corner and cut r^2 (1 - pi / 4) from a square one, less the arc's chords.
TEST(Outline, FilletRoundsCorners) {
    const Loop2 loop = filletedPolygon({{0, 0}, {4, 0}, {4, 4}, {0, 4}}, {1, 1, 1, 0}, 64);
    EXPECT_EQ(loop.size(), 3u * 65 + 1);
    EXPECT_NEAR(areaOf(loop), 16 - 3 * (1 - M_PI / 4), 1e-3);
}

// Shapes whose volume is known: the builders close them and turn their normals outwards.
TEST(Builder, VolumesAreThoseOfTheShapes) {
    EXPECT_NEAR(volumeOf(box({0, 0, 0}, {1, 2, 3})), 6, 1e-12);
    const double disc = areaOf(circle({}, 1, 64));
    EXPECT_NEAR(volumeOf(lathe(upright({}), {{0, 0}, {1, 0}, {1, 2}, {0, 2}}, 64)), 2 * disc, 1e-12);
    const Loop2 square{{-2, -2}, {2, -2}, {2, 2}, {-2, 2}};
    EXPECT_NEAR(volumeOf(extrude(lengthwise(5), square, {circle({}, 1, 64)}, {0, 1, 3})), 3 * (16 - disc),
                1e-12);
    // Pappus: a pipe with one right-angled bend holds its section times the length of its middle line.
    const Path path = bentPath({{0, 0, 0}, {10, 0, 0}, {10, 0, 8}}, 3, 64);
    EXPECT_NEAR(volumeOf(pipe(path, 1, 64)), disc * (7 + 5 + 1.5 * M_PI), 0.02);
    // A closed ring.
    EXPECT_NEAR(volumeOf(lathe(upright({}), {{2, 0}, {3, 0}, {3, 1}, {2, 1}}, 64, true)), disc * (9 - 4),
                1e-12);
}

// A pipe grown out of a perforated wall leaves the shell closed: as many half edges one way as the other.
TEST(Builder, PipeGrowsOutOfWall) {
    const Loop2 outline = circle({}, 1, 32);
    Mesh mesh = extrude(upright({}), outline, {}, levels(0, 2, 10));
    const double before = volumeOf(mesh);
    growPipe(mesh, perforate(mesh, 32, 4, 6, 31, 33), {{1.1, 0, 1}, {1.5, 0, 1}, {2, 0, 1}}, 0.15, true);
    std::vector<std::pair<std::uint32_t, std::uint32_t>> halves;
    for (const Triangle& t : mesh.triangles)
        for (std::size_t k = 0; k < 3; ++k) halves.emplace_back(t[k], t[(k + 1) % 3]);
    auto twins = halves;
    for (auto& [a, b] : twins) std::swap(a, b);
    EXPECT_THAT(twins, testing::UnorderedElementsAreArray(halves));
    EXPECT_GT(volumeOf(mesh), before + 0.05);
}

} // namespace
} // namespace i2b::samples
