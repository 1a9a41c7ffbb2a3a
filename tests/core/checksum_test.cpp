// Proves: a checksum depends on content and order, and lengths are part of it.
#include "i2b/core/checksum.h"
#include "i2b/core/parallel.h"
#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <vector>

namespace i2b {
namespace {

std::uint64_t sumOf(const std::vector<int>& a, const std::vector<int>& b) {
    Checksum sum;
    sum.add(std::span<const int>(a));
    sum.add(std::span<const int>(b));
    return sum.value();
}

TEST(Checksum, DependsOnContentOrderAndLength) {
    EXPECT_EQ(sumOf({1, 2}, {3}), sumOf({1, 2}, {3}));
    EXPECT_NE(sumOf({1, 2}, {3}), sumOf({1}, {2, 3}));
    EXPECT_NE(sumOf({1, 2}, {3}), sumOf({2, 1}, {3}));
    EXPECT_EQ(Checksum().hex().size(), 16u);
}

TEST(Parallel, OrderedReduceIsTheSameOnAnyNumberOfThreads) {
    std::vector<double> values(100000);
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = 1.0 / static_cast<double>(i + 1) - 0.3;
    const auto sum = [&] {
        return orderedReduce(
            values.size(), 0.0,
            [&](std::size_t begin, std::size_t end) {
                double s = 0;
                for (std::size_t i = begin; i < end; ++i) s += values[i];
                return s;
            },
            [](double a, double b) { return a + b; });
    };
    std::vector<double> results;
    for (std::size_t threads : {1, 2, 3, 8}) {
        tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
        results.push_back(sum());
    }
    for (double r : results) EXPECT_EQ(r, results.front());
}

// Truth values of chunks side by side do not share memory: none is lost, however many threads write at once. As bits of one word some
// were in each of 20 runs on two cores.
TEST(Parallel, OrderedReduceKeepsEveryTruthValue) {
    tbb::global_control control(tbb::global_control::max_allowed_parallelism, 8);
    const auto isOdd = [](std::size_t chunk) { // takes long enough for threads to come between each other
        std::uint64_t x = chunk;
        for (int i = 0; i < 60; ++i) x = x * 6364136223846793005u + 1442695040888963407u;
        return (x >> 40 & 1) != 0;
    };
    std::size_t wrong = 0;
    for (int round = 0; round < 3000; ++round) {
        std::size_t at = 0;
        const auto compare = [&](bool, bool value) {
            wrong += value != isOdd(at++);
            return value;
        };
        orderedReduce(std::size_t(64), false, [&](std::size_t begin, std::size_t) { return isOdd(begin); }, compare, 1);
    }
    EXPECT_EQ(wrong, 0u);
}

TEST(Parallel, ExclusiveScanTurnsCountsIntoOffsets) {
    std::vector<int> counts{3, 0, 2};
    EXPECT_EQ(exclusiveScan(counts), 5);
    EXPECT_EQ(counts, (std::vector<int>{0, 3, 3}));
}

} // namespace
} // namespace i2b
