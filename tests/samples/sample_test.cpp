#include "i2b/core/checksum.h"
#include "i2b/core/error.h"
#include "i2b/samples/sample.h"
#include "samples/edges.h"
#include <gmock/gmock.h>
#include <map>

namespace i2b {
namespace {

std::string checksumOf(const Surface& s) {
    Checksum sum;
    sum.add(std::span(s.points));
    sum.add(std::span(s.triangles));
    sum.add(std::span(s.partOf));
    for (const Part& p : s.parts) sum.add(std::string_view(p.name));
    return sum.hex();
}

// Crossings of the ray from p with the soup (Moller and Trumbore 1997); the direction avoids edges.
int crossings(const Surface& s, const Vec3& p) {
    const Vec3 d = normalized(Vec3{0.327, 0.611, 0.7213});
    int count = 0;
    for (const auto& t : s.triangles) {
        const Vec3 a = s.points[t[0]], e1 = s.points[t[1]] - a, e2 = s.points[t[2]] - a;
        const Vec3 h = cross(d, e2), q = cross(p - a, e1);
        const double det = dot(e1, h), u = dot(p - a, h) / det, v = dot(d, q) / det;
        count += u >= 0 && v >= 0 && u + v <= 1 && dot(e2, q) / det > 0;
    }
    return count;
}

// The same bits on every call, whatever was made in between; dirt and resolution do change something.
TEST(Sample, IsReproducible) {
    std::map<std::string, std::string> first;
    for (const std::string& name : sampleNames()) first[name] = checksumOf(makeSample(name));
    for (const std::string& name : sampleNames()) {
        EXPECT_EQ(checksumOf(makeSample(name)), first[name]) << name;
        if (name != "box") {
            EXPECT_NE(checksumOf(makeSample(name, {1, 2})), first[name]) << name;
        }
    }
    for (const char* name : {"engine", "missile", "wing-body", "tunnel"})
        EXPECT_NE(checksumOf(makeSample(name, {0, 1})), first[name]) << name;
    for (const char* name : {"box", "sphere"})
        EXPECT_EQ(checksumOf(makeSample(name, {0, 1})), first[name]) << name;
}

// A wrong name is a wrong command line, and the message lists what there is.
TEST(Sample, RefusesWhatItDoesNotKnow) {
    try {
        makeSample("teapot");
        FAIL();
    } catch (const Error& e) {
        EXPECT_EQ(e.exitStatus(), 2);
        for (const std::string& name : sampleNames()) EXPECT_THAT(e.remedy(), testing::HasSubstr(name));
    }
    EXPECT_THROW(makeSample("box", {-1, 1}), Error);
    EXPECT_THROW(makeSample("box", {1, 0}), Error);
    EXPECT_FALSE(sampleSeed("box", "jacket"));
    EXPECT_FALSE(sampleSeed("engine", "sauna"));
}

// A quarter turn about x takes the clean missile to itself, point for point; its parts are closed.
TEST(Sample, MissileHasFourfoldSymmetry) {
    const Surface s = makeSample("missile", {0, 1});
    ASSERT_EQ(s.parts.size(), 5u);
    const auto key = [](const Vec3& p) {
        return std::array{std::llround(p.x * 1e9), std::llround(p.y * 1e9), std::llround(p.z * 1e9)};
    };
    std::map<std::array<long long, 3>, int> places;
    for (const Vec3& p : s.points) ++places[key(p)];
    for (const Vec3& p : s.points)
        ASSERT_TRUE(places.contains(key({p.x, -p.z, p.y}))) << p.x << ' ' << p.y << ' ' << p.z;
    Box box;
    for (const Vec3& p : s.points) box.add(p);
    EXPECT_DOUBLE_EQ(box.extent().x, 2);
    EXPECT_NEAR(box.extent().y, 0.52, 1e-12);
    for (std::int32_t p = 0; p < 5; ++p) {
        const test::EdgeCount e = test::countEdges(s, p);
        EXPECT_EQ(e.open + e.crowded + e.flipped, 0u) << s.parts[std::size_t(p)].name;
    }
    // Dirty: the rims of nose and body, with different counts of points.
    EXPECT_EQ(test::countEdges(makeSample("missile"), 0).open, 64u + 48u);
}

// Clean, the aircraft's patches close together but for the three roots inside the body; dirty, hardly a border
// agrees.
TEST(Sample, WingBodyIsMadeOfPatchesThatMeet) {
    const Surface s = makeSample("wing-body", {0, 1});
    ASSERT_EQ(s.parts.size(), 17u);
    const test::EdgeCount e = test::countEdges(s);
    EXPECT_EQ(e.open, 3u * (20 + 20 + 12));
    EXPECT_EQ(e.crowded, 0u);
    Box box;
    for (const Vec3& p : s.points) box.add(p);
    EXPECT_DOUBLE_EQ(box.extent().x, 2);
    EXPECT_DOUBLE_EQ(box.hi.y, 0.95);
    EXPECT_DOUBLE_EQ(box.lo.y, -0.95);
    EXPECT_GT(test::countEdges(makeSample("wing-body")).open, 500u);
}

// The tunnel's parts close together: every edge has two triangles, and the seed is inside, a place outside is
// not.
TEST(Sample, TunnelEnclosesItsSeed) {
    const Surface s = makeSample("tunnel", {0, 1});
    ASSERT_EQ(s.parts.size(), 3u);
    const test::EdgeCount e = test::countEdges(s);
    EXPECT_EQ(e.open + e.crowded + e.flipped, 0u);
    const Vec3 seed = *sampleSeed("tunnel", "inside");
    EXPECT_EQ(crossings(s, seed) % 2, 1);
    EXPECT_EQ(crossings(s, {1.0, 0, 0.35}) % 2, 0);
    EXPECT_EQ(crossings(s, {1.0, 0, -0.15}) % 2, 0);
    EXPECT_GT(test::countEdges(makeSample("tunnel")).open, 100u); // dirty: cracks at both ends
}

// Box and sphere are exact: area and volume of the cube, every point of the sphere at the radius, both
// closed.
TEST(Sample, BoxAndSphereAreExact) {
    const Surface cube = makeSample("box");
    EXPECT_EQ(cube.triangles.size(), 12u);
    EXPECT_EQ(test::countEdges(cube).manifold, 18u);
    EXPECT_EQ(test::countEdges(cube).open, 0u);
    const Surface ball = makeSample("sphere");
    for (const Vec3& p : ball.points) ASSERT_NEAR(norm(p), 0.5, 1e-15);
    const test::EdgeCount e = test::countEdges(ball);
    EXPECT_EQ(e.open + e.crowded + e.flipped, 0u);
    EXPECT_EQ(e.manifold * 2, ball.triangles.size() * 3);
}

} // namespace
} // namespace i2b
