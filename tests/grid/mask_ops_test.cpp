// Proves: the bit-parallel tree operations equal their definition cell by cell, on random masks that span nodes.
#include "i2b/grid/mask_ops.h"
#include "i2b/grid/ranked_mask.h"
#include <functional>
#include <gtest/gtest.h>
#include <random>
#include <set>

namespace i2b {
namespace {

using CellSet = std::set<Index3>;
constexpr int side = 40;

Mask::Ptr randomMask(unsigned seed, double density) {
    std::mt19937 random(seed);
    auto mask = std::make_shared<Mask>(false);
    const int blobs = static_cast<int>(density * 300);
    for (int i = 0; i < blobs; ++i) {
        const auto at = [&] { return static_cast<int>(random() % side); };
        const Index3 lo{at(), at(), at()};
        for (int k = 0; k < 12; ++k) {
            const auto near = [&](int v) { return std::min(side - 1, v + static_cast<int>(random() % 4)); };
            mask->setValueOn({near(lo[0]), near(lo[1]), near(lo[2])});
        }
    }
    return mask;
}

CellSet setOf(const Mask& mask) {
    CellSet cells;
    for (auto it = mask.cbeginValueOn(); it; ++it) cells.insert(toIndex(it.getCoord()));
    return cells;
}

CellSet mapped(const CellSet& cells, const std::function<void(const Index3&, CellSet&)>& f) {
    CellSet out;
    for (const Index3& c : cells) f(c, out);
    return out;
}

class MaskOps : public testing::TestWithParam<unsigned> {
  protected:
    Mask::Ptr a = randomMask(GetParam(), 1), b = randomMask(GetParam() + 100, 0.7);
    CellSet as = setOf(*a), bs = setOf(*b);
};

TEST_P(MaskOps, ParentsAndEvenSamples) {
    EXPECT_EQ(setOf(*parentsOf(*a)), mapped(as, [](const Index3& c, CellSet& out) { out.insert({c[0] >> 1, c[1] >> 1, c[2] >> 1}); }));
    EXPECT_EQ(setOf(*evenSamplesOf(*a)), mapped(as, [](const Index3& c, CellSet& out) {
                  if (!((c[0] | c[1] | c[2]) & 1)) out.insert({c[0] >> 1, c[1] >> 1, c[2] >> 1});
              }));
}

TEST_P(MaskOps, ChildrenAndCorners) {
    const auto cube = [](int scale) {
        return [scale](const Index3& c, CellSet& out) {
            for (int i = 0; i < 8; ++i) out.insert({scale * c[0] + (i & 1), scale * c[1] + (i >> 1 & 1), scale * c[2] + (i >> 2)});
        };
    };
    EXPECT_EQ(setOf(*childrenOf(*a)), mapped(as, cube(2)));
    EXPECT_EQ(setOf(*cornersOf(*a)), mapped(as, cube(1)));
}

TEST_P(MaskOps, SetOperations) {
    CellSet u = as, d, i;
    u.insert(bs.begin(), bs.end());
    for (const Index3& c : as) (bs.count(c) ? i : d).insert(c);
    EXPECT_EQ(setOf(*unionOf(*a, *b)), u);
    EXPECT_EQ(setOf(*differenceOf(*a, *b)), d);
    EXPECT_EQ(setOf(*intersectionOf(*a, *b)), i);
    EXPECT_EQ(countOf(*a), as.size());
}

TEST_P(MaskOps, DilationIsAChebyshevBallWithinTheDomain) {
    for (int n : {1, 2, 3}) {
        const CellSet expected = mapped(as, [&](const Index3& c, CellSet& out) {
            for (int x = -n; x <= n; ++x)
                for (int y = -n; y <= n; ++y)
                    for (int z = -n; z <= n; ++z) {
                        const Index3 p{c[0] + x, c[1] + y, c[2] + z};
                        if (std::min({p[0], p[1], p[2]}) >= 0 && std::max({p[0], p[1], p[2]}) < side) out.insert(p);
                    }
        });
        EXPECT_EQ(setOf(*dilated(*a, n, {side, side, side})), expected) << n;
    }
}

TEST_P(MaskOps, RanksFollowTreeOrder) {
    const RankedMask ranked(a, 7);
    RankedMask::Reader reader(ranked);
    EXPECT_EQ(ranked.size(), static_cast<std::int64_t>(as.size()));
    std::int64_t expected = 7;
    std::vector<Index3> inOrder(as.size());
    ranked.forEach([&](std::int64_t rank, const Index3& c) { inOrder[static_cast<std::size_t>(rank - 7)] = c; });
    for (const Index3& c : inOrder) EXPECT_EQ(reader.rank(c), expected++);
    for (const Index3& c : bs) EXPECT_EQ(reader.rank(c) >= 0, as.count(c) == 1);
}

TEST_P(MaskOps, FloodFillsOneFaceConnectedPiece) {
    for (const MaskLeaf* leaf : leavesOf(std::as_const(*a))) {
        const LeafBits open = leafBits(leaf);
        LeafBits rest = open;
        bits::forEach(open, [&](int x, int y, int z) {
            if (!bits::test(rest, bits::offset(x, y, z))) return;
            LeafBits seed{};
            seed[std::size_t(x)] = std::uint64_t(1) << (y * 8 + z);
            const LeafBits got = bits::flood(seed, open);
            CellSet piece{{x, y, z}};
            std::vector<Index3> stack{{x, y, z}};
            while (!stack.empty()) {
                const Index3 c = stack.back();
                stack.pop_back();
                for (std::size_t d = 0; d < 6; ++d) {
                    Index3 n = c;
                    n[d / 2] += d % 2 ? 1 : -1;
                    if (std::min({n[0], n[1], n[2]}) < 0 || std::max({n[0], n[1], n[2]}) > 7) continue;
                    if (bits::test(open, bits::offset(n[0], n[1], n[2])) && piece.insert(n).second) stack.push_back(n);
                }
            }
            CellSet found;
            bits::forEach(got, [&](int i, int j, int k) { found.insert({i, j, k}); });
            EXPECT_EQ(found, piece);
            for (std::size_t w = 0; w < 8; ++w) rest[w] &= ~got[w];
        });
    }
}

INSTANTIATE_TEST_SUITE_P(Random, MaskOps, testing::Range(1u, 5u));

} // namespace
} // namespace i2b
