// Proves: a face becomes two triangles fewer than it has vertices, which cover it in its sense; the widest ones have an area where a
// fan's have none, and no other way of dividing has a wider thinnest one.
#include "i2b/assemble/face_triangles.h"
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <numeric>
#include <random>

namespace i2b::test {
namespace {

using Index = std::size_t;

std::vector<std::int32_t> inOrder(Index n) {
    std::vector<std::int32_t> face(n);
    std::iota(face.begin(), face.end(), 0);
    return face;
}

Vec3 areaOf(const std::vector<Vec3>& p, const FaceTriangle& t) { return 0.5 * cross(p[t[1]] - p[t[0]], p[t[2]] - p[t[0]]); }

Vec3 areaOf(const std::vector<Vec3>& p) {
    Vec3 area;
    for (std::uint32_t i = 1; i + 1 < p.size(); ++i) area += areaOf(p, {0, i, i + 1});
    return area;
}

double widthOf(const std::vector<Vec3>& p, const FaceTriangle& t) {
    const double side2 = std::max({norm2(p[t[1]] - p[t[0]]), norm2(p[t[2]] - p[t[1]]), norm2(p[t[0]] - p[t[2]])});
    return 2 * dot(areaOf(p, t), normalized(areaOf(p))) / side2;
}

double thinnest(const std::vector<Vec3>& p, const std::vector<FaceTriangle>& triangles) {
    double least = 1e300;
    for (const FaceTriangle& t : triangles) least = std::min(least, widthOf(p, t));
    return least;
}

// The widest that the thinnest triangle can be, by trying every way to divide the vertices i to j.
double byTryingAll(const std::vector<Vec3>& p, std::uint32_t i, std::uint32_t j) {
    double best = j == i + 1 ? 1e300 : -1e300;
    for (std::uint32_t k = i + 1; k < j; ++k)
        best = std::max(best, std::min({widthOf(p, {i, k, j}), byTryingAll(p, i, k), byTryingAll(p, k, j)}));
    return best;
}

// Every side of the face is of one triangle, every other side of two that run along it in opposite senses.
void expectWhole(const std::vector<FaceTriangle>& triangles, std::uint32_t corners) {
    ASSERT_EQ(triangles.size(), corners - 2);
    std::vector<std::pair<std::uint32_t, std::uint32_t>> sides;
    for (const FaceTriangle& t : triangles)
        for (int k = 0; k < 3; ++k) sides.emplace_back(t[Index(k)], t[Index((k + 1) % 3)]);
    for (const auto& [a, b] : sides) {
        EXPECT_EQ(std::ranges::count(sides, std::pair(a, b)), 1);
        EXPECT_EQ(std::ranges::count(sides, std::pair(b, a)), b == (a + 1) % corners ? 0 : 1) << a << " " << b;
    }
}

std::vector<Vec3> randomFace(std::mt19937& random, Index corners) { // seen from the middle all around, not flat
    std::uniform_real_distribution<double> r(0.3, 1), z(-0.2, 0.2);
    std::vector<Vec3> p;
    for (Index i = 0; i < corners; ++i) {
        const double angle = 2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(corners), reach = r(random);
        p.push_back({5 + reach * std::cos(angle), 3 + reach * std::sin(angle), z(random)});
    }
    return p;
}

TEST(FaceTriangles, FansAreFromTheirVertex) {
    std::mt19937 random(1);
    for (Index corners = 3; corners < 9; ++corners) {
        const std::vector<Vec3> p = randomFace(random, corners);
        for (std::uint32_t from = 0; from < corners; ++from) {
            const auto triangles = trianglesOf(p, inOrder(corners), from);
            expectWhole(triangles, static_cast<std::uint32_t>(corners));
            for (const FaceTriangle& t : triangles) EXPECT_EQ(t[0], from);
        }
    }
}

TEST(FaceTriangles, NoneDividesWiderThanTheWidest) {
    std::mt19937 random(2);
    for (int run = 0; run < 50; ++run) {
        const Index corners = 3 + Index(run) % 6;
        const std::vector<Vec3> p = randomFace(random, corners);
        const auto triangles = trianglesOf(p, inOrder(corners), widest);
        expectWhole(triangles, static_cast<std::uint32_t>(corners));
        EXPECT_DOUBLE_EQ(thinnest(p, triangles), byTryingAll(p, 0, static_cast<std::uint32_t>(corners) - 1)) << run;
        Vec3 sum;
        for (const FaceTriangle& t : triangles) sum += areaOf(p, t);
        EXPECT_NEAR(norm(sum - areaOf(p)), 0, 1e-14);
    }
}

// The side of a layer whose neighbours to the left and right have three: each fan has a triangle without area.
TEST(FaceTriangles, TwoDividedSidesMakeNoFlatTriangle) {
    const std::vector<Vec3> p{{0, 0, 0}, {4, 0, 0}, {4, 0.3, 0}, {4, 0.6, 0}, {4, 1, 0}, {0, 1, 0}, {0, 0.6, 0}, {0, 0.3, 0}};
    for (std::uint32_t from = 0; from < 8; ++from) EXPECT_LT(thinnest(p, trianglesOf(p, inOrder(8), from)), 1e-14);
    EXPECT_GT(thinnest(p, trianglesOf(p, inOrder(8), widest)), 0.07);
}

} // namespace
} // namespace i2b::test
