// Proves: each flag that is set is met once, whatever stands around it and at any length; ranges know whether one of theirs is set.
#include "i2b/core/flags.h"
#include <gtest/gtest.h>
#include <random>

namespace i2b::test {
namespace {

TEST(Flags, EachThatIsSetIsMetOnce) {
    std::mt19937 random(3);
    for (const std::size_t n : {0u, 1u, 7u, 8u, 9u, 8191u, 8192u, 8193u, 100003u}) {
        for (const unsigned rare : {1u, 2u, 50u, 5000u}) {
            std::vector<std::uint8_t> flags(n, 0), met(n, 0);
            parallelFor(n, [&](std::size_t i) {
                if ((i * 2654435761u >> 7) % rare == 0) setFlag(flags[i]);
            });
            const std::vector<std::uint8_t> set = flags;
            forFlagged(flags, [&](std::size_t i) { ++met[i], flags[i] = 0; });
            EXPECT_EQ(met, set);
            EXPECT_FALSE(anyFlag(flags, 0, n)); // all were taken off
            for (int k = 0; k < 100 && n > 0; ++k) {
                const std::size_t a = random() % n, b = a + random() % std::min<std::size_t>(n - a, 40);
                EXPECT_EQ(anyFlag(set, a, b), std::any_of(set.begin() + std::ptrdiff_t(a), set.begin() + std::ptrdiff_t(b), [](std::uint8_t f) { return f != 0; }));
            }
        }
    }
}

} // namespace
} // namespace i2b::test
