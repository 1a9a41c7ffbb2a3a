// Proves: what a parallel loop finds comes in the order of its items, all of it, also of none and of many chunks.
#include "i2b/core/collect.h"
#include <gtest/gtest.h>

namespace i2b::test {
namespace {

TEST(Collect, KeepsTheOrderOfItems) {
    for (const std::size_t n : {std::size_t(0), std::size_t(1), std::size_t(999), std::size_t(100000)}) {
        const RawVector<std::size_t> found = collect<std::size_t>(n, [](std::size_t i, const auto& put) {
            for (std::size_t k = 0; k < i % 3; ++k) put(10 * i + k);
        }, 100);
        std::vector<std::size_t> expected;
        for (std::size_t i = 0; i < n; ++i)
            for (std::size_t k = 0; k < i % 3; ++k) expected.push_back(10 * i + k);
        EXPECT_TRUE(std::equal(found.begin(), found.end(), expected.begin(), expected.end())) << n;
    }
}

} // namespace
} // namespace i2b::test
