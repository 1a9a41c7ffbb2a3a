// Proves: sums before each item are those of a loop from the first to the last, of none and of many.
#include "i2b/core/sums.h"
#include <gtest/gtest.h>

namespace i2b::test {
namespace {

TEST(SumsBefore, AreThoseOfALoop) {
    for (const std::size_t n : {std::size_t(0), std::size_t(1), std::size_t(8192), std::size_t(300001)}) {
        const auto count = [](std::size_t i) { return i * i % 7; };
        const RawVector<std::uint32_t> sums = sumsBefore<std::uint32_t>(n, count);
        ASSERT_EQ(sums.size(), n + 1);
        std::size_t sum = 0, wrong = 0;
        for (std::size_t i = 0; i < n; ++i) wrong += sums[i] != sum, sum += count(i);
        EXPECT_EQ(wrong, 0u);
        EXPECT_EQ(sums[n], sum);
    }
}

} // namespace
} // namespace i2b::test
