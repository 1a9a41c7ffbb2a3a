// Proves: a star's badness is what the report and MeshFaults say of the same cells, as shares of the limits; a cell inside
// out is invalid; a star sees all cells at its points and points that have moved since.
#include "i2b/repair/cell_star.h"
#include "i2b/quality/mesh_faults.h"
#include "quality/shaken_block.h"
#include <gtest/gtest.h>
#include <numbers>
#include <numeric>
#include <random>
#include <set>

namespace i2b {
namespace {

PolyMesh block(unsigned seed, double shake) {
    std::mt19937 random(seed);
    return test::shakenBlock(4, shake, random);
}

Badness judgeAll(const PolyMesh& mesh, const QualityLimits& limits, std::int32_t thinFrom) {
    const Rows cellFaces = buildCellFaces(mesh);
    const MeshFaults faults(mesh, cellFaces, limits, thinFrom);
    CellStar star(mesh, cellFaces, faults.moments(), limits, thinFrom);
    std::vector<std::int32_t> points(mesh.points.size());
    std::iota(points.begin(), points.end(), 0);
    star.gather(points, {0});
    EXPECT_EQ(star.cells().size(), static_cast<std::size_t>(mesh.cells));
    return star.judge();
}

// One that uses the point.
std::int32_t cellAt(const PolyMesh& mesh, const Rows& cellFaces, std::int32_t point) {
    for (std::int32_t c = 0; c < mesh.cells; ++c)
        for (const std::int32_t f : cellFaces[c])
            if (std::ranges::count(mesh.face(f), point) > 0) return c;
    return -1;
}

double orthoShare(double degrees, double limit) {
    constexpr double degree = std::numbers::pi / 180;
    return (1 - std::cos(degrees * degree)) / (1 - std::cos(limit * degree));
}

// Each measure in turn has a limit that makes it the worst: its share of the limit is the report's.
TEST(CellStar, WorstIsTheReportsWorst) {
    for (unsigned seed = 0; seed < 5; ++seed) {
        const PolyMesh mesh = block(seed, 0.2);
        const QualityReport q = measureQuality(mesh);
        ASSERT_EQ(q.wrongOrientedFaces, 0);
        QualityLimits loose;
        loose.nonOrthogonality = 89, loose.skewness = 1e3;
        loose.faceWeight = loose.volumeRatio = loose.determinant = 1e-6;
        QualityLimits l = loose;
        l.nonOrthogonality = q.maxNonOrthogonality / 2;
        EXPECT_NEAR(judgeAll(mesh, l, mesh.cells).worst, orthoShare(q.maxNonOrthogonality, l.nonOrthogonality), 1e-9);
        l = loose, l.skewness = q.maxSkewness / 3;
        EXPECT_NEAR(judgeAll(mesh, l, mesh.cells).worst, 3, 1e-9);
        l = loose, l.faceWeight = 2 * q.minFaceWeight;
        EXPECT_NEAR(judgeAll(mesh, l, mesh.cells).worst, 2, 1e-9);
        l = loose, l.volumeRatio = 4 * q.minVolumeRatio;
        EXPECT_NEAR(judgeAll(mesh, l, mesh.cells).worst, 4, 1e-9);
        l = loose, l.determinant = 5 * q.minDeterminant;
        EXPECT_NEAR(judgeAll(mesh, l, mesh.cells).worst, 5, 1e-9);
        EXPECT_LT(judgeAll(mesh, l, 0).worst, 1); // of thin cells the determinant does not count
    }
}

// Over one exactly where there is a fault, nought where nothing is near a limit.
TEST(CellStar, IsOverOneWhereThereAreFaults) {
    QualityLimits limits;
    limits.nonOrthogonality = 40, limits.skewness = 1, limits.faceWeight = 0.2, limits.volumeRatio = 0.2, limits.determinant = 0.1;
    int faulty = 0, fine = 0;
    for (unsigned seed = 0; seed < 40; ++seed) {
        const PolyMesh mesh = block(seed, 0.01 * seed);
        const Rows cellFaces = buildCellFaces(mesh);
        const MeshFaults faults(mesh, cellFaces, limits);
        FaultCount count;
        faults.poorCells(count);
        const Badness b = judgeAll(mesh, limits, mesh.cells);
        EXPECT_EQ(b.worst > 1, count.all > 0) << "seed " << seed;
        EXPECT_EQ(b.invalid, !faults.badCells().empty()) << "seed " << seed;
        EXPECT_EQ(b.sum > 0, b.worst > 0.9) << "seed " << seed;
        (count.all > 0 ? faulty : fine) += 1;
    }
    EXPECT_GT(faulty, 5);
    EXPECT_GT(fine, 5);
}

// Three cells, the upper two sheared: the sum by hand. Only non-orthogonality counts.
TEST(CellStar, SumsSquaresOfWhatIsOver) {
    const double shift = 2 * std::tan(20 * std::numbers::pi / 180); // 20 degrees from face to face
    const PolyMesh mesh = test::columnOf({test::square(0), test::square(1), test::square(2, {shift, 0, 0})});
    QualityLimits limits;
    limits.skewness = 1e3;
    for (const double limit : {15.0, 20.0, 20.5, 40.0}) {
        limits.nonOrthogonality = limit;
        const double share = orthoShare(20, limit), over = std::max(0.0, share - 0.9);
        const Badness b = judgeAll(mesh, limits, 0);
        EXPECT_NEAR(b.worst, share, 1e-9) << limit;
        EXPECT_NEAR(b.sum, over * over, 1e-9) << limit;
        EXPECT_FALSE(b.invalid) << limit;
    }
}

// A hexahedron whose top has gone through its bottom; blocks shaken ever harder, as MeshFaults sees them.
TEST(CellStar, CellsInsideOutAreInvalid) {
    EXPECT_FALSE(judgeAll(test::columnOf({test::square(0), test::square(1), test::square(2)}), {}, 0).invalid);
    EXPECT_TRUE(judgeAll(test::columnOf({test::square(0), test::square(1), test::square(0.5)}), {}, 0).invalid);
    int invalid = 0;
    for (unsigned seed = 0; seed < 20; ++seed) {
        const PolyMesh mesh = block(seed, 0.3 + 0.02 * seed);
        const Rows cellFaces = buildCellFaces(mesh);
        const Badness b = judgeAll(mesh, {}, mesh.cells);
        EXPECT_EQ(b.invalid, !MeshFaults(mesh, cellFaces, {}).badCells().empty()) << "seed " << seed;
        invalid += b.invalid;
        if (b.invalid) { EXPECT_GT(b.worst, 1); }
    }
    EXPECT_GT(invalid, 3);
    EXPECT_LT(invalid, 20);
}

// Where pyramids are low, which is no fault, moves for another thing's sake must not trade that for what is one.
TEST(CellStar, MayNotTradeLowPyramidsForFaults) {
    QualityLimits limits;
    limits.nonOrthogonality = 65, limits.skewness = 4;
    std::mt19937 random(3);
    const auto real = [&] { return static_cast<double>(random()) / 2147483648.0 - 1; };
    int may = 0, trades = 0;
    for (unsigned seed = 0; seed < 100; ++seed) {
        PolyMesh mesh = block(seed, 0.75);
        const Rows cellFaces = buildCellFaces(mesh);
        const MeshFaults faults(mesh, cellFaces, limits);
        CellStar star(mesh, cellFaces, faults.moments(), limits, 0);
        const std::int32_t point = 31; // an inner one
        star.gather({point}, {cellAt(mesh, cellFaces, point)});
        const Badness before = star.judge();
        const Vec3 from = mesh.points[point];
        for (int i = 0; i < 100; ++i) {
            mesh.points[point] = from + Vec3{real(), real(), real()} * 0.3;
            const bool mayStand = star.mayStand(before);
            const Badness now = star.judge();
            if (now.invalid) {
                EXPECT_FALSE(mayStand);
                continue;
            }
            EXPECT_LE(now.beyond, now.worst);
            may += mayStand;
            const bool isNoWorse = now.worst <= std::max(nearLimit, before.worst) && (now.worst <= nearLimit || now.sum <= before.sum);
            const bool addsFault = now.beyond > std::max(nearLimit, before.beyond);
            EXPECT_EQ(mayStand, isNoWorse && !addsFault);
            trades += isNoWorse && addsFault;
        }
    }
    EXPECT_GT(may, 200);
    EXPECT_GT(trades, 20);
}

// The star of one point: the cells that use it, found from any of them; judged with the point where it is now, and the same
// as from fresh moments.
TEST(CellStar, FollowsItsPoint) {
    PolyMesh mesh = block(7, 0.1);
    const Rows cellFaces = buildCellFaces(mesh);
    QualityLimits limits;
    limits.nonOrthogonality = 10, limits.skewness = 0.2, limits.faceWeight = 0.45;
    const MeshFaults faults(mesh, cellFaces, limits);
    const std::int32_t point = 31; // an inner one
    std::set<std::int32_t> users;
    for (std::int32_t c = 0; c < mesh.cells; ++c)
        for (const std::int32_t f : cellFaces[c])
            if (std::ranges::count(mesh.face(f), point) > 0) users.insert(c);
    ASSERT_EQ(users.size(), 8u);
    const Vec3 from = mesh.points[point];
    for (const std::int32_t start : users) {
        mesh.points[point] = from;
        CellStar star(mesh, cellFaces, faults.moments(), limits, mesh.cells);
        star.gather({point}, {start});
        EXPECT_EQ(star.cells(), std::vector<std::int32_t>(users.begin(), users.end()));
        const double before = star.judge().sum;
        mesh.points[point] = from + Vec3{0.3, 0.1, -0.2};
        const Badness moved = star.judge();
        EXPECT_GT(moved.sum, before);
        const MeshFaults fresh(mesh, cellFaces, limits);
        CellStar other(mesh, cellFaces, fresh.moments(), limits, mesh.cells);
        other.gather({point}, {start});
        EXPECT_EQ(other.judge().sum, moved.sum);
        EXPECT_EQ(other.judge().worst, moved.worst);
        mesh.points[point] = from;
        EXPECT_EQ(star.judge().sum, before);
    }
}

// Of a place close by, what made up the sums where the star was looked at first: there the same, beside it no more than all, and but for
// what has come in since as much. Later looks at all, which ask that first, see what a star sees that is looked at there first.
TEST(CellStar, SumsNearby) {
    QualityLimits limits;
    limits.nonOrthogonality = 20, limits.skewness = 0.5, limits.faceWeight = 0.4;
    const std::int32_t point = 31; // an inner one
    int faulty = 0;
    for (unsigned seed = 0; seed < 100; ++seed) {
        PolyMesh mesh = block(seed, 0.4);
        const Rows cellFaces = buildCellFaces(mesh);
        const MeshFaults faults(mesh, cellFaces, limits);
        const auto starHere = [&] {
            CellStar star(mesh, cellFaces, faults.moments(), limits, mesh.cells);
            star.gather({point}, {cellAt(mesh, cellFaces, point)});
            return star;
        };
        CellStar star = starHere();
        const double here = star.judge().sum, tets = star.judgeTets().sum;
        EXPECT_NEAR(star.sumNearby(), here, 1e-12 * here);
        EXPECT_NEAR(star.tetSumNearby(), tets, 1e-12 * tets);
        faulty += here > 0 && tets > 0;
        for (const double step : {1e-4, 0.1}) {
            mesh.points[point] += Vec3{0.3, 0.8, -0.5} * step;
            CellStar fresh = starHere();
            const Badness all = fresh.judge();
            const double allTets = fresh.judgeTets().sum;
            EXPECT_LE(star.sumNearby(), all.sum * (1 + 1e-12));
            EXPECT_LE(star.tetSumNearby(), allTets * (1 + 1e-12));
            if (step < 1e-3) {
                EXPECT_NEAR(star.sumNearby(), all.sum, 1e-6 * (1 + all.sum));
                EXPECT_NEAR(star.tetSumNearby(), allTets, 1e-6);
            }
            Badness most;
            most.worst = most.beyond = std::numeric_limits<double>::infinity(), most.invalid = true;
            const Badness again = star.judge(most, std::numeric_limits<double>::infinity());
            EXPECT_NEAR(again.sum, all.sum, 1e-12 * all.sum);
            EXPECT_EQ(again.worst, all.worst);
            EXPECT_EQ(again.invalid, all.invalid);
        }
    }
    EXPECT_GT(faulty, 20);
}

} // namespace
} // namespace i2b
