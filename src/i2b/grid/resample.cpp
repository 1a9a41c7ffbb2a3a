#include "i2b/grid/resample.h"

namespace i2b {
namespace {

constexpr std::array<std::uint64_t, 3> unitShift{0, 32, 4}; // of half a node along y and z, in bits

// The cells 0 2 4 6 along the axis, or those of each pair's union, moved together into the low half.
LeafBits halved(const LeafBits& b, std::size_t axis, bool any) {
    LeafBits r{};
    for (std::size_t x = 0; x < 8; ++x) {
        std::uint64_t w = b[x];
        if (axis == 0) {
            if (x < 4) r[x] = b[2 * x] | (any ? b[2 * x + 1] : 0);
        } else if (axis == 1) {
            if (any) w |= w >> 8;
            w &= 0x00ff00ff00ff00ffull;
            w = (w | w >> 8) & 0x0000ffff0000ffffull;
            r[x] = (w | w >> 16) & 0x00000000ffffffffull;
        } else {
            if (any) w |= w >> 1;
            w &= 0x5555555555555555ull;
            w = (w | w >> 1) & 0x3333333333333333ull;
            r[x] = (w | w >> 2) & 0x0f0f0f0f0f0f0f0full;
        }
    }
    return r;
}

// The inverse, from the low or the high half: every cell twice.
LeafBits doubled(const LeafBits& b, std::size_t axis, int half) {
    LeafBits r{};
    for (std::size_t x = 0; x < 8; ++x) {
        std::uint64_t w = b[x];
        if (axis == 0) {
            r[x] = b[static_cast<std::size_t>(4 * half) + x / 2];
        } else if (axis == 1) {
            w = (w >> (32 * half)) & 0x00000000ffffffffull;
            w = (w | w << 16) & 0x0000ffff0000ffffull;
            w = (w | w << 8) & 0x00ff00ff00ff00ffull;
            r[x] = w | w << 8;
        } else {
            w = (w >> (4 * half)) & 0x0f0f0f0f0f0f0f0full;
            w = (w | w << 2) & 0x3333333333333333ull;
            w = (w | w << 1) & 0x5555555555555555ull;
            r[x] = w | w << 1;
        }
    }
    return r;
}

// The low cell of each pair only.
LeafBits spread(const LeafBits& b, std::size_t axis, int half) {
    LeafBits r = doubled(b, axis, half);
    for (std::size_t x = 0; x < 8; ++x) {
        if (axis == 0) r[x] = x & 1 ? 0 : r[x];
        if (axis == 1) r[x] &= 0x00ff00ff00ff00ffull;
        if (axis == 2) r[x] &= 0x5555555555555555ull;
    }
    return r;
}

LeafBits atHalf(const LeafBits& b, std::size_t axis, int half) {
    if (half == 0) return b;
    LeafBits r{};
    for (std::size_t x = 0; x < 8; ++x) r[x] = axis == 0 ? (x < 4 ? 0 : b[x - 4]) : b[x] << unitShift[axis];
    return r;
}

openvdb::Coord nodeOrigin(openvdb::Coord c) { return {c.x() & ~7, c.y() & ~7, c.z() & ~7}; }

LeafBits read(MaskReader& reader, const openvdb::Coord& origin) { return leafBits(reader.probeConstLeaf(origin)); }

Mask::Ptr coarsened(const Mask& fine, std::size_t axis, bool any) {
    const int a = static_cast<int>(axis);
    auto coarse = std::make_shared<Mask>(false);
    openvdb::tree::ValueAccessor<Mask> touch(*coarse);
    for (const MaskLeaf* leaf : leavesOf(fine)) {
        openvdb::Coord o = leaf->origin();
        o[a] >>= 1;
        touch.touchLeaf(nodeOrigin(o));
    }
    coarse = fillLeaves(coarse, [&] {
        return [reader = MaskReader(fine), axis, a, any](openvdb::Coord o) mutable {
            LeafBits r{};
            o[a] *= 2;
            for (int half = 0; half < 2; ++half, o[a] += 8) {
                const LeafBits part = atHalf(halved(read(reader, o), axis, any), axis, half);
                for (std::size_t n = 0; n < 8; ++n) r[n] |= part[n];
            }
            return r;
        };
    });
    pruneEmptyLeaves(*coarse);
    return coarse;
}

template <class Expand>
Mask::Ptr expanded(const Mask& coarse, std::size_t axis, const Expand& expand) {
    const int a = static_cast<int>(axis);
    auto fine = std::make_shared<Mask>(false);
    openvdb::tree::ValueAccessor<Mask> touch(*fine);
    for (const MaskLeaf* leaf : leavesOf(coarse)) {
        openvdb::Coord o = leaf->origin();
        o[a] *= 2;
        for (int half = 0; half < 2; ++half, o[a] += 8) {
            if (bits::any(expand(leafBits(leaf), axis, half))) touch.touchLeaf(o);
        }
    }
    return fillLeaves(fine, [&] {
        return [reader = MaskReader(coarse), axis, a, &expand](openvdb::Coord o) mutable {
            const int half = o[a] >> 3 & 1;
            o[a] >>= 1;
            return expand(read(reader, nodeOrigin(o)), axis, half);
        };
    });
}

// Steps towards `to`: first all that make the mask smaller.
template <class Expand>
Mask::Ptr resampled(const Mask& cells, LevelTriple from, LevelTriple to, bool any, const Expand& expand) {
    auto mask = std::make_shared<Mask>(cells);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        for (; from[axis] > to[axis]; --from[axis]) mask = coarsened(*mask, axis, any);
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
        for (; from[axis] < to[axis]; ++from[axis]) mask = expanded(*mask, axis, expand);
    }
    return mask;
}

} // namespace

Mask::Ptr overlapping(const Mask& cells, LevelTriple from, LevelTriple to) {
    return resampled(cells, from, to, true, doubled);
}
Mask::Ptr sampled(const Mask& cells, LevelTriple from, LevelTriple to) {
    return resampled(cells, from, to, false, doubled);
}
Mask::Ptr embeddedVertices(const Mask& vertices, LevelTriple from, LevelTriple to) {
    return resampled(vertices, from, to, false, spread);
}

bool sharesVolume(const Mask& a, const LevelTriple& levelA, const Mask& b, const LevelTriple& levelB) {
    const LevelTriple common = coarserOf(levelA, levelB);
    return !isEmpty(*intersectionOf(*overlapping(a, levelA, common), *overlapping(b, levelB, common)));
}

} // namespace i2b
