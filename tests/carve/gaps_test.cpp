// Proves: a gap of about a cell between walls askew to the lattice is filled from end to end, where passages alone fill some
// of it; a front is shaped there without taking cells that have room; a lone wall, a crack and a crack into another region
// change nothing; between two sheets in the open flow, too, the mesh runs through, at whatever slope.
#include "carve/kept_checks.h"
#include "i2b/carve/carve.h"
#include "i2b/carve/extrudable.h"
#include "i2b/carve/flow_lookup.h"
#include "i2b/carve/gaps.h"
#include "i2b/carve/passages.h"
#include "i2b/grid/mask_ops.h"
#include <gtest/gtest.h>
#include <algorithm>
#include <cmath>

namespace i2b::test {
namespace {

constexpr double h = 0.1;

void addQuad(Surface& soup, const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    const auto n = static_cast<std::uint32_t>(soup.points.size());
    soup.points.insert(soup.points.end(), {a, b, c, d});
    soup.triangles.insert(soup.triangles.end(), {{n, n + 1, n + 2}, {n, n + 2, n + 3}});
    soup.partOf.insert(soup.partOf.end(), {0, 0});
}

// A block about the origin, turned about y; lo and hi in its own axes.
void addBlock(Surface& soup, const Box& b, double angle) {
    const double c = std::cos(angle), s = std::sin(angle);
    const auto at = [&](int i) {
        const Vec3 p{i & 1 ? b.hi.x : b.lo.x, i & 2 ? b.hi.y : b.lo.y, i & 4 ? b.hi.z : b.lo.z};
        return Vec3{c * p.x + s * p.z, p.y, c * p.z - s * p.x};
    };
    for (const auto& q : {std::array{0, 1, 3, 2}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 3, 7, 5}})
        addQuad(soup, at(q[0]), at(q[1]), at(q[2]), at(q[3]));
}

RandomCase blocks(std::initializer_list<Box> boxes, double angle) {
    RandomCase c = randomCase(0);
    c.soup = Surface{};
    c.soup.parts = {{"blocks", "", 0}};
    for (const Box& b : boxes) addBlock(c.soup, b, angle);
    c.soup.parts[0].triangles = static_cast<std::uint32_t>(c.soup.triangles.size());
    c.options.size = {};
    c.options.size.surface = c.options.size.max = h;
    c.options.domain.flow = Flow::external;
    c.options.domain.box = Box{{-2, -2, -2}, {2, 2, 2}};
    return c;
}

// The cells of a painted region, with those that passages and then gaps give back.
struct Filled {
    explicit Filled(const RandomCase& c) : painted(c), region(paintedOf(painted.regions)), kept(painted.regions.cellsOf(region.id)) {
        for (std::size_t l = 0; l < painted.grid.levels.size(); ++l) taken.push_back(std::make_shared<Mask>(false));
        const Room room(painted.grid, painted.cut, painted.regions, region, kept, taken, *painted.index);
        inPassages = passageCells(room);
        give(inPassages);
        facesBefore = facesIntoGaps(room);
        const GapFilling filling = fillGaps(room);
        for (const Place& c : filling.displaced) kept[std::size_t(c.level)]->setValueOff(toCoord(c.at));
        inGaps = filling.given;
        give(inGaps);
        facesAfter = facesIntoGaps(room);
    }
    static const Region& paintedOf(const Regions& regions) {
        for (const Region& r : regions.table) {
            if (r.painted) return r;
        }
        throw std::logic_error("nothing is painted");
    }
    void give(const std::vector<Place>& cells) {
        for (const Place& c : cells) kept[std::size_t(c.level)]->setValueOn(toCoord(c.at));
    }
    // Faces of kept cells behind which the room goes on, with walls on both sides and no kept cell over it.
    int facesIntoGaps(const Room& room) const {
        int faces = 0;
        for (const Place& c : besideKept(room)) {
            const WallsAround walls = room.wallsAround(c);
            if (!walls.isOpposite || room.isKeptAt(c, walls.toWall * -GapOptions().across)) continue;
            for (int d = 0; d < 6; ++d) {
                const double ahead = walls.toWall[d >> 1] * (d & 1 ? -1 : 1);
                const Place n = faceNeighbour(c, d);
                faces += room.isKept(n) && ahead < GapOptions().ahead && !room.isWallBetween(c, n);
            }
        }
        return faces;
    }

