// Proves: a node that stayed rests until a cell that it was judged by changes, whatever changes elsewhere or changed before.
#include "i2b/repair/resting_nodes.h"
#include <gtest/gtest.h>

namespace i2b {
namespace {

const MeshNode node{MeshNode::wall, 7}, other{MeshNode::front, 7};

TEST(RestingNodes, RestUntilSomethingAroundThemMoves) {
    RestingNodes resting;
    EXPECT_FALSE(resting.has(node, {1, 2, 3})); // never asked
    resting.moves({3});
    resting.next();
    resting.stays(node);
    EXPECT_TRUE(resting.has(node, {1, 2, 3}));
    EXPECT_FALSE(resting.has(other, {1, 2, 3})); // of another kind
    resting.next();
    resting.moves({4, 5});
    resting.next();
    EXPECT_TRUE(resting.has(node, {1, 2, 3}));
    EXPECT_FALSE(resting.has(node, {1, 2, 3, 4}));
    resting.moves({2});
    EXPECT_FALSE(resting.has(node, {1, 2, 3}));
    resting.next();
    resting.stays(node); // asked again
    EXPECT_TRUE(resting.has(node, {1, 2, 3, 4}));
}

// What moves at once reads nothing of each other.
TEST(RestingNodes, StayBesideWhatMovesAtTheSameTime) {
    RestingNodes resting;
    resting.stays(node);
    resting.moves({1});
    resting.next();
    EXPECT_TRUE(resting.has(node, {1}));
}

} // namespace
} // namespace i2b
