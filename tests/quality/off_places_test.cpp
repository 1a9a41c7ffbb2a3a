// listOffPlaces on a flat wall whose nodes are off as the test says: every figure can be counted by hand.
#include "i2b/quality/off_places.h"
#include <gtest/gtest.h>

namespace i2b {
namespace {

constexpr std::int32_t n = 10; // faces along each side

// A wall of n x n unit squares in the plane z = 0.
PolyMesh flatWall() {
    PolyMesh m;
    m.cells = 1;
    m.faceOffsets.push_back(0);
    for (std::int32_t j = 0; j <= n; ++j)
        for (std::int32_t i = 0; i <= n; ++i) m.points.push_back({double(i), double(j), 0});
    for (std::int32_t j = 0; j < n; ++j)
        for (std::int32_t i = 0; i < n; ++i) {
            const std::int32_t k = j * (n + 1) + i;
            for (const std::int32_t v : {k, k + 1, k + n + 2, k + n + 1}) m.faceVertices.push_back(v);
            m.faceOffsets.push_back(static_cast<std::uint32_t>(m.faceVertices.size()));
            m.owner.push_back(0);
        }
    m.patches = {{"body", "wall", 0, n * n}};
    return m;
}

// Below it: part "left" for x < 5, "right" beyond.
Surface twoParts() {
    Surface s;
    s.parts = {{"left", "", 1}, {"right", "", 1}};
    s.points = {{-20, -20, -1}, {4.9, 5, -1}, {-20, 30, -1}, {30, -20, -1}, {5.1, 5, -1}, {30, 30, -1}};
    s.triangles = {{0, 1, 2}, {3, 4, 5}};
    s.partOf = {0, 1};
    return s;
}

struct Fixture {
    PolyMesh mesh = flatWall();
    Surface surface = twoParts();
    SurfaceIndex index{surface};
    WallNodes nodes;
    std::vector<OffCause> fit;
    std::vector<std::uint8_t> retreated;
    Fixture() {
        for (std::size_t i = 0; i < mesh.points.size(); ++i) nodes.points.push_back(static_cast<std::int32_t>(i));
        nodes.distanceInH.assign(nodes.points.size(), 0);
        nodes.tilted.assign(nodes.points.size(), 0);
        fit.assign(nodes.points.size(), OffCause::none);
        retreated.assign(nodes.points.size(), 0);
    }
    static std::size_t at(std::size_t i, std::size_t j) { return j * (n + 1) + i; }
    void set(std::size_t i, std::size_t j, double distance, OffCause cause) {
        nodes.distanceInH[at(i, j)] = distance;
        fit[at(i, j)] = cause;
    }
    OffGeometry list(std::size_t most = 100) const { return listOffPlaces(mesh, nodes, settleCauses(nodes, fit, retreated), index, most); }
};

TEST(OffPlaces, NothingOff) {
    Fixture f;
    f.nodes.distanceInH.assign(f.nodes.points.size(), 0.01); // just on it
    f.fit.assign(f.nodes.points.size(), OffCause::quality);  // it looked, for nothing
    const OffGeometry off = f.list();
    EXPECT_EQ(off.nodes, 0);
    EXPECT_EQ(off.fraction, 0);
    EXPECT_EQ(off.places.total, 0);
    EXPECT_TRUE(off.places.first.empty());
}

// Nodes join over edges, not over diagonals; the larger place first, the farther of two as large.
TEST(OffPlaces, PlacesAreConnectedOverEdges) {
    Fixture f;
    for (std::size_t i = 1; i <= 3; ++i) f.set(i, 1, 0.1 * double(i), OffCause::gap); // three in a row
    f.set(4, 2, 0.9, OffCause::quality);                                              // diagonal to the last
    f.set(8, 8, 0.5, OffCause::feature);
    f.set(9, 8, 0.4, OffCause::besideEdge), f.set(9, 9, 0.3, OffCause::besideEdge);
    const OffGeometry off = f.list();
    EXPECT_EQ(off.nodes, 7);
    EXPECT_DOUBLE_EQ(off.fraction, 7.0 / ((n + 1) * (n + 1)));
    EXPECT_EQ(off.counts[static_cast<std::size_t>(OffCause::gap)], 3);
    EXPECT_EQ(off.counts[static_cast<std::size_t>(OffCause::besideEdge)], 2);
    EXPECT_EQ(off.places.total, 3);
    ASSERT_EQ(off.places.first.size(), 3u);
    const OffPlace& corner = off.places.first[0];
    EXPECT_EQ(corner.nodes, 3);
    EXPECT_EQ(corner.farthestInH, 0.5);
    EXPECT_EQ(corner.farthest, (Vec3{8, 8, 0}));
    EXPECT_EQ(corner.cause, OffCause::besideEdge);
    EXPECT_EQ(corner.part, "right");
    const OffPlace& row = off.places.first[1];
    EXPECT_EQ(row.nodes, 3);
    EXPECT_EQ(row.cause, OffCause::gap);
    EXPECT_EQ(row.part, "left");
    EXPECT_EQ(row.centre, (Vec3{2, 1, 0}));
    EXPECT_EQ(row.box, (Box{{1, 1, 0}, {3, 1, 0}}));
    EXPECT_EQ(off.places.first[2].nodes, 1);
    EXPECT_EQ(off.places.first[2].farthestInH, 0.9);
}

// What the fit found comes first, then the retreat; a node of neither was left unfinished.
TEST(OffPlaces, CausesAreSettledAfterRepair) {
    Fixture f;
    f.set(1, 1, 0.2, OffCause::gap), f.retreated[Fixture::at(1, 1)] = 1;
    f.set(3, 3, 0.2, OffCause::none), f.retreated[Fixture::at(3, 3)] = 1;
    f.set(5, 5, 0.2, OffCause::none);
    f.retreated[Fixture::at(7, 7)] = 1; // but is on the geometry
    const std::vector<OffCause> causes = settleCauses(f.nodes, f.fit, f.retreated);
    EXPECT_EQ(causes[Fixture::at(1, 1)], OffCause::gap);
    EXPECT_EQ(causes[Fixture::at(3, 3)], OffCause::retreated);
    EXPECT_EQ(causes[Fixture::at(5, 5)], OffCause::unfinished);
    EXPECT_EQ(causes[Fixture::at(7, 7)], OffCause::none);
    // Without a repair or a fit to ask there is still an answer.
    EXPECT_EQ(settleCauses(f.nodes, {}, {})[Fixture::at(1, 1)], OffCause::unfinished);
}

// Nodes at tilted faces are listed apart and do not join places that are off.
TEST(OffPlaces, TiltedFacesAreListedApart) {
    Fixture f;
    f.set(2, 2, 0.2, OffCause::quality), f.set(5, 2, 0.3, OffCause::quality);
    for (std::size_t i = 2; i <= 5; ++i) f.nodes.tilted[Fixture::at(i, 2)] = 1; // a bridge between the two
    const OffGeometry off = f.list();
    EXPECT_EQ(off.nodes, 2);
    EXPECT_EQ(off.tilted, 2);
    EXPECT_EQ(off.places.total, 2);
    EXPECT_EQ(off.tiltedPlaces.total, 1);
    ASSERT_EQ(off.tiltedPlaces.first.size(), 1u);
    EXPECT_EQ(off.tiltedPlaces.first[0].nodes, 2);
    EXPECT_EQ(off.tiltedPlaces.first[0].cause, OffCause::tilted);
}

// A long list is cut, and says how long it was.
TEST(OffPlaces, OnlyTheFirstAreListed) {
    Fixture f;
    for (std::size_t j = 0; j <= n; j += 2)
        for (std::size_t i = 0; i <= n; i += 2) f.set(i, j, 0.02 + 0.001 * double(Fixture::at(i, j)), OffCause::quality);
    const OffGeometry off = f.list(5);
    EXPECT_EQ(off.places.total, 36);
    ASSERT_EQ(off.places.first.size(), 5u);
    EXPECT_EQ(off.places.first[0].farthest, (Vec3{10, 10, 0}));
    for (std::size_t i = 1; i < 5; ++i) EXPECT_GT(off.places.first[i - 1].farthestInH, off.places.first[i].farthestInH);
}

} // namespace
} // namespace i2b