    Painted painted;
    const Region& region;
    std::vector<Mask::Ptr> kept, taken;
    std::vector<Place> inPassages, inGaps;
    int facesBefore = 0, facesAfter = 0;
};

// Two blocks a cell apart, at angles at which the middle of the gap runs in and out of the middles of cells.
TEST(Gaps, AreFilledWherePassagesFillSome) {
    int before = 0, after = 0;
    for (const double angle : {0.1, 0.2, 0.35}) {
        for (const double width : {0.8 * h, 1.0 * h, 1.2 * h}) {
            const Filled f(blocks({{{-0.9, -0.7, -0.5}, {0.9, 0.7, -width / 2}}, {{-0.9, -0.7, width / 2}, {0.9, 0.7, 0.5}}}, angle));
            EXPECT_LE(f.facesAfter, f.facesBefore) << angle << " " << width;
            before += f.facesBefore;
            after += f.facesAfter;
            for (const Place& c : f.inGaps) {
                const Room room(f.painted.grid, f.painted.cut, f.painted.regions, f.region, f.kept, f.taken, *f.painted.index);
                EXPECT_GE(room.wallsAround(c).width, GapOptions().width);
                EXPECT_GE(room.wallsAround(c).clearance, RoomOptions().least);
                for (int d = 0; d < 6; ++d) EXPECT_FALSE(room.isKept(faceNeighbour(c, d)) && room.isWallBetween(c, faceNeighbour(c, d)));
            }
        }
    }
    EXPECT_LE(after, before / 10);
}

// Of places amid two parallel sheets, a share that the flow comes to; 3 h and more from their rims.
double reachedBetweenSheets(double slope, double width, double shift) {
    RandomCase c = blocks({}, 0);
    const double cosine = std::cos(slope), sine = std::sin(slope);
    const auto at = [&](double x, double y, double z) { return Vec3{cosine * x + sine * z, y, cosine * z - sine * x}; };
    for (const double z : {shift - width / 2, shift + width / 2}) addQuad(c.soup, at(-1.1, -1, z), at(1.1, -1, z), at(1.1, 1, z), at(-1.1, 1, z));
    c.soup.parts[0].triangles = 4;
    const Painted painted(c);
    const KeptCells kept = carve(painted.grid, painted.cut, painted.regions, *painted.index, c.options.fit);
    const FlowLookup flow(painted.grid, kept, *painted.index);
    int places = 0, reached = 0;
    for (double x = -0.8; x < 0.8; x += 0.031) {
        for (double y = -0.7; y < 0.7; y += 0.037) ++places, reached += flow.reaches(at(x, y, shift));
    }
    return double(reached) / places;
}

TEST(Gaps, BetweenSheetsInTheOpenAreRunThrough) {
    for (const double slope : {0.05, 0.1, 0.2, 0.3, 0.4, 0.46, 0.6, 0.7, 0.785}) {
        for (const double width : {1.6 * h, 1.8 * h, 2 * h, 2.2 * h}) {
            for (const double shift : {0.0, 0.21 * h, 0.43 * h}) {
                const double reached = reachedBetweenSheets(slope, width, shift);
                EXPECT_GT(reached, 0.9) << slope << " " << width / h << " " << shift / h;
            }
        }
    }
}

// How many cells with the room that others are given for does a front cost that prisms can be extruded from?
int roomyCellsTaken(const Filled& f, const RoomOptions& options) {
    std::vector<Mask::Ptr> kept;
    for (const Mask::Ptr& mask : f.kept) kept.push_back(std::make_shared<Mask>(*mask));
    const Room room(f.painted.grid, f.painted.cut, f.painted.regions, f.region, kept, f.taken, *f.painted.index, options);
    makeExtrudable(kept, f.painted.grid, *f.painted.index, &room);
    int taken = 0;
    for (std::size_t l = 0; l < kept.size(); ++l) {
        for (const Place& c : placesOf({differenceOf(*f.kept[l], *kept[l])})) taken += room.wallsAround({static_cast<std::int32_t>(l), c.at}).clearance >= options.rim;
    }
    return taken;
}

// Cells with little room come in, tucked away between walls, where others would have to go.
TEST(Gaps, FrontsInThemKeepCellsThatHaveRoom) {
    RoomOptions roomy;
    roomy.squeezed = roomy.rim;
    int with = 0, without = 0;
    for (const double angle : {0.1, 0.2, 0.35, 0.5}) {
        for (const double width : {1.2 * h, 1.3 * h, 1.5 * h, 1.6 * h}) {
            const Filled f(blocks({{{-0.9, -0.7, -0.5}, {0.9, 0.7, -width / 2}}, {{-0.9, -0.7, width / 2}, {0.9, 0.2, 0.5}}, {{-0.5, 0.3, width / 2}, {0.8, 0.7, 0.5}}}, angle));
            with += roomyCellsTaken(f, {});
            without += roomyCellsTaken(f, roomy);
        }
    }
    EXPECT_GT(without, 20);
    EXPECT_LT(with, 0.8 * without);
}

TEST(Gaps, OfALoneBlockThereAreNone) {
    for (const double angle : {0.0, 0.1, 0.5}) EXPECT_TRUE(Filled(blocks({{{-0.53, -0.51, -0.52}, {0.55, 0.57, 0.54}}}, angle)).inGaps.empty()) << angle;
}

// A crack into a hollow box is no way in, at whatever place of the lattice.
TEST(Gaps, CracksIntoOtherRegionsStayClosed) {
    for (const double crack : {0.1 * h, 0.2 * h, 0.3 * h}) {
        for (const double shift : {0.0, 0.25 * h, 0.5 * h}) {
            RandomCase c = blocks({{{-0.6, -0.6, -0.6}, {0.6, 0.6, 0.6}}}, 0.0);
            c.soup.triangles.erase(c.soup.triangles.begin() + 2, c.soup.triangles.begin() + 4); // the top
            c.soup.partOf.resize(c.soup.triangles.size());
            addQuad(c.soup, {-0.6, -0.6, 0.6}, {shift - crack / 2, -0.6, 0.6}, {shift - crack / 2, 0.6, 0.6}, {-0.6, 0.6, 0.6});
            addQuad(c.soup, {shift + crack / 2, -0.6, 0.6}, {0.6, -0.6, 0.6}, {0.6, 0.6, 0.6}, {shift + crack / 2, 0.6, 0.6});
            const Filled f(c);
            for (const Place& cell : f.inGaps) {
                const Box box = f.painted.grid.lattice.cellBox(f.painted.grid.levels[std::size_t(cell.level)].level, cell.at);
                const Vec3 at = box.centre();
                EXPECT_GT(std::max({std::abs(at.x), std::abs(at.y), std::abs(at.z)}), 0.55) << crack << " " << shift;
            }
        }
    }
}

} // namespace
} // namespace i2b::test
