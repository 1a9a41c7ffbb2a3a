// Proves: a numbering holds what was put into it, each once and ascending, and knows the place of each and no other number,
// for few and for more than it starts with room for, close together and far apart.
#include "i2b/core/numbering.h"
#include <gtest/gtest.h>
#include <random>
#include <set>

namespace i2b {
namespace {

TEST(Numbering, KnowsThePlaceOfEach) {
    std::mt19937 dice(1);
    for (const int count : {0, 1, 255, 256, 257, 20000}) {
        for (const int range : {count + 1, 1 << 30}) {
            Numbering numbering;
            std::set<std::int32_t> all;
            for (int i = 0; i < count; ++i) {
                const auto number = static_cast<std::int32_t>(dice() % static_cast<unsigned>(range));
                numbering.add(number);
                all.insert(number);
            }
            numbering.close();
            ASSERT_EQ(numbering.items(), std::vector<std::int32_t>(all.begin(), all.end()));
            std::int32_t place = 0;
            for (const std::int32_t number : all) ASSERT_EQ(numbering.placeOf(number), place++);
            for (int i = 0; i < 1000; ++i) {
                const auto number = static_cast<std::int32_t>(dice() % (1u << 31));
                if (all.contains(number)) continue;
                ASSERT_EQ(numbering.placeOf(number), -1);
            }
        }
    }
}

} // namespace
} // namespace i2b
