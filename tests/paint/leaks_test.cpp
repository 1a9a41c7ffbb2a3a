// Proves: openings between a place in the flow and one that it must not reach are found where they are, as wide as they are, all at
// once, however the wall lies to the lattice and whatever sizes cells have; where nothing is between two places that is said; where walls
// are tight nothing is.
#include "i2b/core/error.h"
#include "i2b/grid/build.h"
#include "i2b/grid/cut.h"
#include "i2b/paint/leaks.h"
#include "i2b/paint/paint.h"
#include <gmock/gmock.h>
#include <random>
#include <tbb/global_control.h>

namespace i2b {
namespace {

constexpr double h = 0.05;

struct Hole {
    int axis, side;        // of the room's wall that it is in
    double u, v, du, dv;   // m, its middle and half its edges, along the axes that follow
};

// A cube of 2 m about the origin, each wall a part, with rectangular holes, one a wall at most.
class Room {
  public:
    explicit Room(const std::vector<Hole>& holes) {
        for (int axis = 0; axis < 3; ++axis)
            for (int side = 0; side < 2; ++side) {
                surface_.parts.push_back({std::string(1, "xyz"[axis]) + (side ? "High" : "Low"), "", 0});
                const auto hole = std::ranges::find_if(holes, [&](const Hole& o) { return o.axis == axis && o.side == side; });
                if (hole == holes.end()) quad(axis, side, -1, -1, 1, 1);
                else around(*hole);
            }
    }
    // x, y, z: where the axes point to.
    void rotate(const Vec3& x, const Vec3& y, const Vec3& z) {
        for (Vec3& p : surface_.points) p = x * p.x + y * p.y + z * p.z;
    }
    std::vector<Leak> leaks(DomainOptions domain, bool coarseBeside = true) const {
        SizeOptions size;
        size.surface = h;
        size.max = coarseBeside ? 0.4 : h;
        size.bufferCells = 1;
        domain.box = Box{{-2, -2, -2}, {2, 2, 2}};
        const SizeField field = makeSizeField(surface_, size, domain);
        const std::vector<CellLevel> at = cutAtTargetLevels(surface_, field);
        const CellGrid grid = buildCellGrid(field, wantedCells(field, at));
        const CutCells cut = cutLeafCells(surface_, field, grid, at);
        Regions regions = labelRegions(grid, cut);
        const SurfaceIndex index(surface_);
        chooseRegions(regions, grid, index, domain);
        return findLeaks(regions, grid, index, domain);
    }

  private:
    void quad(int axis, int side, double u0, double v0, double u1, double v1) {
        const auto n = static_cast<std::uint32_t>(surface_.points.size());
        for (int i = 0; i < 4; ++i) {
            Vec3 p;
            p[axis] = side ? 1 : -1, p[(axis + 1) % 3] = i % 2 ? u1 : u0, p[(axis + 2) % 3] = i / 2 ? v1 : v0;
            surface_.points.push_back(p);
        }
        for (const std::array<std::uint32_t, 3>& t : {std::array{n, n + 1, n + 2}, std::array{n + 1, n + 3, n + 2}}) {
            surface_.triangles.push_back(t);
            surface_.partOf.push_back(2 * axis + side);
        }
    }
    void around(const Hole& o) {
        const double u0 = o.u - o.du, u1 = o.u + o.du, v0 = o.v - o.dv, v1 = o.v + o.dv;
        quad(o.axis, o.side, -1, -1, u0, 1), quad(o.axis, o.side, u1, -1, 1, 1);
        quad(o.axis, o.side, u0, -1, u1, v0), quad(o.axis, o.side, u0, v1, u1, 1);
    }

