// Proves: every kind of source arrives in the size field with its level; sizes and ratios beyond the limits are clamped
// and said to be; sources that act on nothing are named.
#include "i2b/sizing/size_field.h"
#include "sizing/soups.h"
#include <array>
#include <gmock/gmock.h>

namespace i2b::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

Surface plate() {
    Surface s;
    addQuad(s, {0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0});
    addQuad(s, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}, 1);
    return s;
}

SizeField field(const SizeOptions& size) {
    DomainOptions domain;
    domain.box = Box{{-4, -4, -4}, {4, 4, 4}};
    return makeSizeField(plate(), size, domain);
}

SizeOptions sized() {
    SizeOptions size;
    size.surface = 0.5, size.max = 1;
    return size;
}

TEST(Sources, EveryKindHasItsLevel) {
    SizeOptions size = sized();
    size.boxes = {{{{0, 0, 0}, {1, 1, 1}}, sameSize(0.5)}};
    size.spheres = {{{0, 0, 0}, 1, sameSize(0.25)}};
    size.cylinders = {{{0, 0, 0}, {1, 0, 0}, 1, {1, 0.5, 0.125}}};
    size.bands = {{"part.*", 0.3, sameSize(0.125)}, {"part1", 0.1, sameSize(0.5)}};
    size.points = {{{1, 1, 1}, sameSize(0.0625)}};
    size.segments = {{{1, 1, 1}, {2, 2, 2}, sameSize(0.3)}};
    size.lines = {{{0, 0, 0.2}, {1, 0, 0}, sameSize(0.6)}};
    const SizeField f = field(size);
    EXPECT_EQ(f.validate(), "");
    EXPECT_THAT(f.notes, ElementsAre());
    ASSERT_EQ(f.shapes.size(), 7u);
    const LevelTriple expected[] = {allAxes(2), {0, 1, 3}, allAxes(3), allAxes(1), allAxes(4), allAxes(2), allAxes(1)};
    for (std::size_t i = 0; i < 7; ++i) EXPECT_EQ(f.shapes[i].level, expected[i]) << i;
    EXPECT_EQ(f.lattice.maxLevel, 4);
    EXPECT_EQ(std::get<PartsBand>(f.shapes[2].shape).parts->triangles(), 4u);
    EXPECT_EQ(std::get<PartsBand>(f.shapes[3].shape).parts->triangles(), 2u);
    const auto& line = std::get<Capsule>(f.shapes[6].shape); // as long as the domain
    EXPECT_NEAR(norm(line.to - line.from), 8, 1e-5);
}

TEST(Sources, SizesBeyondTheLimitsAreClampedAndNamed) {
    SizeOptions size = sized();
    size.min = 0.125;
    size.spheres = {{{0, 0, 0}, 1, sameSize(0.01)}};
    size.points = {{{0, 0, 0}, sameSize(5)}};
    const SizeField f = field(size);
    EXPECT_EQ(f.shapes[0].level, allAxes(3));
    EXPECT_EQ(f.shapes[1].level, allAxes(0));
    EXPECT_THAT(f.notes, ElementsAre(HasSubstr("the size 0.01 m of the sphere at (0 0 0) is clamped to 0.125 m"),
                                     HasSubstr("the size 5 m of the point (0 0 0) is clamped to 1 m")));
}

TEST(Sources, CellsAreAtMostSixteenTimesAsLongAsHigh) {
    SizeOptions size = sized();
    size.parts = {{"part0", {1, 1, 0.01}}};
    const SizeField f = field(size);
    EXPECT_THAT(f.notes, ElementsAre(HasSubstr("(1 1 0.01) m of part 'part0' is clamped to (0.16 0.16 0.01) m")));
    const Vec3 h = f.lattice.cellSize(f.partLevel[0]);
    EXPECT_LE(h.x / h.z, 16);
}

TEST(Sources, WhatActsOnNothingIsNamed) {
    SizeOptions size = sized();
    size.bands = {{"wheel", 0.3, sameSize(0.125)}};
    size.spheres = {{{40, 0, 0}, 1, sameSize(0.25)}};
    size.lines = {{{0, 0, 9}, {1, 1, 0}, sameSize(0.25)}};
    EXPECT_THAT(field(size).notes, ElementsAre(HasSubstr("the sphere at (40 0 0) lies outside"), HasSubstr("no part is named 'wheel'"),
                                               HasSubstr("the line through (0 0 9) misses")));
}

// Two of three parts: of their own index and of the whole surface's.
TEST(Sources, BandsAroundMostOfASurfaceAreTheSameByItsIndex) {
    Surface soup = plate();
    addQuad(soup, {1.2, 0, 0.4}, {2, 0, 0.4}, {2, 1, 0.6}, {1.2, 1, 0.6}, 2);
    const SurfaceIndex index(soup);
    DomainOptions domain;
    domain.box = Box{{-4, -4, -4}, {4, 4, 4}};
    SizeOptions size = sized();
    size.bands = {{"part[01]", 0.3, sameSize(0.125)}, {"part2", 0.3, sameSize(0.125)}};
    const SizeField own = makeSizeField(soup, size, domain), shared = makeSizeField(soup, size, domain, &index);
    ASSERT_EQ(shared.shapes.size(), 2u);
    std::array<int, 3> found{};
    for (std::size_t i = 0; i < 2; ++i) {
        const auto &a = std::get<PartsBand>(own.shapes[i].shape), &b = std::get<PartsBand>(shared.shapes[i].shape);
        EXPECT_EQ(a.parts->triangles(), b.parts->triangles());
        EXPECT_EQ(a.parts->bounds().lo, b.parts->bounds().lo);
        EXPECT_EQ(a.parts->bounds().hi, b.parts->bounds().hi);
        EXPECT_NEAR(a.parts->area(), b.parts->area(), 1e-12);
        for (int cell = 0; cell < 30 * 20 * 20; ++cell) {
            const Vec3 lo = Vec3{double(cell % 30), double(cell / 30 % 20), double(cell / 600)} * 0.1 - Vec3{0.5, 0.5, 0.5};
            const Box box{lo, lo + Vec3{0.1, 0.1, 0.1}};
            const Cover cover = coverOf(a, box);
            EXPECT_EQ(cover, coverOf(b, box)) << lo.x << ' ' << lo.y << ' ' << lo.z;
            ++found[static_cast<std::size_t>(cover)];
        }
    }
    for (const int n : found) EXPECT_GT(n, 100);
}

} // namespace
} // namespace i2b::test
