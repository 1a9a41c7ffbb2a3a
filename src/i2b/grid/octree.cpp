#include "i2b/grid/octree.h"
#include "i2b/grid/mask_nodes.h"

namespace i2b {
namespace {

using openvdb::Coord;
using Index = openvdb::Index;

// The leaves that the result's node of 16^3 leaves depends on: those of its 2x2x2 finer nodes, and one more on each side.
class FineLeaves {
  public:
    static constexpr int edge = 34;
    FineLeaves() : table_(std::size_t(edge) * edge * edge) {}

    // True if there is any.
    bool gather(const Mask& a, const Mask& b, const Coord& origin) {
        std::fill(table_.begin(), table_.end(), Pair{});
        any_ = false;
        gather(a, origin, &Pair::a);
        gather(b, origin, &Pair::b);
        return any_;
    }
    bool has(int x, int y, int z) const {
        const Pair& p = table_[place(x, y, z)];
        return p.a || p.b;
    }
    LeafBits bits(int x, int y, int z) const {
        const Pair& p = table_[place(x, y, z)];
        LeafBits r = leafBits(p.a);
        if (p.b) {
            const LeafBits more = leafBits(p.b);
            for (std::size_t n = 0; n < 8; ++n) r[n] |= more[n];
        }
        return r;
    }

  private:
    struct Pair {
        const MaskLeaf *a = nullptr, *b = nullptr;
    };
    static std::size_t place(int x, int y, int z) { return static_cast<std::size_t>((x * edge + y) * edge + z); }

    // Of the 4x4x4 finer nodes around, only the leaves that are near enough.
    void gather(const Mask& mask, const Coord& origin, const MaskLeaf* Pair::* which) {
        MaskReader reader(mask);
        for (int i = 0; i < 64; ++i) {
            const Coord at(2 * origin.x() + ((i >> 4) - 1) * nodeEdge, 2 * origin.y() + ((i >> 2 & 3) - 1) * nodeEdge,
                           2 * origin.z() + ((i & 3) - 1) * nodeEdge);
            if (const MaskNode* node = reader.probeConstNode<MaskNode>(at)) copy(*node, i, which);
        }
    }
    void copy(const MaskNode& node, int i, const MaskLeaf* Pair::* which) {
        const std::array<int, 3> block{i >> 4, i >> 2 & 3, i & 3};
        std::array<int, 3> lo{}, hi{};
        for (std::size_t k = 0; k < 3; ++k) {
            lo[k] = block[k] == 0 ? 15 : 0;
            hi[k] = block[k] == 3 ? 0 : 15;
        }
        const auto take = [&](int x, int y, int z) {
            const MaskLeaf* leaf = leafAt(&node, static_cast<Index>(x << 8 | y << 4 | z));
            if (!leaf) return;
            table_[place(x + 16 * block[0] - 15, y + 16 * block[1] - 15, z + 16 * block[2] - 15)].*which = leaf;
            any_ = true;
        };
        for (int x = lo[0]; x <= hi[0]; ++x) {
            for (int y = lo[1]; y <= hi[1]; ++y) {
                for (int z = lo[2]; z <= hi[2]; ++z) take(x, y, z);
            }
        }
    }

