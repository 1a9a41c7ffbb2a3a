// Proves: the octree's two operations give what the plain ones give cell by cell, in and across nodes, for every width of
// the buffer, at the borders of the domain, on any number of threads.
#include "i2b/grid/octree.h"
#include "i2b/core/checksum.h"
#include <gtest/gtest.h>
#include <random>
#include <set>
#include <tbb/global_control.h>

namespace i2b {
namespace {

using Cells = std::set<Index3>;

Cells cellsOf(const Mask& mask) {
    Cells cells;
    for (auto it = mask.cbeginValueOn(); it; ++it) cells.insert(toIndex(it.getCoord()));
    return cells;
}

// Clumps and single cells, many of them beside the faces of nodes and of the domain.
Mask::Ptr randomMask(std::mt19937& random, const Index3& size, int clumps) {
    auto mask = std::make_shared<Mask>(false);
    const auto below = [&](std::int32_t n) { return static_cast<std::int32_t>(random() % static_cast<unsigned>(n)); };
    for (int i = 0; i < clumps; ++i) {
        Index3 at{}, edge{};
        for (std::size_t a = 0; a < 3; ++a) {
            at[a] = i % 3 ? below(size[a]) : std::min(size[a] - 1, below(size[a]) / 128 * 128 + below(3));
            edge[a] = i % 4 ? below(3) : below(40);
        }
        for (std::int32_t x = at[0]; x <= std::min(at[0] + edge[0], size[0] - 1); ++x)
            for (std::int32_t y = at[1]; y <= std::min(at[1] + edge[1], size[1] - 1); ++y)
                for (std::int32_t z = at[2]; z <= std::min(at[2] + edge[2], size[2] - 1); ++z) mask->setValueOn({x, y, z});
    }
    return mask;
}

class Octree : public testing::TestWithParam<int> {
  protected:
    std::mt19937 random_{static_cast<unsigned>(GetParam())};
    const Index3 size_{150, 70, 131}, fine_{300, 140, 262};
};

TEST_P(Octree, ParentsAroundAreParentsOfWhatIsGrown) {
    const int n = GetParam();
    const Mask::Ptr a = randomMask(random_, fine_, 12), b = randomMask(random_, fine_, 6);
    Cells expected;
    for (const Mask* mask : {a.get(), b.get()}) {
        for (const Index3& c : cellsOf(*mask)) {
            Index3 lo{}, hi{};
            for (std::size_t i = 0; i < 3; ++i) lo[i] = std::max(0, c[i] - n) >> 1, hi[i] = std::min(fine_[i] - 1, c[i] + n) >> 1;
            for (std::int32_t x = lo[0]; x <= hi[0]; ++x)
                for (std::int32_t y = lo[1]; y <= hi[1]; ++y)
                    for (std::int32_t z = lo[2]; z <= hi[2]; ++z) expected.insert({x, y, z});
        }
    }
    const Mask::Ptr parents = parentsAround(*a, *b, n, size_);
    EXPECT_EQ(cellsOf(*parents), expected);
    EXPECT_FALSE(parents->hasActiveTiles());
}

TEST_P(Octree, ChildrenLessAreAllEightButThoseSplitAgain) {
    const Mask::Ptr split = randomMask(random_, size_, 12), again = randomMask(random_, fine_, 20);
    Cells expected;
    for (const Index3& c : cellsOf(*split)) {
        for (int i = 0; i < 8; ++i) {
            const Index3 child{2 * c[0] + (i >> 2), 2 * c[1] + (i >> 1 & 1), 2 * c[2] + (i & 1)};
            if (!again->isValueOn(toCoord(child))) expected.insert(child);
        }
    }
    EXPECT_EQ(cellsOf(*childrenLess(*split, *again)), expected);
}

TEST_P(Octree, BoxLessIsTheRestOfTheBox) {
    const Mask::Ptr again = randomMask(random_, size_, 12);
    Cells expected;
    for (std::int32_t x = 0; x < size_[0]; ++x)
        for (std::int32_t y = 0; y < size_[1]; ++y)
            for (std::int32_t z = 0; z < size_[2]; ++z)
                if (!again->isValueOn({x, y, z})) expected.insert({x, y, z});
    EXPECT_EQ(cellsOf(*boxLess(size_, *again)), expected);
}

TEST_P(Octree, IsTheSameOnAnyNumberOfThreads) {
    const Mask::Ptr a = randomMask(random_, fine_, 20), b = randomMask(random_, fine_, 20);
    std::set<std::uint64_t> sums;
    for (std::size_t threads : {1, 2, 3, 8}) {
        tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
        Checksum sum;
        const Mask::Ptr parents = parentsAround(*a, *b, GetParam(), size_);
        addTo(sum, *parents);
        addTo(sum, *childrenLess(*parents, *a));
        sums.insert(sum.value());
    }
    EXPECT_EQ(sums.size(), 1u);
}

INSTANTIATE_TEST_SUITE_P(Widths, Octree, testing::Values(0, 1, 3, 5, 8));

} // namespace
} // namespace i2b
