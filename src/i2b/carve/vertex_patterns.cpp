#include "i2b/carve/vertex_patterns.h"

namespace i2b {
namespace {

int bit(std::uint8_t kept, int o) { return kept >> o & 1; }

// Face-connected components of the octants that have the given state.
std::array<std::uint8_t, 8> componentsOf(std::uint8_t kept, int state, std::uint8_t& count) {
    std::array<std::uint8_t, 8> label;
    label.fill(noFan);
    count = 0;
    for (int seed = 0; seed < 8; ++seed) {
        if (bit(kept, seed) != state || label[std::size_t(seed)] != noFan) continue;
        std::array<int, 8> stack{seed};
        int size = 1;
        label[std::size_t(seed)] = count;
        while (size > 0) {
            const int o = stack[std::size_t(--size)];
            for (int axis = 0; axis < 3; ++axis) {
                const int n = o ^ (1 << axis);
                if (bit(kept, n) != state || label[std::size_t(n)] != noFan) continue;
                label[std::size_t(n)] = count;
                stack[std::size_t(size++)] = n;
            }
        }
        ++count;
    }
    return label;
}

// The four octants around lattice edge (axis, side) in cyclic order.
std::array<int, 4> around(int axis, int side) {
    const int b = 1 << (axis + 1) % 3, c = 1 << (axis + 2) % 3, s = side << axis;
    return {s, s | b, s | b | c, s | c};
}

int faceBetween(int a, int b) {
    const int axis = (a ^ b) == 1 ? 0 : (a ^ b) == 2 ? 1 : 2;
    return quarterFace(axis, a & b);
}

// joins[f]: the two faces that f continues into, one at each of its lattice edges.
using Joins = std::array<std::array<int, 2>, 12>;

void join(Joins& joins, int a, int b) {
    const auto put = [&](int f, int g) { (joins[std::size_t(f)][0] < 0 ? joins[std::size_t(f)][0] : joins[std::size_t(f)][1]) = g; };
    put(a, b);
    put(b, a);
}

void joinAtEdge(VertexPattern& p, std::uint8_t kept, int axis, int side, Joins& joins) {
    const std::array<int, 4> ring = around(axis, side);
    std::array<int, 4> exposed{};
    int n = 0;
    for (std::size_t i = 0; i < 4; ++i) {
        if (bit(kept, ring[i]) != bit(kept, ring[(i + 1) % 4])) exposed[std::size_t(n++)] = int(i);
    }
    const auto face = [&](std::size_t i) { return faceBetween(ring[i], ring[(i + 1) % 4]); };
    if (n == 2) join(joins, face(std::size_t(exposed[0])), face(std::size_t(exposed[1])));
    if (n != 4) return;
    const std::size_t k = bit(kept, ring[0]) ? 0 : 1; // ring[k] and ring[k + 2] are kept
    const bool apart = p.component[std::size_t(ring[k])] != p.component[std::size_t(ring[k + 2])];
    p.edge[std::size_t(2 * axis + side)] = apart ? Alternation::keptApart : Alternation::removedApart;
    const std::size_t c = apart ? k : (k + 1) % 4; // faces on both sides of octant c join
    join(joins, face((c + 3) % 4), face(c));
    join(joins, face((c + 1) % 4), face((c + 2) % 4));
}

void followFans(VertexPattern& p, std::uint8_t kept, const Joins& joins) {
    for (int axis = 0; axis < 3; ++axis) {
        for (int o = 0; o < 8; ++o) {
            if (o >> axis & 1 || bit(kept, o) == bit(kept, o | 1 << axis)) continue;
            const int start = quarterFace(axis, o);
            if (p.fan[std::size_t(start)] != noFan) continue;
            int f = start, previous = -1;
            while (p.fan[std::size_t(f)] == noFan) {
                p.fan[std::size_t(f)] = p.fans;
                const std::array<int, 2>& j = joins[std::size_t(f)];
                const int next = j[0] != previous ? j[0] : j[1];
                previous = f, f = next;
            }
            ++p.fans;
        }
    }
}

void judgeFans(VertexPattern& p, std::uint8_t kept) {
    std::array<std::array<bool, 6>, 6> has{};
    for (int axis = 0; axis < 3; ++axis) {
        for (int o = 0; o < 8; ++o) {
            if (o >> axis & 1) continue;
            const std::uint8_t f = p.fan[std::size_t(quarterFace(axis, o))];
            if (f == noFan) continue;
            const int keptOctant = bit(kept, o) ? o : o | 1 << axis;
            has[f][std::size_t(2 * axis + (keptOctant == o ? 1 : 0))] = true;
            p.fanComponent[f] = p.component[std::size_t(keptOctant)];
        }
    }
    for (std::size_t f = 0; f < p.fans; ++f) {
        p.good[f] = true;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const bool down = has[f][2 * axis], up = has[f][2 * axis + 1];
            if (down && up) p.good[f] = false;
            p.direction[f][axis] = static_cast<std::int8_t>(int(up) - int(down));
        }
        p.allGood = p.allGood && p.good[f];
    }
}

std::array<VertexPattern, 256> makeTable() {
    std::array<VertexPattern, 256> table;
    for (int k = 0; k < 256; ++k) {
        VertexPattern& p = table[std::size_t(k)];
        const auto kept = static_cast<std::uint8_t>(k);
        p.component = componentsOf(kept, 1, p.components);
        p.fan.fill(noFan);
        Joins joins;
        for (auto& j : joins) j = {-1, -1};
        for (int axis = 0; axis < 3; ++axis) {
            for (int side = 0; side < 2; ++side) joinAtEdge(p, kept, axis, side, joins);
        }
        followFans(p, kept, joins);
        judgeFans(p, kept);
    }
    return table;
}

} // namespace

const VertexPattern& vertexPattern(std::uint8_t kept) {
    static const std::array<VertexPattern, 256> table = makeTable();
    return table[kept];
}

std::uint8_t mirrored(std::uint8_t kept, int outside) {
    int k = kept;
    for (int axis = 0; axis < 3; ++axis) {
        for (int side = 0; side < 2; ++side) {
            if (!(outside >> (2 * axis + side) & 1)) continue;
            for (int o = 0; o < 8; ++o) {
                if ((o >> axis & 1) != side) continue;
                k = (k & ~(1 << o)) | (k >> (o ^ 1 << axis) & 1) << o;
            }
        }
    }
    return static_cast<std::uint8_t>(k);
}

} // namespace i2b
