// Bit-parallel operations on one tree node of 8x8x8 cells: eight words, word x holds bit y * 8 + z (OpenVDB's leaf
// order). Everything in the grid stages that touches cells goes through words, 64 cells at a time.
#pragma once
#include <array>
#include <bit>
#include <cstdint>

namespace i2b {

using LeafBits = std::array<std::uint64_t, 8>;

namespace bits {

inline constexpr std::uint64_t zLow = 0x0101010101010101ull; // z == 0
inline constexpr std::uint64_t zHigh = zLow << 7;            // z == 7
inline constexpr std::uint64_t yLow = 0xffull;               // y == 0
inline constexpr std::uint64_t yHigh = yLow << 56;           // y == 7

inline bool any(const LeafBits& b) {
    std::uint64_t all = 0;
    for (std::uint64_t w : b) all |= w;
    return all != 0;
}
inline int count(const LeafBits& b) {
    int n = 0;
    for (std::uint64_t w : b) n += std::popcount(w);
    return n;
}
inline int offset(int x, int y, int z) { return (x & 7) << 6 | (y & 7) << 3 | (z & 7); }
inline bool test(const LeafBits& b, int offset) { return b[static_cast<std::size_t>(offset >> 6)] >> (offset & 63) & 1; }

// Calls f(x, y, z) for every set bit, in order.
template <class F>
void forEach(const LeafBits& b, const F& f) {
    for (int x = 0; x < 8; ++x) {
        for (std::uint64_t w = b[static_cast<std::size_t>(x)]; w != 0; w &= w - 1) {
            const int bit = std::countr_zero(w);
            f(x, bit >> 3, bit & 7);
        }
    }
}

// The cells whose neighbour one step up (towards +axis) is set, given this node and the next node on that side.
inline LeafBits neighbourUp(const LeafBits& b, const LeafBits& next, int axis) {
    LeafBits r{};
    for (std::size_t x = 0; x < 8; ++x) {
        if (axis == 0) {
            r[x] = x < 7 ? b[x + 1] : next[0];
        } else if (axis == 1) {
            r[x] = b[x] >> 8 | next[x] << 56;
        } else {
            r[x] = (b[x] >> 1 & ~zHigh) | (next[x] & zLow) << 7;
        }
    }
    return r;
}

// The cells whose neighbour one step down (towards -axis) is set, given this node and the previous one.
inline LeafBits neighbourDown(const LeafBits& b, const LeafBits& previous, int axis) {
    LeafBits r{};
    for (std::size_t x = 0; x < 8; ++x) {
        if (axis == 0) {
            r[x] = x > 0 ? b[x - 1] : previous[7];
        } else if (axis == 1) {
            r[x] = b[x] << 8 | previous[x] >> 56;
        } else {
            r[x] = (b[x] << 1 & ~zLow) | (previous[x] & zHigh) >> 7;
        }
    }
    return r;
}

// Drops the cells from `end` on along the axis.
inline void clip(LeafBits& b, int axis, int end) {
    if (end >= 8) return;
    for (int x = 0; x < 8; ++x) {
        std::uint64_t keep = ~std::uint64_t(0);
        if (axis == 0) keep = x < end ? keep : 0;
        if (axis == 1) keep = (std::uint64_t(1) << (8 * end)) - 1;
        if (axis == 2) keep = ((std::uint64_t(1) << end) - 1) * zLow;
        b[static_cast<std::size_t>(x)] &= keep;
    }
}

// Face-connected flood of seed inside open (one node). A handful of passes, each over eight words.
inline LeafBits flood(const LeafBits& seed, const LeafBits& open) {
    LeafBits m = seed;
    for (bool grown = true; grown;) {
        grown = false;
        const auto step = [&](std::size_t x, std::uint64_t from) {
            std::uint64_t w = m[x] | (from & open[x]);
            for (std::uint64_t last = 0; w != last;) {
                last = w;
                w |= (w << 8 | w >> 8 | (w << 1 & ~zLow) | (w >> 1 & ~zHigh)) & open[x];
            }
            if (w != m[x]) m[x] = w, grown = true;
        };
        for (std::size_t x = 0; x < 8; ++x) step(x, x > 0 ? m[x - 1] : 0);
        for (std::size_t x = 7; x-- > 0;) step(x, m[x + 1]);
    }
    return m;
}

// One octant of the parent node from this node: bit (x, y, z) of the 4x4x4 result is set where any of the 2x2x2
// children is (any = true), or where the even child is (any = false). Placed at 4 * (ox, oy, oz).
inline void restrictInto(LeafBits& parent, const LeafBits& b, int ox, int oy, int oz, bool any) {
    for (std::size_t i = 0; i < 4; ++i) {
        std::uint64_t w = b[2 * i];
        if (any) {
            w |= b[2 * i + 1];
            w |= w >> 8;
            w |= w >> 1;
        }
        w &= 0x0055005500550055ull;          // rows 0 2 4 6, columns 0 2 4 6
        w = (w | w >> 1) & 0x0033003300330033ull;
        w = (w | w >> 2) & 0x000f000f000f000full; // a nibble in each even row
        w = (w | w >> 8) & 0x00000f0f00000f0full;
        w = (w | w >> 16) & 0x000000000f0f0f0full;
        parent[i + static_cast<std::size_t>(4 * ox)] |= w << (4 * oz + 32 * oy);
    }
}

// The inverse: the children of one octant of the parent node fill a whole node.
inline LeafBits prolong(const LeafBits& parent, int ox, int oy, int oz) {
    LeafBits r{};
    for (std::size_t i = 0; i < 4; ++i) {
        std::uint64_t w = parent[i + static_cast<std::size_t>(4 * ox)] >> (4 * oz + 32 * oy) & 0x0f0f0f0full;
        w = (w | w << 16) & 0x00000f0f00000f0full;
        w = (w | w << 8) & 0x000f000f000f000full;
        w = (w | w << 2) & 0x0033003300330033ull;
        w = (w | w << 1) & 0x0055005500550055ull;
        w |= w << 1;
        w |= w << 8;
        r[2 * i] = r[2 * i + 1] = w;
    }
    return r;
}

} // namespace bits
} // namespace i2b
