// Proves: no step of the fit inverts a corner; the energy falls, ends where its gradient is nought and its
// gradient is the one that finite differences give; the corners around nodes are those of the band's cells and
// prisms; the exact snap keeps the floor; the domain's sides stay
// planes to the last bit; the front stands off as far as layers want; nodes that are to stay do.
#include "carve/kept_checks.h"
#include "i2b/carve/carve.h"
#include "i2b/fit/wall_views.h"
#include <array>
#include <atomic>
#include <gtest/gtest.h>
#include <set>

namespace i2b::test {
namespace {

struct Setting { // a soup up to the band
    explicit Setting(unsigned seed)
        : painted(randomCase(seed)),
          kept(carve(painted.grid, painted.cut, painted.regions, *painted.index, FitOptions{})),
          lattice(painted.grid, kept), front(buildFront(lattice, startThickness)),
          band(buildBand(lattice, front, 2)), features(buildFeatureGraph(painted.soup, FeatureOptions{})),
          snaps(band.walls) {}
    Painted painted;
    KeptCells kept;
    LatticeMesh lattice;
    Front front;
    Band band;
    FeatureIndex features;
    std::vector<Snap> snaps; // none
};

// Settings of the seeds that can be meshed at all; f(setting, seed).
template <class F>
void forSettings(unsigned kind, const F& f) {
    int made = 0;
    for (unsigned seed = kind; seed < kind + 4 * caseKinds; seed += caseKinds) {
        std::unique_ptr<Setting> setting;
        try {
            setting = std::make_unique<Setting>(seed);
        } catch (const Error& e) {
            EXPECT_EQ(e.kind(), ErrorKind::input) << e.problem();
            continue;
        }
        if (setting->band.walls == 0) continue;
        ++made;
        f(*setting, seed);
    }
    EXPECT_GT(made, 0);
}

std::vector<Corner> allCorners(const Band& band) {
    std::vector<Corner> all;
    band.corners.forAll([&](const Corner& c) { all.push_back(c); });
    return all;
}

std::vector<Corner> cornersAround(const Band& band, std::size_t node) {
    std::vector<Corner> around;
    band.corners.around(node, [&](const Corner& c) { around.push_back(c); });
    return around;
}

std::size_t inverted(const Band& band, const Positions& x) {
    std::size_t n = 0;
    band.corners.forAll([&](const Corner& c) { n += !(scaledJacobian(c, x) > 0); });
    return n;
}

double energyOver(const std::vector<Corner>& corners, const Positions& x) {
    double sum = 0;
    for (const Corner& c : corners) sum += double(c.weight) * std::pow(cornerEnergy(c, x), 3);
    return sum;
}

double energyOver(const Band& band, const Positions& x) { return energyOver(allCorners(band), x); }

class Fit : public testing::TestWithParam<unsigned> {};

using Key = std::array<std::int32_t, 4>;

// Of boxes these follow from their vertices; cells that nodes hang on, and prisms, have a list of them.
TEST_P(Fit, CornersAroundTheNodesAreAllThereAre) {
    std::size_t allBoxes = 0;
    forSettings(GetParam(), [&](const Setting& s, unsigned seed) {
        std::multiset<std::pair<std::size_t, Key>> expected, found;
        std::size_t boxes = 0, notUpright = 0, ofOtherLength = 0;
        for (const CornerCell& cell : s.band.corners.cells) boxes += cell.level != CornerCell::hasCorners;
        allBoxes += boxes;
        const std::size_t listed = s.band.corners.list.size();
        EXPECT_EQ(allCorners(s.band).size(), 8 * boxes + listed) << "seed " << seed;
        for (const Corner& c : allCorners(s.band)) {
            const bool isPrisms = std::ranges::any_of(c.node, [&](std::int32_t n) { return static_cast<std::size_t>(n) < s.band.walls; });
            notUpright += !isPrisms && !(scaledJacobian(c, s.band.start) > 0.999999); // right-handed, along the axes
            for (std::size_t k = 0; k < 3 && !isPrisms; ++k) {
                const double length = norm(s.band.start[static_cast<std::size_t>(c.node[k + 1])] - s.band.start[static_cast<std::size_t>(c.node[0])]);
                ofOtherLength += std::abs(length * double(c.inverseLength[k]) - 1) > 1e-6;
            }
            for (const std::int32_t n : c.node)
                if (static_cast<std::size_t>(n) < s.band.movable) expected.emplace(n, c.node);
        }
        for (std::size_t n = 0; n < s.band.movable; ++n)
            for (const Corner& c : cornersAround(s.band, n)) found.emplace(n, c.node);
        EXPECT_EQ(found, expected) << "seed " << seed;
        EXPECT_EQ(ofOtherLength, 0u) << "seed " << seed;
        EXPECT_EQ(notUpright, 0u) << "seed " << seed;
    });
    EXPECT_GT(allBoxes, 0u);
}

// Every movable node is in one block, with those of its kind; blocks of one colour share no corner, a wall node is with its front node.
TEST_P(Fit, BlocksOfOneColourShareNoCorner) {
    forSettings(GetParam(), [](const Setting& s, unsigned seed) {
        const NodeBlocks& blocks = s.band.blocks;
        const std::array<std::size_t, 4> kindFrom{0, s.band.walls, s.band.walls + s.band.fronts, s.band.movable};
        std::vector<std::int64_t> blockOf(s.band.movable, -1), colourOf(blocks.size(), -1);
        for (std::size_t b = 0; b < blocks.size(); ++b) {
            for (const NodeBlocks::Kind kind : {NodeBlocks::wall, NodeBlocks::front, NodeBlocks::core}) {
                for (const std::int32_t n : blocks.nodes(b, kind)) {
                    const auto i = static_cast<std::size_t>(n);
                    ASSERT_TRUE(i >= kindFrom[kind] && i < kindFrom[kind + 1u]) << "seed " << seed;
                    ASSERT_EQ(blockOf[i], -1) << "seed " << seed;
                    blockOf[i] = static_cast<std::int64_t>(b);
                }
            }
        }
        EXPECT_EQ(std::count(blockOf.begin(), blockOf.end(), -1), 0) << "seed " << seed;
        for (std::size_t v = 0; v < s.band.walls; ++v) EXPECT_EQ(blockOf[v], blockOf[static_cast<std::size_t>(s.band.frontNode[v])]) << "seed " << seed;
        for (std::size_t c = 0; c < blocks.colours().size(); ++c)
            for (const std::uint32_t b : blocks.colours()[c]) colourOf[b] = static_cast<std::int64_t>(c);
        EXPECT_EQ(std::count(colourOf.begin(), colourOf.end(), -1), 0) << "seed " << seed;
        std::size_t clashes = 0;
        for (const Corner& corner : allCorners(s.band)) {
            for (const std::int32_t m : corner.node) {
                for (const std::int32_t n : corner.node) {
                    const auto i = static_cast<std::size_t>(m), j = static_cast<std::size_t>(n);
                    if (i >= s.band.movable || j >= s.band.movable || blockOf[i] == blockOf[j]) continue;
                    clashes += colourOf[static_cast<std::size_t>(blockOf[i])] == colourOf[static_cast<std::size_t>(blockOf[j])];
                }
            }
        }
        EXPECT_EQ(clashes, 0u) << "seed " << seed;
    });
}

// A block's turn comes when those of all its neighbours are done that go before it: of lower colours at the same kind, of higher ones at the
// kind before.
TEST_P(Fit, BlocksWaitForTheirNeighbours) {
    forSettings(GetParam(), [](const Setting& s, unsigned seed) {
        const NodeBlocks& blocks = s.band.blocks;
        constexpr std::array kinds{NodeBlocks::wall, NodeBlocks::front, NodeBlocks::core};
        struct Turn { std::uint32_t begin = 0, end = 0; };
        std::vector<std::array<Turn, 3>> turns(blocks.size());
        std::atomic<std::uint32_t> clock = 0;
        blocks.sweep(kinds, [&](std::size_t b, NodeBlocks::Kind kind) {
            Turn& turn = turns[b][kind];
            EXPECT_EQ(turn.begin, 0u) << "seed " << seed;
            turn.begin = ++clock;
            turn.end = ++clock;
        });
        EXPECT_EQ(clock, 6 * blocks.size()) << "seed " << seed;
        std::vector<std::size_t> blockOf(s.band.movable), colourOf(blocks.size());
        for (std::size_t b = 0; b < blocks.size(); ++b)
            for (const NodeBlocks::Kind kind : kinds)
                for (const std::int32_t n : blocks.nodes(b, kind)) blockOf[static_cast<std::size_t>(n)] = b;
        for (std::size_t c = 0; c < blocks.colours().size(); ++c)
            for (const std::uint32_t b : blocks.colours()[c]) colourOf[b] = c;
        std::size_t tooEarly = 0;
        for (const Corner& corner : allCorners(s.band)) {
            for (const std::int32_t m : corner.node) {
                for (const std::int32_t n : corner.node) {
                    const auto i = static_cast<std::size_t>(m), j = static_cast<std::size_t>(n);
                    if (i >= s.band.movable || j >= s.band.movable || colourOf[blockOf[i]] >= colourOf[blockOf[j]]) continue;
                    const std::array<Turn, 3>&first = turns[blockOf[i]], &second = turns[blockOf[j]];
                    for (std::size_t k = 0; k < 3; ++k) tooEarly += second[k].begin < first[k].end || (k > 0 && first[k].begin < second[k - 1].end);
                }
            }
        }
        EXPECT_EQ(tooEarly, 0u) << "seed " << seed;
    });
}

TEST_P(Fit, StartIsValidAndBlendStaysSo) {
    forSettings(GetParam(), [](const Setting& s, unsigned seed) {
        EXPECT_EQ(inverted(s.band, s.band.start), 0u) << "seed " << seed;
        const Positions goal = goalPositions(s.band, *s.painted.index, s.band.start, 4);
        Positions x;
        const RawVector<double> alpha = blend(s.band, s.band.start, goal, x);
        EXPECT_EQ(inverted(s.band, x), 0u) << "seed " << seed;
        for (std::size_t n = 0; n < s.band.movable; ++n) {
            ASSERT_TRUE(alpha[n] >= 0 && alpha[n] <= 1);
            ASSERT_LT(norm(x[n] - s.band.start[n] - (goal[n] - s.band.start[n]) * alpha[n]), 1e-12);
        }
        for (std::size_t n = s.band.movable; n < s.band.nodes(); ++n) ASSERT_EQ(x[n], s.band.start[n]);
        // Goals that no mesh could follow are blended just as safely.
        Positions wild = s.band.start;
        for (std::size_t n = 0; n < s.band.movable; ++n) {
            const auto i = static_cast<double>(n);
            wild[n] += Vec3{std::sin(i), std::cos(3 * i), std::sin(7 * i)} * s.band.h[n];
        }
        blend(s.band, s.band.start, wild, x);
        EXPECT_EQ(inverted(s.band, x), 0u) << "seed " << seed;
    });
}

// They hold back those around them by so much that all lie well.
TEST_P(Fit, BlendLeavesNodesThatStayAtTheStart) {
    forSettings(GetParam(), [](const Setting& s, unsigned seed) {
        const Positions goal = goalPositions(s.band, *s.painted.index, s.band.start, 4);
        Positions x;
        std::vector<std::uint8_t> stays(s.band.walls, 0);
        for (std::size_t n = 0; n < s.band.walls; n += 50) stays[n] = 1;
        const RawVector<double> alpha = blend(s.band, s.band.start, goal, x, {stays});
        EXPECT_EQ(inverted(s.band, x), 0u) << "seed " << seed;
        for (std::size_t n = 0; n < s.band.walls; ++n) {
            if (!stays[n]) continue;
            ASSERT_EQ(x[n], s.band.start[n]) << n;
            for (const BandEdge& e : s.band.edges[n]) {
                if (std::size_t(e.b) < s.band.movable) { ASSERT_LT(alpha[std::size_t(e.b)], 0.5) << n; }
            }
        }
    });
}

TEST_P(Fit, EnergyFallsAndNoCornerTurnsOver) {
    forSettings(GetParam(), [](const Setting& s, unsigned seed) {
        const std::vector<std::uint8_t> all(s.band.movable, 1);
        const Context context;
        WallViews views(s.band, *s.painted.index);
        EnergyOptions shapeOnly;
        shapeOnly.wallWeights = {0};
        Positions x = s.band.start;
        double last = energyOver(s.band, x);
        for (int sweep = 0; sweep < 3; ++sweep) {
            minimiseEnergy(views, s.features, s.snaps, all, x, shapeOnly, context);
            const double now = energyOver(s.band, x);
            EXPECT_LT(now, last) << "seed " << seed;
            last = now;
        }
        EXPECT_EQ(inverted(s.band, x), 0u) << "seed " << seed;
        const EnergyOptions whole;
        minimiseEnergy(views, s.features, s.snaps, all, x, whole, context);
        EXPECT_EQ(inverted(s.band, x), 0u) << "seed " << seed;
        // The exact snap: a node either keeps its corners above the floor, or makes its worst no worse.
        const auto worst = [&](const Positions& at) {
            double w = 1;
            s.band.corners.forAll([&](const Corner& c) { w = std::min(w, scaledJacobian(c, at)); });
            return w;
        };
        const double before = worst(x);
        snapExactly(views, s.features, s.snaps, x, whole);
        EXPECT_GT(worst(x), 0) << "seed " << seed;
        EXPECT_GE(worst(x), std::min(before, whole.floor) - 1e-12) << "seed " << seed;
    });
}

INSTANTIATE_TEST_SUITE_P(Kinds, Fit, testing::Values(1u, 2u, 5u, 7u));

// One free node, all else fixed: Newton's steps end where central differences of the public energy vanish,
// which they do not at the start; so gradient and Hessian are those of that energy.
TEST(Energy, SingleNodesEndWhereTheGradientVanishes) {
    const Setting s(1);
    ASSERT_GT(s.band.walls, 20u);
    EnergyOptions options;
    options.wallWeights.assign(30, 0);
    const Context context;
    const auto gradientAt = [&](std::size_t n, Positions x) {
        Vec3 g;
        const double step = 1e-5 * s.band.h[n];
        const std::vector<Corner> corners = cornersAround(s.band, n);
        for (int a = 0; a < 3; ++a) {
            const double at = x[n][a];
            x[n][a] = at + step;
            const double up = energyOver(corners, x);
            x[n][a] = at - step;
            g[a] = (up - energyOver(corners, x)) / (2 * step) * s.band.h[n];
            x[n][a] = at;
        }
        return norm(g);
    };
    WallViews views(s.band, *s.painted.index);
    int tried = 0, still = 0;
    for (std::size_t n = 0; n < s.band.movable && tried < 60; n += 1 + s.band.movable / 60) {
        const std::vector<Corner> corners = cornersAround(s.band, n);
        if (corners.empty() || s.band.outside[n]) continue;
        ++tried;
        std::vector<std::uint8_t> one(s.band.movable, 0);
        one[n] = 1;
        Positions x = s.band.start;
        minimiseEnergy(views, s.features, s.snaps, one, x, options, context);
        EXPECT_LE(energyOver(corners, x), energyOver(corners, s.band.start));
        for (std::size_t m = 0; m < s.band.nodes(); ++m) ASSERT_TRUE(m == n || x[m] == s.band.start[m]);
        // A way that the geometry bars may end early; few are.
        still += gradientAt(n, x) < 1e-4 * (1 + gradientAt(n, s.band.start));
    }
    EXPECT_GE(tried, 20);
    EXPECT_GE(still, tried * 9 / 10);
}

// Where layers want more room than the fit leaves by itself, the front stands farther from the wall, and the wall stays
// where it was.
TEST(FitFront, LeavesTheRoomThatLayersWant) {
    const auto meanRoom = [](const WantedRoom& wanted, std::size_t& onWall) {
        double sum = 0;
        std::size_t n = 0;
        forSettings(1, [&](Setting& s, unsigned seed) {
            const FeatureGraph graph = buildFeatureGraph(s.painted.soup, FeatureOptions{});
            fitFront(s.front, s.lattice, *s.painted.index, graph, FitOptions{}, Context(), {wanted, {}});
            EXPECT_EQ(s.front.validate(), "") << "seed " << seed;
            for (std::size_t v = 0; v < s.front.front.size(); ++v, ++n) {
                const Vec3 b = s.front.wall(v);
                sum += norm(s.front.front[v] - b) / s.front.h[v];
                onWall += s.painted.index->closest(b).distance < 0.01 * s.front.h[v];
            }
        });
        return sum / static_cast<double>(n);
    };
    std::size_t onWall = 0, onWallToo = 0;
    const double plain = meanRoom({}, onWall), high = meanRoom({0, 0.6}, onWallToo);
    EXPECT_GT(high, plain + 0.15);
    EXPECT_GT(static_cast<double>(onWallToo), 0.95 * static_cast<double>(onWall));
    std::size_t same = 0;
    EXPECT_EQ(meanRoom({1e-9, 0.01}, same), plain); // enough anyway
}

// Where the geometry runs through the domain's sides, all that lay in a side still does, exactly.
TEST(FitFront, SidesOfTheDomainStayPlanes) {
    std::size_t onSides = 0;
    forSettings(5, [&](Setting& s, unsigned seed) {
        FeatureGraph graph = buildFeatureGraph(s.painted.soup, FeatureOptions{});
        const std::vector<std::uint8_t> outside = s.front.outside;
        const RawVector<Vec3> lattice = s.lattice.latticePoints();
        const Context context;
        fitFront(s.front, s.lattice, *s.painted.index, graph, FitOptions{}, context);
        EXPECT_EQ(s.front.validate(), "") << "seed " << seed;
        const Box domain = s.lattice.lattice().domain();
        const auto keeps = [&](const Vec3& p, std::uint8_t sides) {
            for (int side = 0; side < 6; ++side) {
                if (!(sides >> side & 1)) continue;
                ++onSides;
                EXPECT_EQ(p[side / 2], side % 2 ? domain.hi[side / 2] : domain.lo[side / 2])
                    << "seed " << seed;
            }
        };
        for (std::size_t v = 0; v < outside.size(); ++v) {
            const auto& p = s.front.mesh.point(FrontMesh::VertexHandle(static_cast<int>(v)));
            keeps({p[0], p[1], p[2]}, outside[v]);
            keeps(s.front.front[v], outside[v]);
        }
        for (std::size_t i = 0; i < s.front.movedPoints.size(); ++i) {
            const Vec3& from = lattice[static_cast<std::size_t>(s.front.movedPoints[i])];
            std::uint8_t sides = 0;
            for (int side = 0; side < 6; ++side) {
                if (from[side / 2] == (side % 2 ? domain.hi[side / 2] : domain.lo[side / 2]))
                    sides = static_cast<std::uint8_t>(sides | 1 << side);
            }
            keeps(s.front.movedTo[i], sides);
        }
    });
    EXPECT_GT(onSides, 100u);
}

} // namespace
} // namespace i2b::test
