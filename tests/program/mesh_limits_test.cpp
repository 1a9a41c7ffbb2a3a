// Proves: the least volume of a pyramid is OpenFOAM's where cells are much larger, falls with cells too small for it, and stays
// what a user gives.
#include "i2b/program/mesh_limits.h"
#include <gtest/gtest.h>

namespace i2b {
namespace {

LayerPlan layers(int count, double first) {
    LayerPlan plan;
    plan.count = count, plan.first = first;
    return plan;
}

TEST(MeshLimits, AreOpenFoamsForCellsOfAMillimetre) {
    EXPECT_EQ(meshLimits({}, 1e-3, {layers(1, 0)}).pyramidVolume, 1e-13);
    EXPECT_EQ(meshLimits({}, 0.03, {layers(12, 2e-5)}).pyramidVolume, 1e-13);
}

TEST(MeshLimits, LeaveRoomForSmallCells) {
    for (const double size : {2e-4, 1e-5, 1e-7}) {
        const double limit = meshLimits({}, size, {layers(0, 0), layers(3, 0)}).pyramidVolume;
        EXPECT_GT(limit, 0);
        EXPECT_LT(limit, 1e-3 * size * size * size);
    }
    EXPECT_LT(meshLimits({}, 1e-3, {layers(5, 1e-6)}).pyramidVolume, 1e-15); // thin ones, of a given height
}

TEST(MeshLimits, StayWhatAUserGives) {
    DictionaryLimits asked;
    asked.pyramidVolume = 1e-12;
    EXPECT_EQ(meshLimits(asked, 1e-6, {layers(3, 0)}).pyramidVolume, 1e-12);
}

} // namespace
} // namespace i2b