    std::vector<Pair> table_;
    bool any_ = false;
};

constexpr LeafBits full{~0ull, ~0ull, ~0ull, ~0ull, ~0ull, ~0ull, ~0ull, ~0ull};

// Along x, where words are what is counted: the eight parents of 32 words.
void alongX(const std::array<std::uint64_t, 32>& words, int n, LeafBits& parents) {
    for (int i = 0; i < 8; ++i) {
        std::uint64_t w = 0;
        for (int k = 8 + 2 * i - n; k <= 9 + 2 * i + n; ++k) w |= words[static_cast<std::size_t>(k)];
        parents[static_cast<std::size_t>(i)] = w;
    }
}

// Along y: bytes of four words in a row; the parents of the middle two, in one.
std::uint64_t alongY(const std::array<std::uint64_t, 4>& w, int n) {
    std::uint64_t low = w[1], high = w[2]; // bytes 8 .. 23 of 32
    for (int k = 1; k <= n; ++k) {
        const int s = 8 * k;
        const bool whole = k == 8;
        low |= whole ? w[0] | w[2] : w[1] << s | w[0] >> (64 - s) | w[1] >> s | w[2] << (64 - s);
        high |= whole ? w[1] | w[3] : w[2] << s | w[1] >> (64 - s) | w[2] >> s | w[3] << (64 - s);
    }
    const auto halve = [](std::uint64_t b) {
        b = (b | b >> 8) & 0x00ff00ff00ff00ffull;
        b = (b | b >> 8) & 0x0000ffff0000ffffull;
        return (b | b >> 16) & 0x00000000ffffffffull;
    };
    return halve(low) | halve(high) << 32;
}

// Along z: the bits of each byte of four words in a row.
std::uint64_t alongZ(const std::array<std::uint64_t, 4>& w, int n) {
    std::uint64_t result = 0;
    for (int y = 0; y < 8; ++y) {
        const int s = 8 * y;
        std::uint32_t row = static_cast<std::uint32_t>((w[0] >> s & 0xff) | (w[1] >> s & 0xff) << 8 | (w[2] >> s & 0xff) << 16 | (w[3] >> s & 0xff) << 24);
        if (row == 0) continue;
        for (int done = 0; done < n;) { // what has grown by k can grow by 2 k + 1 at once
            const int step = std::min(n - done, 2 * done + 1);
            row |= row << step | row >> step;
            done += step;
        }
        std::uint32_t b = (row | row >> 1) >> 8 & 0x5555u;
        b = (b | b >> 1) & 0x3333u;
        b = (b | b >> 2) & 0x0f0fu;
        result |= static_cast<std::uint64_t>((b | b >> 4) & 0xffu) << s;
    }
    return result;
}

// The parents in one leaf of the result, at (x, y, z) of its node: separable, one axis after the other.
LeafBits parentsInLeaf(const FineLeaves& fine, int x, int y, int z, int n) {
    std::array<std::array<LeafBits, 4>, 4> columns{}; // after x: by y and z of the fine leaf
    for (int j = 0; j < 4; ++j) {
        for (int k = 0; k < 4; ++k) {
            std::array<std::uint64_t, 32> words{};
            bool some = false;
            for (int i = 0; i < 4; ++i) {
                if (!fine.has(2 * x + i, 2 * y + j, 2 * z + k)) continue;
                some = true;
                const LeafBits b = fine.bits(2 * x + i, 2 * y + j, 2 * z + k);
                std::copy(b.begin(), b.end(), words.begin() + 8 * i);
            }
            if (some) alongX(words, n, columns[std::size_t(j)][std::size_t(k)]);
        }
    }
    LeafBits result{};
    for (std::size_t i = 0; i < 8; ++i) {
        std::array<std::uint64_t, 4> rows{};
        for (std::size_t k = 0; k < 4; ++k) rows[k] = alongY({columns[0][k][i], columns[1][k][i], columns[2][k][i], columns[3][k][i]}, n);
        result[i] = alongZ(rows, n);
    }
    return result;
}

bool allFull(const FineLeaves& fine, int x, int y, int z) {
    for (int i = 0; i < 8; ++i) {
        const int a = 2 * x + 1 + (i >> 2), b = 2 * y + 1 + (i >> 1 & 1), c = 2 * z + 1 + (i & 1);
        if (!fine.has(a, b, c) || fine.bits(a, b, c) != full) return false;
    }
    return true;
}

bool noneAround(const FineLeaves& fine, int x, int y, int z) {
    for (int i = 0; i < 4; ++i) {
        for (int j = 0; j < 4; ++j) {
            for (int k = 0; k < 4; ++k) {
                if (fine.has(2 * x + i, 2 * y + j, 2 * z + k)) return false;
            }
        }
    }
    return true;
}

std::unique_ptr<MaskNode> parentsInNode(const FineLeaves& fine, const Coord& origin, int n, const Index3& size) {
    NodeBuilder out(origin);
    for (int i = 0; i < 4096; ++i) {
        const int x = i >> 8, y = i >> 4 & 15, z = i & 15;
        if (noneAround(fine, x, y, z)) continue;
        const Coord o = origin.offsetBy(8 * x, 8 * y, 8 * z);
        LeafBits b = allFull(fine, x, y, z) ? full : parentsInLeaf(fine, x, y, z, n);
        for (int axis = 0; axis < 3; ++axis) bits::clip(b, axis, std::max(0, size[static_cast<std::size_t>(axis)] - o[axis]));
        out.add(o, b);
    }
    return out.take();
}

// Nodes of the coarser level that lie within n cells of a node of the finer.
void addParents(std::vector<Coord>& origins, const Mask& fine, int n, const Index3& size) {
    for (const MaskNode* node : nodesOf(fine)) {
        const Coord lo = node->origin().offsetBy(-n), hi = node->origin().offsetBy(nodeEdge - 1 + n);
        for (int i = 0; i < 8; ++i) {
            const Coord at = nodeOrigin({(i & 4 ? hi.x() : lo.x()) >> 1, (i & 2 ? hi.y() : lo.y()) >> 1, (i & 1 ? hi.z() : lo.z()) >> 1});
            if (at.x() >= 0 && at.y() >= 0 && at.z() >= 0 && at.x() < size[0] && at.y() < size[1] && at.z() < size[2]) origins.push_back(at);
        }
    }
}

} // namespace

Mask::Ptr parentsAround(const Mask& a, const Mask& b, int n, const Index3& size) {
    std::vector<Coord> origins;
    addParents(origins, a, n, size);
    addParents(origins, b, n, size);
    sortUnique(origins);
    return treeOfNodes(origins.size(), [&](std::size_t i) -> std::unique_ptr<MaskNode> {
        thread_local FineLeaves fine;
        if (!fine.gather(a, b, origins[i])) return nullptr;
        return parentsInNode(fine, origins[i], n, size);
    });
}

Mask::Ptr childrenLess(const Mask& split, const Mask& again) {
    const std::vector<const MaskNode*> nodes = nodesOf(split);
    return treeOfNodes(8 * nodes.size(), [&](std::size_t task) {
        const MaskNode& coarse = *nodes[task / 8];
        const int ox = task & 4 ? 8 : 0, oy = task & 2 ? 8 : 0, oz = task & 1 ? 8 : 0; // the octant, in leaves
        const Coord& c = coarse.origin();
        const Coord origin(2 * (c.x() + 8 * ox), 2 * (c.y() + 8 * oy), 2 * (c.z() + 8 * oz));
        const MaskNode* less = MaskReader(again).probeConstNode<MaskNode>(origin);
        NodeBuilder out(origin);
        for (int i = 0; i < 4096; ++i) {
            const int x = i >> 8, y = i >> 4 & 15, z = i & 15;
            const MaskLeaf* parent = leafAt(&coarse, static_cast<Index>((ox + x / 2) << 8 | (oy + y / 2) << 4 | (oz + z / 2)));
            if (!parent) continue;
            LeafBits b = bits::prolong(leafBits(parent), x & 1, y & 1, z & 1);
            const LeafBits minus = leafBits(leafAt(less, static_cast<Index>(i)));
            for (std::size_t n = 0; n < 8; ++n) b[n] &= ~minus[n];
            out.add(origin.offsetBy(8 * x, 8 * y, 8 * z), b);
        }
        return out.take();
    });
}

Mask::Ptr boxLess(const Index3& size, const Mask& again) {
    std::vector<Coord> origins;
    for (std::int32_t x = 0; x < size[0]; x += nodeEdge) {
        for (std::int32_t y = 0; y < size[1]; y += nodeEdge) {
            for (std::int32_t z = 0; z < size[2]; z += nodeEdge) origins.emplace_back(x, y, z);
        }
    }
    return treeOfNodes(origins.size(), [&](std::size_t task) {
        const Coord& origin = origins[task];
        const MaskNode* less = MaskReader(again).probeConstNode<MaskNode>(origin);
        NodeBuilder out(origin);
        for (int i = 0; i < 4096; ++i) {
            const Coord o = origin.offsetBy(8 * (i >> 8), 8 * (i >> 4 & 15), 8 * (i & 15));
            if (o.x() >= size[0] || o.y() >= size[1] || o.z() >= size[2]) continue;
            LeafBits b = full;
            for (int axis = 0; axis < 3; ++axis) bits::clip(b, axis, size[static_cast<std::size_t>(axis)] - o[axis]);
            const LeafBits minus = leafBits(leafAt(less, static_cast<Index>(i)));
            for (std::size_t n = 0; n < 8; ++n) b[n] &= ~minus[n];
            out.add(o, b);
        }
        return out.take();
    });
}

} // namespace i2b
