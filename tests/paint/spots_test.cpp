// Proves: a place in a cut cell stands for the open cells on its own side of the wall, however near that is; it is refused, with a place to go
// to, where it sees none.
#include "i2b/core/error.h"
#include "i2b/grid/build.h"
#include "i2b/grid/cut.h"
#include "i2b/paint/paint.h"
#include "i2b/paint/spots.h"
#include <gmock/gmock.h>
#include <random>

namespace i2b {
namespace {

constexpr double h = 0.1;

// A plate across the domain, through the origin, with the normal n: two regions.
struct Plate {
    explicit Plate(const Vec3& n) {
        const Vec3 a = normalized(cross(n, std::abs(n.x) < 0.7 ? Vec3{1, 0, 0} : Vec3{0, 1, 0})), b = cross(n, a);
        surface.parts.push_back({"plate", "", 2});
        surface.points = {(a + b) * 9, (a - b) * -9, (a + b) * -9, (a - b) * 9};
        surface.triangles = {{0, 1, 2}, {0, 2, 3}};
        surface.partOf.assign(2, 0);
        SizeOptions size;
        size.surface = h, size.max = h;
        DomainOptions domain;
        domain.box = Box{{-1, -1, -1}, {1, 1, 1}};
        const SizeField field = makeSizeField(surface, size, domain);
        const std::vector<CellLevel> at = cutAtTargetLevels(surface, field);
        grid = buildCellGrid(field, wantedCells(field, at));
        regions = labelRegions(grid, cutLeafCells(surface, field, grid, at));
        index = std::make_unique<SurfaceIndex>(surface);
    }
    Spot at(const Vec3& place) const { return spotAt(regions, grid, *index, place, "seed"); }
    Surface surface;
    CellGrid grid;
    Regions regions;
    std::unique_ptr<SurfaceIndex> index;
};

TEST(Spots, StayOnTheirSideOfTheWall) {
    std::mt19937 engine(1);
    std::uniform_real_distribution<double> uniform(-1, 1);
    for (int round = 0; round < 20; ++round) {
        const Vec3 n = normalized(Vec3{uniform(engine), uniform(engine), uniform(engine)});
        const Plate plate(n);
        const std::int32_t above = plate.at(n * 0.5).region, below = plate.at(n * -0.5).region;
        ASSERT_NE(above, below);
        for (const double far : {0.3, 0.1, 1e-3, 1e-9}) {
            const Vec3 along = normalized(cross(n, Vec3{uniform(engine), uniform(engine), uniform(engine)})) * 0.3;
            EXPECT_EQ(plate.at(along + n * (far * h)).region, above);
            EXPECT_EQ(plate.at(along - n * (far * h)).region, below);
        }
    }
}

TEST(Spots, PlacesInOpenCellsStayWhereTheyAre) {
    const Plate plate({0, 0, 1});
    EXPECT_EQ(plate.at({0.1, 0.2, 0.5}).place, (Vec3{0.1, 0.2, 0.5}));
    EXPECT_EQ(plate.at({1, 1, 1}).place, (Vec3{1, 1, 1})); // on the box
}

TEST(Spots, RefusesWithAPlaceToGoTo) {
    const Plate plate({0, 0, 1});
    for (const auto& [place, words] : {std::pair(Vec3{0.1, 0.2, 0}, "the geometry cuts"), std::pair(Vec3{0, 0, 2}, "outside the domain box")}) {
        try {
            plate.at(place);
            ADD_FAILURE();
        } catch (const Error& e) {
            EXPECT_EQ(e.kind(), ErrorKind::input);
            EXPECT_THAT(e.problem(), testing::HasSubstr(words));
            EXPECT_THAT(e.remedy(), testing::AnyOf(testing::HasSubstr("for example to ("), testing::HasSubstr("between (-1 -1 -1)")));
        }
    }
}

} // namespace
} // namespace i2b
