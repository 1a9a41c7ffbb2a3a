// Proves: the cut costs as little as the best of all choices, on random small problems.
#include "i2b/carve/min_cut.h"
#include <gtest/gtest.h>
#include <algorithm>
#include <random>

namespace i2b::test {
namespace {

struct Problem {
    struct Pair {
        std::size_t a, b;
        long first, second;
    };
    std::vector<long> taken, left;
    std::vector<Pair> pairs;

    Problem(unsigned seed, std::size_t items) {
        std::mt19937 random(seed);
        std::uniform_int_distribution<long> price(0, 6);
        for (std::size_t i = 0; i < items; ++i) {
            taken.push_back(price(random));
            left.push_back(price(random));
            for (std::size_t j = 0; j < i; ++j) {
                if (price(random) < 3) pairs.push_back({i, j, price(random), price(random)});
            }
        }
    }
    long cost(unsigned chosen) const {
        const auto is = [&](std::size_t i) { return (chosen >> i & 1) != 0; };
        long sum = 0;
        for (std::size_t i = 0; i < taken.size(); ++i) sum += is(i) ? taken[i] : left[i];
        for (const Pair& p : pairs) sum += is(p.a) && !is(p.b) ? p.first : !is(p.a) && is(p.b) ? p.second : 0;
        return sum;
    }
};

TEST(MinCut, CostsAsLittleAsTheBestOfAllChoices) {
    for (unsigned seed = 0; seed < 200; ++seed) {
        const std::size_t items = 1 + seed % 9;
        const Problem problem(seed, items);
        MinCut cut(items);
        for (std::size_t i = 0; i < items; ++i) {
            cut.addTaken(i, problem.taken[i]);
            cut.addLeft(i, problem.left[i]);
        }
        for (const Problem::Pair& p : problem.pairs) cut.addPair(p.a, p.b, p.first, p.second);
        const std::vector<unsigned char> taken = cut.solve();
        unsigned chosen = 0;
        for (std::size_t i = 0; i < items; ++i) chosen |= unsigned(taken[i] != 0) << i;
        long best = problem.cost(0);
        for (unsigned other = 0; other < 1u << items; ++other) best = std::min(best, problem.cost(other));
        EXPECT_EQ(problem.cost(chosen), best) << "seed " << seed;
    }
}

TEST(MinCut, OfNothingIsNothing) { EXPECT_TRUE(MinCut(0).solve().empty()); }

} // namespace
} // namespace i2b::test
