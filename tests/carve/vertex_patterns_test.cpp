// Proves: the fans of all 256 patterns are closed sheets, told by rules of their own and not by the table's.
#include "i2b/carve/vertex_patterns.h"
#include <bit>
#include <gtest/gtest.h>
#include <vector>

namespace i2b::test {
namespace {

struct Quarter { // an exposed quarter face: between octants low and low | 1 << axis
    int axis, low, face;
    bool keptLow;
};

std::vector<Quarter> exposedFaces(int kept) {
    std::vector<Quarter> faces;
    for (int axis = 0; axis < 3; ++axis) {
        for (int o = 0; o < 8; ++o) {
            if (o >> axis & 1 || (kept >> o & 1) == (kept >> (o | 1 << axis) & 1)) continue;
            faces.push_back({axis, o, quarterFace(axis, o), (kept >> o & 1) != 0});
        }
    }
    return faces;
}

// A quarter face lies between two lattice edges: those along the other two axes, on its side.
bool touches(const Quarter& f, int edgeAxis, int edgeSide) {
    return edgeAxis != f.axis && (f.low >> edgeAxis & 1) == edgeSide;
}

// Face-connected octants of one state.
std::vector<int> components(int kept, int state) {
    std::vector<int> label(8, -1);
    for (int seed = 0; seed < 8; ++seed) {
        if ((kept >> seed & 1) != state || label[std::size_t(seed)] >= 0) continue;
        label[std::size_t(seed)] = seed;
        for (int pass = 0; pass < 8; ++pass) {
            for (int o = 0; o < 8; ++o) {
                for (int axis = 0; axis < 3; ++axis) {
                    const int n = o ^ (1 << axis);
                    if ((kept >> n & 1) == state && label[std::size_t(o)] == seed)
                        label[std::size_t(n)] = seed;
                }
            }
        }
    }
    return label;
}

TEST(VertexPatterns, QuarterFacesHaveTwelveNumbers) {
    int seen = 0;
    for (int axis = 0; axis < 3; ++axis) {
        for (int o = 0; o < 8; ++o) {
            if (!(o >> axis & 1)) seen |= 1 << quarterFace(axis, o);
        }
    }
    EXPECT_EQ(seen, 0xfff);
}

TEST(VertexPatterns, ComponentsAreFaceConnected) {
    for (int k = 0; k < 256; ++k) {
        const VertexPattern& p = vertexPattern(static_cast<std::uint8_t>(k));
        const std::vector<int> label = components(k, 1);
        for (int a = 0; a < 8; ++a) {
            EXPECT_EQ(p.component[std::size_t(a)] == noFan, (k >> a & 1) == 0);
            if (!(k >> a & 1)) continue;
            EXPECT_LT(p.component[std::size_t(a)], p.components) << k;
            for (int b = 0; b < 8; ++b) {
                if (!(k >> a & k >> b & 1)) continue;
                EXPECT_EQ(p.component[std::size_t(a)] == p.component[std::size_t(b)],
                          label[std::size_t(a)] == label[std::size_t(b)])
                    << k;
            }
        }
    }
}

// Every exposed quarter face is in one fan; a fan passes each lattice edge with two faces or none and is one
// closed cycle; all of it belongs to one kept component.
TEST(VertexPatterns, FansAreClosedCycles) {
    for (int k = 0; k < 256; ++k) {
        const VertexPattern& p = vertexPattern(static_cast<std::uint8_t>(k));
        const std::vector<Quarter> faces = exposedFaces(k);
        int exposed = 0;
        for (const Quarter& f : faces) {
            exposed |= 1 << f.face;
            ASSERT_LT(p.fan[std::size_t(f.face)], p.fans) << k;
            const int keptOctant = f.keptLow ? f.low : f.low | 1 << f.axis;
            EXPECT_EQ(p.fanComponent[p.fan[std::size_t(f.face)]], p.component[std::size_t(keptOctant)]) << k;
        }
        for (int f = 0; f < 12; ++f) EXPECT_EQ(p.fan[std::size_t(f)] == noFan, !(exposed >> f & 1)) << k;
        for (int fan = 0; fan < p.fans; ++fan) {
            std::vector<Quarter> mine;
            for (const Quarter& f : faces) {
                if (p.fan[std::size_t(f.face)] == fan) mine.push_back(f);
            }
            ASSERT_GE(mine.size(), 3u) << k;
            int reached = 1 << mine[0].face, all = 0;
            for (const Quarter& f : mine) all |= 1 << f.face;
            for (int pass = 0; pass < 12; ++pass) {
                for (int e = 0; e < 6; ++e) {
                    std::vector<int> here;
                    for (const Quarter& f : mine) {
                        if (touches(f, e / 2, e % 2)) here.push_back(f.face);
                    }
                    ASSERT_TRUE(here.empty() || here.size() == 2) << "pattern " << k << " edge " << e;
                    if (!here.empty() && (reached & (1 << here[0] | 1 << here[1])))
                        reached |= 1 << here[0] | 1 << here[1];
                }
            }
            EXPECT_EQ(reached, all) << "pattern " << k << ": a fan in two pieces";
        }
    }
}

// Where four exposed faces meet at an edge, the two that join lie on one octant: a kept one if the kept
// octants are not joined elsewhere around the vertex, else a removed one.
TEST(VertexPatterns, AlternatingEdgesComeApartByTheRule) {
    for (int k = 0; k < 256; ++k) {
        const VertexPattern& p = vertexPattern(static_cast<std::uint8_t>(k));
        const std::vector<int> label = components(k, 1);
        for (int e = 0; e < 6; ++e) {
            const int axis = e / 2, side = e % 2, b = 1 << (axis + 1) % 3, c = 1 << (axis + 2) % 3,
                      s = side << axis;
            const int pattern = (k >> s & 1) | (k >> (s | b) & 1) << 1 | (k >> (s | b | c) & 1) << 2 |
                                (k >> (s | c) & 1) << 3;
            const bool alternates = pattern == 5 || pattern == 10;
            ASSERT_EQ(p.edge[std::size_t(e)] != Alternation::none, alternates) << k;
            if (!alternates) continue;
            const int one = pattern == 5 ? s : s | b, two = pattern == 5 ? s | b | c : s | c;
            const bool apart = label[std::size_t(one)] != label[std::size_t(two)];
            EXPECT_EQ(p.edge[std::size_t(e)], apart ? Alternation::keptApart : Alternation::removedApart)
                << k;
            const int centre = apart ? one : pattern == 5 ? s | b : s;
            const auto faceTo = [&](int mask) {
                return quarterFace(mask == b ? (axis + 1) % 3 : (axis + 2) % 3, centre & ~mask);
            };
            EXPECT_EQ(p.fan[std::size_t(faceTo(b))], p.fan[std::size_t(faceTo(c))])
                << "pattern " << k << " edge " << e;
        }
    }
}

// A fan is good when one direction leaves all its faces outwards; the table's direction is one. Counted by
// the pairs of kept and removed components that share a face 232 patterns are good; sheets come apart at
// edges too here, which gives a fan for each cycle.
TEST(VertexPatterns, GoodFansHaveADirection) {
    int good = 0;
    for (int k = 0; k < 256; ++k) {
        const VertexPattern& p = vertexPattern(static_cast<std::uint8_t>(k));
        bool all = true;
        for (int fan = 0; fan < p.fans; ++fan) {
            std::array<int, 3> up{}, down{};
            for (const Quarter& f : exposedFaces(k)) {
                if (p.fan[std::size_t(f.face)] == fan) (f.keptLow ? up : down)[std::size_t(f.axis)] = 1;
            }
            const bool isGood = !(up[0] & down[0]) && !(up[1] & down[1]) && !(up[2] & down[2]);
            EXPECT_EQ(p.good[std::size_t(fan)], isGood) << k;
            for (std::size_t a = 0; a < 3; ++a)
                EXPECT_EQ(p.direction[std::size_t(fan)][a], up[a] - down[a]) << k;
            all = all && isGood;
        }
        EXPECT_EQ(p.allGood, all) << k;
        good += all;
    }
    EXPECT_EQ(good, 232);
}

// Octants outside repeat their mirror image; a mirrored fan never leans out of the domain side.
TEST(VertexPatterns, MirroringKeepsFansSquareToTheSide) {
    for (int outside = 0; outside < 64; ++outside) {
        if ((outside & 3) == 3 || (outside & 12) == 12 || (outside & 48) == 48) continue; // never both sides
        for (int k = 0; k < 256; ++k) {
            const std::uint8_t m = mirrored(static_cast<std::uint8_t>(k), outside);
            for (int o = 0; o < 8; ++o) {
                int inside = o;
                for (int e = 0; e < 6; ++e) {
                    if (outside >> e & 1 && (o >> (e / 2) & 1) == e % 2) inside ^= 1 << (e / 2);
                }
                ASSERT_EQ(m >> o & 1, k >> inside & 1) << k << " " << outside << " " << o;
            }
            const VertexPattern& p = vertexPattern(m);
            for (int fan = 0; fan < p.fans; ++fan) {
                for (int e = 0; e < 6; ++e) {
                    if (!(outside >> e & 1)) continue;
                    EXPECT_EQ(p.direction[std::size_t(fan)][std::size_t(e / 2)], 0);
                }
            }
        }
    }
    EXPECT_EQ(mirrored(0x5a, 0), 0x5a);
}

} // namespace
} // namespace i2b::test
