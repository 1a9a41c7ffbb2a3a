// Proves: what is given up holds nothing any more, no memory either.
#include "i2b/core/give_up.h"
#include "i2b/core/raw_vector.h"
#include <gtest/gtest.h>

namespace i2b::test {
namespace {

TEST(GiveUp, LeavesNoMemory) {
    std::vector<int> plain(1000, 1);
    RawVector<double> raw(1000);
    giveUp(plain, raw);
    EXPECT_EQ(plain.capacity(), 0u);
    EXPECT_EQ(raw.capacity(), 0u);
}

} // namespace
} // namespace i2b::test
