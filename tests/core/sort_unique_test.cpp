// Proves: vectors as sets are what a set of the same items holds, in order, sorted by one thread or by all.
#include "i2b/core/parallel_sort_unique.h"
#include "i2b/core/sort_unique.h"
#include <gtest/gtest.h>
#include <random>
#include <set>

namespace i2b::test {
namespace {

TEST(SortUnique, GivesWhatASetHolds) {
    std::mt19937 random(5);
    for (const int n : {0, 1, 2, 300, 200000}) {
        std::vector<std::uint32_t> items;
        for (int i = 0; i < n; ++i) items.push_back(static_cast<std::uint32_t>(random() % 5000));
        const std::set<std::uint32_t> expected(items.begin(), items.end());
        std::vector<std::uint32_t> byAll = items;
        sortUnique(items), parallelSortUnique(byAll);
        EXPECT_TRUE(std::ranges::equal(items, expected)) << n;
        EXPECT_EQ(byAll, items) << n;
    }
}

} // namespace
} // namespace i2b::test
