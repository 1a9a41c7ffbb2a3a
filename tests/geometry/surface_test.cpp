#include "i2b/geometry/surface.h"
#include <functional>
#include <gmock/gmock.h>
#include <limits>

namespace i2b {
namespace {

Surface twoParts() {
    Surface s;
    s.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {5, 0, 0}, {6, 0, 2}, {5, 1, 0}, {99, 99, 99}};
    s.triangles = {{0, 1, 2}, {3, 4, 5}};
    s.partOf = {0, 1};
    s.parts = {{"a", "a.stl", 1}, {"b", "b.stl", 1}};
    s.segments = {{0, 3, 1}};
    s.freePoints = {6};
    return s;
}

// Proves: bounds are of triangles, not of points, whole or of a part.
TEST(Surface, Bounds) {
    const Surface s = twoParts();
    EXPECT_EQ(s.bounds(), (Box{{0, 0, 0}, {6, 1, 2}}));
    EXPECT_EQ(s.bounds(1), (Box{{5, 0, 0}, {6, 1, 2}}));
    EXPECT_TRUE(Surface().bounds().empty());
}

// Proves: each kind of fault is found and named.
TEST(Surface, Validate) {
    EXPECT_EQ(twoParts().validate(), "");
    const auto fault = [](const std::function<void(Surface&)>& spoil) {
        Surface s = twoParts();
        spoil(s);
        return s.validate();
    };
    using testing::HasSubstr;
    EXPECT_THAT(fault([](Surface& s) { s.triangles[1][2] = 7; }), HasSubstr("triangle 1 names a point"));
    EXPECT_THAT(fault([](Surface& s) { s.points[6].y = std::numeric_limits<double>::quiet_NaN(); }),
                HasSubstr("point 6"));
    EXPECT_THAT(fault([](Surface& s) { s.partOf[0] = 2; }), HasSubstr("part 2"));
    EXPECT_THAT(fault([](Surface& s) { s.partOf[0] = -1; }), HasSubstr("part -1"));
    EXPECT_THAT(fault([](Surface& s) { s.partOf.pop_back(); }), HasSubstr("part ids"));
    EXPECT_THAT(fault([](Surface& s) { s.parts[1].name = "a"; }), HasSubstr("two parts"));
    EXPECT_THAT(fault([](Surface& s) { s.parts[1].name = ""; }), HasSubstr("no name"));
    EXPECT_THAT(fault([](Surface& s) { s.parts[1].triangles = 4; }), HasSubstr("says 4"));
    EXPECT_THAT(fault([](Surface& s) { s.segments[0].b = 7; }), HasSubstr("segment 0"));
    EXPECT_THAT(fault([](Surface& s) { s.freePoints[0] = 7; }), HasSubstr("free point 0"));
}

// Proves: the checksum follows geometry and parts, not where they were read from.
TEST(Surface, Checksum) {
    const std::uint64_t sum = twoParts().checksum();
    Surface s = twoParts();
    s.parts[0].file = "elsewhere.stl";
    EXPECT_EQ(s.checksum(), sum);
    s.parts[0].name = "c";
    EXPECT_NE(s.checksum(), sum);
    s = twoParts(), s.points[2].x = 1e-300;
    EXPECT_NE(s.checksum(), sum);
    s = twoParts(), std::swap(s.triangles[0][0], s.triangles[0][1]);
    EXPECT_NE(s.checksum(), sum);
    s = twoParts(), s.freePoints.clear();
    EXPECT_NE(s.checksum(), sum);
}

} // namespace
} // namespace i2b
