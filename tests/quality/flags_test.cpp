// Proves: flags that are set are found, each once and in order, also after others have been taken back, in any block.
#include "i2b/quality/flags.h"
#include <gtest/gtest.h>
#include <map>
#include <random>

namespace i2b::test {
namespace {

TEST(Flags, AreFoundInOrder) {
    std::mt19937 random(1);
    Flags flags(5000);
    std::map<std::size_t, std::uint8_t> expected;
    for (int i = 0; i < 3000; ++i) {
        const std::size_t at = random() % flags.size();
        const auto to = static_cast<std::uint8_t>(random() % 3);
        flags.set(at, to);
        if (to == 0) expected.erase(at);
        else expected[at] = to;
        if (i % 500 != 0) continue;
        std::map<std::size_t, std::uint8_t> found;
        std::size_t count = 0, last = 0;
        flags.forEach([&](std::size_t k) {
            EXPECT_TRUE(count++ == 0 || k > last);
            last = k, found[k] = flags[k];
        });
        EXPECT_EQ(found, expected);
        EXPECT_EQ(count, expected.size());
    }
}

} // namespace
} // namespace i2b::test
