// Proves: sorting by buckets gives what sorting whole gives, whatever the buckets hold, on any number of threads.
#include "i2b/core/bucket_sort.h"
#include <gtest/gtest.h>
#include <random>
#include <tbb/global_control.h>

namespace i2b {
namespace {

struct Item {
    std::uint32_t key, value;
    friend auto operator<=>(const Item&, const Item&) = default;
};

// Of `keys` keys, the first of which has as many items as all others.
std::vector<Item> randomItems(std::size_t n, std::uint32_t keys) {
    std::mt19937 dice(static_cast<unsigned>(n) + keys);
    std::vector<Item> items(n);
    for (std::size_t i = 0; i < n; ++i) items[i] = {dice() % 2 ? 0 : static_cast<std::uint32_t>(dice() % keys), static_cast<std::uint32_t>(i)};
    std::shuffle(items.begin(), items.end(), dice);
    return items;
}

TEST(BucketSort, IsASort) {
    for (const std::size_t n : {0u, 1u, 2u, 1000u, 100000u}) {
        for (const std::uint32_t keys : {1u, 7u, 50000u}) {
            std::vector<Item> sorted = randomItems(n, keys);
            std::sort(sorted.begin(), sorted.end());
            for (const std::size_t threads : {1u, 3u}) {
                const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
                std::vector<Item> items = randomItems(n, keys);
                bucketSort(items, keys, [](const Item& i) { return std::size_t(i.key); });
                EXPECT_EQ(items, sorted) << n << " items, " << keys << " keys";
            }
        }
    }
}

} // namespace
} // namespace i2b
