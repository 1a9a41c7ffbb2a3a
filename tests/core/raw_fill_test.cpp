// Proves: raw vectors are filled with a value and copied whole, also over what was there before, whatever their length.
#include "i2b/core/raw_fill.h"
#include <algorithm>
#include <gtest/gtest.h>
#include <numeric>

namespace i2b::test {
namespace {

TEST(RawFill, FillsAndCopiesAnyLength) {
    RawVector<std::int32_t> copy = filled<std::int32_t>(100000, -3);
    EXPECT_EQ(std::count(copy.begin(), copy.end(), -3), 100000);
    for (const std::size_t n : {std::size_t(0), std::size_t(1), std::size_t(8191), std::size_t(70001), std::size_t(12)}) {
        RawVector<std::int32_t> from(n);
        std::iota(from.begin(), from.end(), 5);
        copyTo(copy, from);
        EXPECT_EQ(copy, from) << n;
    }
}

} // namespace
} // namespace i2b::test
