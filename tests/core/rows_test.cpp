// Proves: rows are what a plain loop gives, on any number of threads and in any order asked for; starts are the sums before.
#include "i2b/core/rows.h"
#include <algorithm>
#include <gtest/gtest.h>
#include <random>
#include <tbb/global_control.h>
#include <vector>

namespace i2b::test {
namespace {

// Rows are what a plain loop makes of them, whatever the threads and however many: empty ones, items in no row, in several, and
// more than once in one.
TEST(TurnIntoRows, IsWhatAPlainLoopGives) {
    std::mt19937 random(7);
    for (const std::size_t rows : {1u, 3u, 50000u}) {
        constexpr std::size_t first = 11, last = 60011;
        std::vector<std::vector<std::uint32_t>> rowsOf(last);
        for (auto& of : rowsOf) {
            of.resize(random() % 4);
            for (std::uint32_t& r : of) r = static_cast<std::uint32_t>(random() % (rows < 10 && random() % 50 ? 1 : rows));
        }
        std::vector<std::vector<std::int32_t>> expected(rows);
        for (std::size_t i = first; i < last; ++i)
            for (const std::uint32_t r : rowsOf[i]) expected[r].push_back(static_cast<std::int32_t>(i));
        const auto put = [&](std::size_t i, const auto& to) {
            for (const std::uint32_t r : rowsOf[i]) to(r);
        };
        for (const std::size_t threads : {1u, 8u}) {
            const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
            RawVector<std::uint32_t> start;
            RawVector<std::int32_t> items;
            turnIntoRows(rows, first, last, put, start, items);
            ASSERT_EQ(start.size(), rows + 1);
            ASSERT_EQ(start.back(), items.size());
            for (std::size_t r = 0; r < rows; ++r)
                ASSERT_TRUE(std::equal(items.begin() + start[r], items.begin() + start[r + 1], expected[r].begin(), expected[r].end())) << r << " of " << rows;
        }
    }
}

// Another order than that of numbers, which may be another in each row.
TEST(TurnIntoRows, KeepsTheOrderAskedFor) {
    RawVector<std::int64_t> start;
    RawVector<std::int32_t> items;
    const auto all = [](std::size_t, const auto& put) { put(0), put(1); };
    turnIntoRows(2, 0, 5, all, [](std::size_t row, std::int32_t a, std::int32_t b) { return row == 0 ? a > b : a < b; }, start, items);
    EXPECT_EQ(std::vector<std::int64_t>(start.begin(), start.end()), (std::vector<std::int64_t>{0, 5, 10}));
    EXPECT_EQ(std::vector<std::int32_t>(items.begin(), items.end()), (std::vector<std::int32_t>{4, 3, 2, 1, 0, 0, 1, 2, 3, 4}));
}

// In place, long ones by many threads.
TEST(ExclusiveScan, GivesTheSumsBefore) {
    for (const std::size_t n : {0u, 1u, 100u, 100000u}) {
        std::vector<std::uint32_t> counts(n), expected(n);
        std::uint32_t sum = 0;
        for (std::size_t i = 0; i < n; ++i) counts[i] = static_cast<std::uint32_t>(i * 7 % 5), expected[i] = sum, sum += counts[i];
        EXPECT_EQ(exclusiveScan(counts), sum);
        EXPECT_EQ(counts, expected) << n;
    }
}

} // namespace
} // namespace i2b::test
