// Proves: seeds paint the region they lie in and give it their name; what cannot be painted is refused with a
// way out; without seeds the largest region of the asked kind is chosen.
#include "paint/random_grid.h"
#include <gmock/gmock.h>

namespace i2b::test {
namespace {

// A room of 4^3 cells in a box of 8^3: walls one cell thick at 1 and 6, so one region outside and one inside.
struct Room {
    explicit Room(bool walls = true) {
        SizeField field;
        field.lattice.base = {1, 1, 1};
        field.lattice.count = {8, 8, 8};
        grid = buildCellGrid(field, wantedCells(field, {}));
        auto mask = std::make_shared<Mask>(false);
        for (int i = 0; i < 512 && walls; ++i) {
            const Index3 c{i % 8, i / 8 % 8, i / 64};
            const auto [lo, hi] = std::minmax({c[0], c[1], c[2]});
            if ((lo == 1 || hi == 6) && lo >= 1 && hi <= 6) mask->setValueOn(toCoord(c));
        }
        cut.levels.push_back(mask);
        regions = labelRegions(grid, cut);
    }
    const Region& at(std::size_t i) const { return regions.table[i]; } // 0: outside, 1: inside
    void choose(const DomainOptions& domain) { chooseRegions(regions, grid, SurfaceIndex(Surface{}), domain); }
    CellGrid grid;
    CutCells cut;
    Regions regions;
};

DomainOptions with(Flow flow, std::vector<Seed> seeds = {}) {
    DomainOptions d;
    d.flow = flow;
    d.seeds = std::move(seeds);
    return d;
}

// The error's own words, or "" where there is none.
std::string refusal(Room room, const DomainOptions& domain) {
    try {
        room.choose(domain);
    } catch (const Error& e) {
        EXPECT_EQ(e.kind(), ErrorKind::input);
        EXPECT_NE(e.remedy(), "");
        return e.problem() + "|" + e.remedy();
    }
    return "";
}

TEST(ChooseRegions, ByFlow) {
    for (auto [flow, outside] :
         {std::pair(Flow::automatic, true), {Flow::external, true}, {Flow::internal, false}}) {
        Room room;
        ASSERT_EQ(room.regions.table.size(), 2u);
        room.choose(with(flow));
        EXPECT_EQ(room.at(0).painted, outside);
        EXPECT_EQ(room.at(1).painted, !outside);
    }
}

TEST(ChooseRegions, BySeed) {
    Room room;
    room.choose(with(Flow::automatic, {{"jacket", {4, 4, 4}}}));
    EXPECT_FALSE(room.at(0).painted);
    EXPECT_TRUE(room.at(1).painted);
    EXPECT_EQ(room.at(1).name, "jacket");
}

TEST(ChooseRegions, SeedsOnTheBoxItselfCount) {
    for (const Vec3& corner : {Vec3{0, 0, 0}, Vec3{8, 8, 8}, Vec3{8, 0, 8}}) {
        Room room;
        room.choose(with(Flow::automatic, {{"", corner}}));
        EXPECT_TRUE(room.at(0).painted);
        EXPECT_EQ(room.at(0).name, "region0");
    }
}

TEST(ChooseRegions, TwoSeedsInTwoRegions) {
    Room room;
    room.choose(with(Flow::automatic, {{"a", {4, 4, 4}}, {"b", {0.5, 0.5, 0.5}}}));
    EXPECT_EQ(room.at(0).name, "b");
    EXPECT_EQ(room.at(1).name, "a");
    EXPECT_TRUE(room.at(0).painted && room.at(1).painted);
}

// What is between them is for findLeaks() to say.
TEST(ChooseRegions, TwoSeedsInOneRegion) {
    Room room(false);
    room.choose(with(Flow::automatic, {{"a", {4, 4, 4}}, {"b", {0.5, 0.5, 0.5}}}));
    EXPECT_TRUE(room.at(0).painted);
    EXPECT_EQ(room.at(0).name, "b");
}

TEST(ChooseRegions, RefusesWithARemedy) {
    EXPECT_THAT(refusal(Room(), with(Flow::automatic, {{"x", {4, 4, 9}}})),
                testing::HasSubstr("outside the domain box"));
    EXPECT_THAT(refusal(Room(false), with(Flow::internal)), testing::HasSubstr("encloses no region"));
    Room full;
    full.cut.levels = {full.grid.levels[0].cells};
    full.regions = labelRegions(full.grid, full.cut);
    EXPECT_THAT(refusal(std::move(full), with(Flow::external)), testing::HasSubstr("cuts every cell"));
    Room corner; // one open cell, out of sight
    corner.cut.levels[0] = std::make_shared<Mask>(*corner.grid.levels[0].cells);
    corner.cut.levels[0]->setValueOff(toCoord({0, 0, 0}));
    corner.regions = labelRegions(corner.grid, corner.cut);
    const std::string inWall = refusal(std::move(corner), with(Flow::automatic, {{"x", {0.5, 4.5, 4.5}}}));
    EXPECT_THAT(inWall, testing::HasSubstr("cell that the geometry cuts"));
    EXPECT_THAT(inWall, testing::HasSubstr("give a smaller --size"));
}

} // namespace
} // namespace i2b::test
