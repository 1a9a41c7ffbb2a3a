// Proves: one number gives a lattice whose cells are small enough everywhere they must be; parts, boxes and
// limits act as asked; requests without a lattice are refused with a remedy.
#include "i2b/core/error.h"
#include "i2b/sizing/estimate.h"
#include "i2b/sizing/size_field.h"
#include <gmock/gmock.h>

namespace i2b::test {
namespace {

// Three unit triangles' worth of parts within [0, 4] x [0, 2] x [0, 1].
Surface soup() {
    Surface s;
    s.points = {{0, 0, 0}, {4, 0, 0}, {0, 2, 1}, {4, 2, 1}};
    s.triangles = {{0, 1, 2}, {1, 2, 3}, {0, 1, 3}};
    s.partOf = {0, 1, 2};
    s.parts = {{"wheel_1", "", 1}, {"wheel_2", "", 1}, {"body", "", 1}};
    return s;
}

SizeOptions sized(double surface, double max = 0) {
    SizeOptions o;
    o.surface = surface, o.max = max;
    return o;
}

DomainOptions boxed(const Box& box, Flow flow = Flow::external) {
    DomainOptions d;
    d.box = box, d.flow = flow;
    return d;
}

std::string refusal(const Surface& s, const SizeOptions& size, const DomainOptions& domain) {
    try {
        makeSizeField(s, size, domain);
    } catch (const Error& e) {
        EXPECT_EQ(e.kind(), ErrorKind::input);
        EXPECT_NE(e.remedy(), "");
        return e.problem();
    }
    return "";
}

TEST(SizeField, OneNumberIsEnough) {
    for (double d : {0.5, 0.11, 0.03}) {
        const SizeField f = makeSizeField(soup(), sized(d), DomainOptions{});
        EXPECT_EQ(f.validate(), "");
        const Box domain = f.lattice.domain(), body = soup().bounds();
        for (int a = 0; a < 3; ++a) { // external: 10 body lengths on every side
            EXPECT_GE(body.lo[a] - domain.lo[a], 40 - 1e-9);
            EXPECT_GE(domain.hi[a] - body.hi[a], 40 - 1e-9);
            EXPECT_LE(f.lattice.base[a], f.maxSize * (1 + 1e-9));
        }
        for (const LevelTriple& level : f.partLevel) {
            const Vec3 s = f.lattice.cellSize(level);
            EXPECT_LE(std::max({s.x, s.y, s.z}), d * (1 + 1e-6));
            EXPECT_GE(2 * std::max({s.x, s.y, s.z}), d); // and no smaller than it takes
        }
    }
}

TEST(SizeField, InternalDomainsHugTheGeometry) {
    DomainOptions inside;
    inside.flow = Flow::internal;
    const SizeField f = makeSizeField(soup(), sized(0.1), inside);
    const Box domain = f.lattice.domain(), body = soup().bounds();
    for (int a = 0; a < 3; ++a) {
        EXPECT_GE(body.lo[a] - domain.lo[a],
                  f.maxSize); // cells all around, or a seed outside could not be told apart
        EXPECT_LE(body.lo[a] - domain.lo[a], 4 * f.maxSize);
    }
}

TEST(SizeField, BoxAndSizesThatDivideAreTakenAsTheyAre) {
    const Box box{{-1, -1, -1}, {5, 3, 2}};
    const SizeField f = makeSizeField(soup(), sized(0.1, 0.2), boxed(box));
    EXPECT_EQ(f.lattice.count, (Index3{30, 20, 15}));
    EXPECT_EQ(f.partLevel, (std::vector<LevelTriple>{allAxes(1), allAxes(1), allAxes(1)}));
    EXPECT_EQ(f.lattice.origin, box.lo);
    for (int a = 0; a < 3; ++a) EXPECT_DOUBLE_EQ(f.lattice.domain().hi[a], box.hi[a]);
}

TEST(SizeField, PartsByNameAndPattern) {
    SizeOptions o = sized(0.4, 0.4);
    o.parts = {{"wheel_.*", sameSize(0.1)}, {"body", sameSize(0.05)}, {"ghost", sameSize(0.01)}};
    const SizeField f = makeSizeField(soup(), o, boxed({{-1, -1, -1}, {5, 3, 3}}));
    EXPECT_EQ(f.partLevel, (std::vector<LevelTriple>{allAxes(2), allAxes(2), allAxes(3)}));
    EXPECT_EQ(f.lattice.maxLevel, 3);
    EXPECT_THAT(f.notes, testing::ElementsAre(testing::HasSubstr("'ghost'")));
}

TEST(SizeField, LimitsClampAndSaySo) {
    SizeOptions o = sized(0.4, 0.8);
    o.min = 0.2;
    o.parts = {{"body", sameSize(0.01)}};
    o.boxes = {{{{0, 0, 0}, {1, 1, 1}}, sameSize(0.01)}};
    const SizeField f = makeSizeField(soup(), o, boxed({{-1.6, -1.6, -1.6}, {4.8, 4.8, 4.8}}));
    EXPECT_EQ(f.partLevel[2], allAxes(2)); // 0.8 / 4 = 0.2
    ASSERT_EQ(f.boxes.size(), 1u);
    EXPECT_EQ(f.boxes[0].level, allAxes(2));
    EXPECT_DOUBLE_EQ(f.minSize, 0.2);
    EXPECT_THAT(f.notes, testing::ElementsAre(testing::HasSubstr("0.01 m of part 'body' is clamped to 0.2 m"),
                                              testing::HasSubstr("clamped to 0.2 m")));
}

TEST(SizeField, RefusesWhatHasNoLattice) {
    EXPECT_THAT(refusal(Surface{}, sized(0.1), DomainOptions{}), testing::HasSubstr("no triangles"));
    EXPECT_THAT(refusal(soup(), sized(0.1), boxed({{10, 10, 10}, {11, 11, 11}})),
                testing::HasSubstr("none of the geometry"));
    EXPECT_THAT(refusal(soup(), sized(1e-7, 1e-7), boxed({{-1, -1, -1}, {5, 3, 3}})),
                testing::HasSubstr("too small"));
    EXPECT_THAT(refusal(soup(), sized(3.8e-9, 0.004), boxed({{-1, -1, -1}, {5, 3, 3}})),
                testing::HasSubstr("too small"));
}

TEST(EstimateBytes, GrowsWithWhatIsAsked) {
    const auto bytes = [](double d, int layers, bool gridOnly) {
        return estimateBytes(soup(), makeSizeField(soup(), sized(d), DomainOptions{}), layers, gridOnly);
    };
    EXPECT_GT(bytes(0.01, 1, false), bytes(0.1, 1, false));
    EXPECT_GT(bytes(0.01, 5, false), bytes(0.01, 1, false));
    EXPECT_LT(bytes(0.01, 1, true), bytes(0.01, 1, false));
}

} // namespace
} // namespace i2b::test
