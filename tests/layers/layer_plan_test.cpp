// Proves: of first height, thickness and growth any two give the third; a part takes from the others what it leaves out;
// contradictions are found; a stack keeps to its plan as far as the room goes, without a jump where the rules change; the
// first height from y+ is that of a flat plate.
#include "i2b/layers/layer_plan.h"
#include "i2b/layers/y_plus.h"
#include <gmock/gmock.h>

namespace i2b::test {
namespace {

using testing::HasSubstr;

LayerPlan solved(int count, double first, double thickness, double growth) {
    const LayerRequest request{count, first, thickness, growth};
    EXPECT_EQ(faultOf(request), "");
    return planOf(request, LayerUnit::metre);
}

double thicknessOf(const LayerPlan& plan) { return askedThickness(plan, 1e9, 1); }

// 1 + 1.5 + 2.25 + 3.375 = 8.125
TEST(LayerPlan, TwoGiveTheThird) {
    for (const LayerPlan& plan : {solved(4, 1e-3, 0, 1.5), solved(4, 0, 8.125e-3, 1.5), solved(4, 1e-3, 8.125e-3, 0), solved(4, 1e-3, 8.125e-3, 1.5)}) {
        EXPECT_EQ(plan.count, 4);
        EXPECT_NEAR(plan.first, 1e-3, 1e-12);
        EXPECT_NEAR(plan.growth, 1.5, 1e-9);
        EXPECT_NEAR(thicknessOf(plan), 8.125e-3, 1e-11);
    }
    EXPECT_NEAR(solved(3, 2, 3.5, 0).growth, 0.5, 1e-9); // 2 + 1 + 0.5
    EXPECT_NEAR(thicknessOf(solved(3, 1, 0, 0)), 1 + 1.2 + 1.44, 1e-12);
    EXPECT_NEAR(solved(3, 0, 3.64, 0).first, 1, 1e-12);
    EXPECT_TRUE(solved(3, 0, 0, 1.3).fills());
    EXPECT_NEAR(thicknessOf(solved(1, 0.5, 0, 0)), 0.5, 1e-12);
}

// 1 + 1.5 + 2.25 + 3.375, and as much as the last once more for the cell over them.
TEST(LayerPlan, WantsRoomForItsLayersAndACellOverThem) {
    EXPECT_NEAR(solved(4, 1e-3, 0, 1.5).room(), 11.5e-3, 1e-12);
    EXPECT_EQ(solved(3, 0, 0, 1.3).room(), 0); // they take what there is
    LayerPlan none;
    none.count = 0, none.first = 1;
    EXPECT_EQ(none.room(), 0);
}

TEST(LayerPlan, ContradictionsAreFound) {
    EXPECT_THAT(faultOf({4, 1e-3, 0.02, 1.5}), HasSubstr("0.008125 thick, not 0.02"));
    EXPECT_EQ(faultOf({4, 1e-3, 8.15e-3, 1.5}), ""); // within a hundredth
    EXPECT_THAT(faultOf({3, 1, 22, 0}), HasSubstr("1.75 to 21 thick, not 22"));
    EXPECT_THAT(faultOf({3, 1, 1.7, 0}), HasSubstr("not 1.7"));
    EXPECT_THAT(faultOf({1, 1, 2, 0}), HasSubstr("not 2"));
    EXPECT_EQ(faultOf({0, 1, 2, 3}), ""); // no layers, no heights
}

TEST(LayerPlan, PartsTakeWhatTheyLeaveOut) {
    LayerOptions all;
    all.first = 1e-3, all.growth = 1.25;
    const auto request = [&](const PartLayers& part) {
        const LayerRequest r = requestOf(all, part);
        return std::array{double(r.count), r.first, r.thickness, r.growth};
    };
    using R = std::array<double, 4>;
    EXPECT_EQ(request({"a", 2}), (R{2, 1e-3, 0, 1.25}));
    EXPECT_EQ(request({"a", 2, 3e-3}), (R{2, 3e-3, 0, 1.25}));
    EXPECT_EQ(request({"a", 2, 0, 0.01}), (R{2, 1e-3, 0.01, 0}));
    EXPECT_EQ(request({"a", 2, 0, 0.01, 1.1}), (R{2, 0, 0.01, 1.1}));
    EXPECT_EQ(request({"a", 2, 0, 0, 1.1}), (R{2, 1e-3, 0, 1.1}));
    all.thickness = 0.02, all.first = 0;
    EXPECT_EQ(request({"a", 2, 3e-3}), (R{2, 3e-3, 0, 1.25}));
    EXPECT_EQ(request({"a", 2}), (R{2, 0, 0.02, 1.25}));
}

auto Near(double tolerance, const std::vector<double>& values) { return testing::Pointwise(testing::DoubleNear(tolerance), values); }

std::vector<double> cellHeights(const LayerPlan& plan, double room, int cells) {
    std::vector<double> z(static_cast<std::size_t>(cells));
    stackLevels(plan, room, 1, cells, z.data());
    z.back() = room;
    for (std::size_t k = z.size(); k-- > 1;) z[k] -= z[k - 1];
    return z;
}

// 1, 1.2, 1.44: 3.64 in all.
TEST(StackLevels, FollowThePlanAsFarAsTheRoomGoes) {
    const LayerPlan plan{3, 1, 1.2, false};
    EXPECT_EQ(wantedCells(plan, 3.64 + 0.71, 1), 3);
    EXPECT_EQ(wantedCells(plan, 3.64 + 0.73, 1), 4);
    EXPECT_THAT(cellHeights(plan, 10, 4), Near(1e-9, {1, 1.2, 1.44, 6.36}));
    EXPECT_THAT(cellHeights(plan, 10, 2), Near(1e-9, {1.0, 9.0}));      // beside a low stack
    EXPECT_THAT(cellHeights(plan, 3, 3), Near(1e-6, {1.0, 1.0, 1.0}));  // growth falls to 1
    EXPECT_THAT(cellHeights(plan, 1.5, 3), Near(1e-6, {.5, .5, .5}));   // then all fall
    const std::vector<double> shared = cellHeights(plan, 4.2, 3); // half a layer at most is shared out
    EXPECT_NEAR(shared[0], 1, 1e-9);
    EXPECT_NEAR(shared[1] / shared[0], shared[2] / shared[1], 1e-6);
    EXPECT_GT(shared[1], 1.2);
    const std::vector<double> tight = cellHeights(plan, 3.5, 4); // one more than there is room for: half a layer remains
    EXPECT_NEAR(tight[0], 1, 1e-9);
    EXPECT_NEAR(tight[3], 0.5 * tight[2], 1e-6);
}

// Cells over layers far lower than the room: no one is more than three times as high as the one before, as few as do, all in one ratio; with
// one more or fewer, beside others, the layers themselves stay.
TEST(StackLevels, CellsOverThinLayersGrowGently) {
    const LayerPlan plan{3, 1, 1.2, false};
    for (double room = 4.5; room < 1000; room *= 1.07) {
        const int cells = wantedCells(plan, room, 1);
        const std::vector<double> heights = cellHeights(plan, room, cells);
        for (std::size_t k = 1; k < heights.size(); ++k) EXPECT_LE(heights[k], 3.0000001 * heights[k - 1]) << room;
        if (cells > 4) {
            EXPECT_NEAR(heights[4] / heights[3], heights[3] / heights[2], 1e-6) << room;
            EXPECT_GT(cellHeights(plan, room, cells - 1).back(), 3 * cellHeights(plan, room, cells - 1)[std::size_t(cells) - 3]) << room << ": fewer would not do";
        }
        for (const int beside : {cells - 1, cells, cells + 1}) {
            if (beside < 4 || beside > plan.count + maxOver) continue;
            const std::vector<double> other = cellHeights(plan, room, beside);
            if (room < 3.64 + 0.5 * 1.44 * (beside - 3)) continue; // no room for so many
            EXPECT_THAT(std::vector<double>(other.begin(), other.begin() + 3), Near(1e-9, {1, 1.2, 1.44})) << room << ", " << beside;
        }
    }
    EXPECT_EQ(wantedCells(plan, 1e9, 1), plan.count + maxOver);
}

// Neighbours whose rooms differ a little have nearly the same heights, whichever cells they share.
TEST(StackLevels, DoNotJump) {
    const LayerPlan plan{5, 1, 1.2, false};
    for (const int cells : {2, 3, 5, 6, 7, 8}) {
        for (double room = 0.1; room < 14; room += 0.01) {
            const std::vector<double> a = cellHeights(plan, room, cells), b = cellHeights(plan, room + 0.01, cells);
            for (std::size_t k = 0; k < a.size(); ++k) {
                EXPECT_GT(a[k], 0);
                EXPECT_NEAR(a[k], b[k], 0.025) << cells << " cells, room " << room << ", cell " << k;
            }
        }
    }
}

// Re = 40 * 4.6 / 1.5e-5 = 1.22667e7; 2 log10 Re - 0.65 = 13.52744; Cf = 13.52744^-2.3 = 0.0025015;
// u_tau = 40 sqrt(Cf / 2) = 1.41464 m/s; y = 30 * 1.5e-5 / u_tau = 3.1810e-4 m, the cell twice that.
TEST(YPlus, IsThatOfAFlatPlate) {
    EXPECT_NEAR(plateFriction(1.226667e7), 0.0025015, 2e-7);
    EXPECT_NEAR(firstHeightOf(30, 40, 1.5e-5, 4.6), 6.3620e-4, 1e-7);
    EXPECT_NEAR(firstHeightOf(1, 40, 1.5e-5, 4.6), 6.3620e-4 / 30, 1e-8);
    LayerOptions o;
    o.yPlus = 30, o.velocity = 40, o.viscosity = 1.5e-5, o.length = 4.6;
    EXPECT_EQ(requestOf(o).first, firstHeightOf(30, 40, 1.5e-5, 4.6));
}

} // namespace
} // namespace i2b::test