    Surface surface_;
};

DomainOptions keepOutOf(const Vec3& place) {
    DomainOptions domain;
    domain.keepOut = {{"room", place}};
    return domain;
}

TEST(Leaks, AreWhereTheHolesAre) {
    const Room room({{0, 1, 0.2, -0.3, 0.2, 0.3}, {2, 0, -0.4, 0.1, 0.15, 0.12}});
    for (const bool coarse : {true, false}) {
        const std::vector<Leak> leaks = room.leaks(keepOutOf({0.3, -0.4, 0.2}), coarse);
        ASSERT_EQ(leaks.size(), 2u);
        EXPECT_NEAR(leaks[0].place.x, 1, h);
        EXPECT_NEAR(leaks[0].place.y, 0.2, h / 8);
        EXPECT_NEAR(leaks[0].width, 0.4, h / 4);
        EXPECT_NEAR(leaks[0].area, 0.4 * 0.6, 0.4 * 0.6 - (0.4 - 2 * h) * (0.6 - 2 * h));
        EXPECT_THAT(leaks[0].text, testing::AllOf(testing::HasSubstr("the flow"), testing::HasSubstr("'room'"), testing::HasSubstr("xHigh")));
        EXPECT_NEAR(leaks[1].place.z, -1, h);
        EXPECT_NEAR(leaks[1].place.y, 0.1, h / 8);
        EXPECT_NEAR(leaks[1].width, 0.24, h / 4);
        EXPECT_THAT(leaks[1].text, testing::HasSubstr("zLow"));
        for (const Leak& leak : leaks) {
            Vec3 area; // of its faces
            for (const auto& [a, b, c, d] : leak.faces) area += cross(c - a, d - b) * 0.5;
            EXPECT_NEAR(norm(area), leak.area, 1e-12);
            EXPECT_GT(dot(area, leak.beyond - leak.place), 0); // towards the room
            EXPECT_TRUE(leak.keepOut);
            EXPECT_LT(norm(leak.beyond), 0.5); // the middle of the room
        }
    }
}

TEST(Leaks, TightWallsHaveNone) {
    EXPECT_TRUE(Room({}).leaks(keepOutOf({0, 0, 0})).empty());
    EXPECT_TRUE(Room({{1, 0, 0, 0, 0.2, 0.4 * h}}).leaks(keepOutOf({0, 0, 0})).empty()); // narrower than a cell
}

TEST(Leaks, SeedsOfTwoNamesHaveThoseBetweenThem) {
    const Room room({{1, 0, 0.1, 0.1, 0.2, 0.2}});
    DomainOptions domain;
    domain.seeds = {{"air", {-1.5, 1.2, 0}}, {"room", {0, 0, 0}}, {"air", {1.5, 1.5, 1.5}}};
    const std::vector<Leak> leaks = room.leaks(domain);
    ASSERT_EQ(leaks.size(), 1u);
    EXPECT_FALSE(leaks[0].keepOut);
    EXPECT_THAT(leaks[0].text, testing::AllOf(testing::HasSubstr("'air'"), testing::HasSubstr("'room'"), testing::HasSubstr("yLow")));
    domain.seeds[1].name = "air";
    EXPECT_TRUE(room.leaks(domain).empty());
}

// Each pair of places has its own openings, though they are the same ones.
TEST(Leaks, ArePerPairOfPlaces) {
    DomainOptions domain = keepOutOf({0, 0, 0});
    domain.keepOut.push_back({"", {0.5, 0.5, 0.5}});
    const std::vector<Leak> leaks = Room({{1, 0, 0.1, 0.1, 0.2, 0.2}, {0, 1, 0, 0, 0.1, 0.3}}).leaks(domain);
    ASSERT_EQ(leaks.size(), 4u);
    EXPECT_EQ(leaks[0].pair, leaks[1].pair);
    EXPECT_NE(leaks[1].pair, leaks[2].pair);
    EXPECT_EQ(leaks[0].place, leaks[2].place);
    EXPECT_GT(leaks[0].width, leaks[1].width);
}

TEST(Leaks, BetweenTwoPlacesInTheOpenIsNoOpening) {
    const std::vector<Leak> leaks = Room({}).leaks(keepOutOf({1.6, 1.6, 1.6}));
    ASSERT_EQ(leaks.size(), 1u);
    EXPECT_EQ(leaks[0].area, 0);
    EXPECT_THAT(leaks[0].text, testing::HasSubstr("nothing narrow"));
}

// A place beside a wall is as good as one in the middle, but one in the wall is on no side of it.
TEST(Leaks, PlacesBesideWallsWillDo) {
    const Room room({{1, 0, 0.1, 0.1, 0.2, 0.2}});
    EXPECT_EQ(room.leaks(keepOutOf({1 - 0.2 * h, 0, 0})).size(), 1u);
    EXPECT_EQ(room.leaks(keepOutOf({1 + 0.2 * h, 0, 0}))[0].area, 0); // outside: in the open
    EXPECT_THROW(room.leaks(keepOutOf({1, 0, 0})), Error);
    EXPECT_THROW(Room({}).leaks(keepOutOf({3, 0, 0})), Error);
}

class RandomLeaks : public testing::TestWithParam<int> {};

// However the room lies, its holes are found at their places, the widest first.
TEST_P(RandomLeaks, AreFoundHoweverTheWallLies) {
    std::mt19937_64 engine(static_cast<unsigned>(GetParam()));
    const auto uniform = [&](double lo, double hi) { return std::uniform_real_distribution<double>(lo, hi)(engine); };
    const auto direction = [&] { return normalized(Vec3{uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)}); };
    for (int round = 0; round < 3; ++round) {
        std::vector<Hole> holes;
        for (int axis = 0; axis < 3; ++axis) {
            const double width = uniform(3 * h, 0.3);
            if (uniform(0, 1) < 0.7) holes.push_back({axis, uniform(0, 1) < 0.5, uniform(-0.4, 0.4), uniform(-0.4, 0.4), width / 2, uniform(width, 0.9) / 2});
        }
        Room room(holes);
        const Vec3 x = direction(), z = normalized(cross(x, direction())), y = cross(z, x);
        room.rotate(x, y, z);
        std::vector<Leak> leaks;
        for (const int threads : {1, 8}) {
            const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
            const std::vector<Leak> again = room.leaks(keepOutOf({0, 0, 0}));
            if (threads == 1) leaks = again;
            ASSERT_EQ(again.size(), leaks.size());
            for (std::size_t i = 0; i < leaks.size(); ++i) EXPECT_TRUE(again[i].place == leaks[i].place && again[i].width == leaks[i].width && again[i].area == leaks[i].area);
        }
        ASSERT_EQ(leaks.size(), holes.size()) << round;
        std::ranges::sort(holes, std::greater{}, &Hole::du);
        for (std::size_t i = 0; i < leaks.size(); ++i) {
            EXPECT_NEAR(leaks[i].width, 2 * holes[i].du, h / 2) << round;
            EXPECT_GT(leaks[i].area, 0) << round;
            EXPECT_LT(leaks[i].area, 4.2 * holes[i].du * holes[i].dv) << round;
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Random, RandomLeaks, testing::Range(1, 7));

} // namespace
} // namespace i2b
