// Proves: many threads joining in any order give the sets, and the smallest members for names, that one
// thread gives.
#include "i2b/paint/union_find.h"
#include <algorithm>
#include <gtest/gtest.h>
#include <numeric>
#include <random>
#include <thread>
#include <vector>

namespace i2b::test {
namespace {

TEST(UnionFind, SameSetsInAnyOrderOnManyThreads) {
    constexpr std::uint32_t n = 20000;
    std::mt19937 random(7);
    std::vector<std::pair<std::uint32_t, std::uint32_t>> joins;
    for (std::uint32_t i = 0; i < n * 9 / 10; ++i) joins.emplace_back(random() % n, random() % n);
    for (std::uint32_t i = 0; i < 2000; ++i)
        joins.emplace_back(i + 1, i); // a long chain: all threads at one root

    std::vector<std::uint32_t> expected(n); // by plain relabelling
    std::iota(expected.begin(), expected.end(), 0u);
    const auto rootOf = [&](std::uint32_t i) {
        while (expected[i] != i) i = expected[i];
        return i;
    };
    for (auto [a, b] : joins) {
        const std::uint32_t ra = rootOf(a), rb = rootOf(b);
        expected[std::max(ra, rb)] = std::min(ra, rb);
    }
    for (int round = 0; round < 10; ++round) {
        std::shuffle(joins.begin(), joins.end(), random);
        UnionFind sets(n);
        constexpr std::size_t workers = 8;
        std::vector<std::thread> threads;
        for (std::size_t w = 0; w < workers; ++w) {
            threads.emplace_back([&, w] {
                for (std::size_t i = w; i < joins.size(); i += workers)
                    sets.join(joins[i].first, joins[i].second);
            });
        }
        for (std::thread& t : threads) t.join();
        std::size_t wrong = 0;
        for (std::uint32_t i = 0; i < n; ++i) wrong += sets.find(i) != rootOf(i);
        ASSERT_EQ(wrong, 0u) << "round " << round;
    }
}

} // namespace
} // namespace i2b::test
