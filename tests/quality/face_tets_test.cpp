// Proves: tetShare() of a square between two cells is 1, and falls below the limit of what divides where a corner turns back, a face has
// no width, or a cell's centre is on the wrong side; where all faces of a mesh are over that limit, none breaks the limits of
// tetrahedra, concavity or twist in the report; shares over what is enough are given as that; pyramidShare() is 0 at the least volume.
#include "i2b/quality/face_tets.h"
#include "i2b/quality/measures.h"
#include "i2b/quality/quality_report.h"
#include "quality/cell_mesh.h"
#include <gtest/gtest.h>
#include <numbers>
#include <random>

namespace i2b::test {
namespace {

using Index = std::size_t;

// Of the face between two cells whose centres are at a distance on either side of the middle of its points.
double shareOf(const std::array<Vec3, 4>& face, double distance = 0.5) {
    const PolyMesh mesh = columnOf({square(-1), face, square(1)});
    const FaceShape shape = measureFace(mesh, 0);
    const Vec3 below{0.5, 0.5, -distance}, above{0.5, 0.5, distance};
    return tetShare(mesh, 0, shape.centre, shape.area, below, &above);
}

TEST(TetShare, OfASquareIsOne) { EXPECT_DOUBLE_EQ(shareOf(square(0)), 1); }

TEST(TetShare, FallsWhereACornerTurnsBack) {
    // A dart whose reflex corner turns by an angle: the arms lie half of it below the horizontal.
    const auto dart = [](double degrees) {
        const double half = 0.5 * degrees * std::numbers::pi / 180;
        const Vec3 reflex{0.5, 0.5, 0}, arm{0.5 * std::cos(half), -0.5 * std::sin(half), 0};
        return std::array<Vec3, 4>{reflex + arm, Vec3{0.5, 1.4, 0}, reflex + Vec3{-arm.x, arm.y, 0}, reflex};
    };
    EXPECT_GT(shareOf(dart(40)), undividedShare);
    EXPECT_GT(shareOf(dart(40)), shareOf(dart(75)));
    EXPECT_GT(shareOf(dart(75)), undividedShare);
    EXPECT_LT(shareOf(dart(81)), undividedShare);
    EXPECT_LT(shareOf(dart(100)), shareOf(dart(81)));
}

TEST(TetShare, FallsWhereAFaceHasNoWidth) {
    const auto band = [](double width) { return std::array<Vec3, 4>{Vec3{0, 0.5 - width, 0}, Vec3{1, 0.5 - width, 0}, Vec3{1, 0.5, 0}, Vec3{0, 0.5, 0}}; };
    EXPECT_LT(shareOf(band(0)), 0);
    EXPECT_LT(shareOf(band(1e-4)), undividedShare);
    EXPECT_GT(shareOf(band(0.01)), undividedShare);
}

TEST(TetShare, FallsWhereACentreIsOnTheWrongSide) {
    const std::array<Vec3, 4> warped{Vec3{0, 0, 0.2}, Vec3{1, 0, -0.2}, Vec3{1, 1, 0.2}, Vec3{0, 1, -0.2}};
    EXPECT_GT(shareOf(warped, 0.5), undividedShare);
    EXPECT_LT(shareOf(warped, 0.1), undividedShare);
    EXPECT_LT(shareOf(warped, -0.5), 0);
}

TEST(TetShare, IsNoBetterThanTheReport) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> off(-0.6, 0.6);
    int good = 0, poor = 0;
    for (int i = 0; i < 4000; ++i) {
        std::vector<std::array<Vec3, 4>> levels{square(0), square(1), square(2)};
        for (auto& level : levels)
            for (Vec3& p : level) p += Vec3{off(random), off(random), off(random)};
        const PolyMesh mesh = columnOf(levels);
        const Rows cellFaces = buildCellFaces(mesh);
        std::array<Vec3, 2> centre;
        for (std::int32_t c = 0; c < 2; ++c) {
            std::vector<FaceShape> shapes;
            for (const std::int32_t f : cellFaces[c]) shapes.push_back(measureFace(mesh, f));
            centre[Index(c)] = measureCell(mesh, cellFaces[c], shapes, c).centre;
        }
        double least = 1;
        for (std::int32_t f = 0; f < mesh.faces(); ++f) {
            const FaceShape s = measureFace(mesh, f);
            least = std::min(least, tetShare(mesh, f, s.centre, s.area, centre[Index(mesh.owner[Index(f)])], f == 0 ? &centre[1] : nullptr));
        }
        std::int64_t broken = 0;
        for (const DictionaryCheck& check : measureQuality(mesh).dictionary)
            if (check.key == "minTetQuality" || check.key == "maxConcave" || check.key == "minTwist") broken += check.faces;
        if (least >= undividedShare) { EXPECT_EQ(broken, 0) << "column " << i; }
        ++(least >= undividedShare ? good : poor);
    }
    EXPECT_GT(good, 200);
    EXPECT_GT(poor, 200);
}

// The glance that settles most faces says the same as the close look, and so does a look that ends where there is no hope.
TEST(TetShare, IsCutOffAtWhatIsEnough) {
    std::mt19937 random(11);
    std::uniform_real_distribution<double> off(-0.5, 0.5), height(0.02, 1);
    int cut = 0, whole = 0, hoped = 0, given = 0;
    for (int i = 0; i < 20000; ++i) {
        std::array<Vec3, 4> face = square(0);
        for (Vec3& p : face) p += Vec3{off(random), off(random), 0.4 * off(random)};
        const PolyMesh mesh = columnOf({square(-1), face, square(1)});
        const FaceShape shape = measureFace(mesh, 0);
        const Vec3 below{0.5 + off(random), 0.5 + off(random), -height(random)}, above{0.5 + off(random), 0.5 + off(random), height(random)};
        const Vec3* const neighbour = i % 3 == 0 ? nullptr : &above;
        const double share = tetShare(mesh, 0, shape.centre, shape.area, below, neighbour);
        for (const double enough : {0.01, 0.08, 0.5}) {
            EXPECT_NEAR(tetShare(mesh, 0, shape.centre, shape.area, below, neighbour, enough), std::min(share, enough), 1e-12) << "face " << i;
            ++(share > enough ? cut : whole);
        }
        for (const double hopeless : {-1.5, -0.1, 0.0, 0.2}) {
            const double soon = tetShare(mesh, 0, shape.centre, shape.area, below, neighbour, 1, hopeless);
            if (share > hopeless) {
                EXPECT_EQ(soon, share) << "face " << i;
            } else {
                EXPECT_LE(soon, hopeless) << "face " << i;
            }
            ++(share > hopeless ? hoped : given);
        }
    }
    EXPECT_GT(cut, 5000);
    EXPECT_GT(whole, 5000);
    EXPECT_GT(hoped, 5000);
    EXPECT_GT(given, 5000);
}

TEST(FaceShape, OfAQuadrangleIsThatOfAPolygon) {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> any(-1, 1);
    for (int i = 0; i < 1000; ++i) {
        std::array<Vec3, 4> p;
        for (Vec3& v : p) v = {any(random), any(random), any(random)};
        if (i % 50 == 0) p[1] = p[3] = p[2] = p[0];
        const FaceShape quad = shapeOfQuad(p[0], p[1], p[2], p[3]), polygon = shapeOfPolygon(p.data(), p.size());
        EXPECT_EQ(quad.centre, polygon.centre); // to the last bit
        EXPECT_EQ(quad.area, polygon.area);
    }
}

TEST(PyramidShare, IsTheLesserOneBeyondTheLeast) {
    const PolyMesh mesh = columnOf({square(0), square(1), square(2)});
    const FaceShape shape = measureFace(mesh, 0); // area 1, from the first cell to the second
    const Vec3 below{0.5, 0.5, 0.4}, above{0.5, 0.5, 1.3};
    EXPECT_NEAR(pyramidShare(shape, below, nullptr, 0.2), 0, 1e-12);
    EXPECT_NEAR(pyramidShare(shape, below, &above, 0.2), -0.5, 1e-12);
    EXPECT_GT(pyramidShare(shape, above, nullptr, 0), 0); // not asked
}

} // namespace
} // namespace i2b::test
