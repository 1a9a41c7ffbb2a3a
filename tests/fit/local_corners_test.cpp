// Proves: inverse cube roots are right but for their last digits, in lanes bit for bit as alone; energies are told from a
// limit without a root as with one; the energy of a node's corners is that of a plain sum over them, with the derivatives
// that differences give; a corner inside out makes it infinite and pulls the node the way that rights it.
#include "i2b/fit/local_corners.h"
#include <cmath>
#include <gtest/gtest.h>
#include <random>

namespace i2b::test {
namespace {

TEST(InverseCubeRoot, IsRightToItsLastDigits) {
    std::mt19937_64 random(7);
    std::uniform_real_distribution<double> power(-100, 100);
    for (int i = 0; i < 100000; ++i) {
        const double x = std::pow(10, power(random));
        const double exact = 1 / std::cbrt(x);
        ASSERT_NEAR(inverseCubeRoot(x) / exact, 1, 2e-15) << x;
        const CornerLanes lanes = inverseCubeRoot(CornerLanes(1, x, 2 * x, x));
        ASSERT_EQ(lanes[1], inverseCubeRoot(x));
        ASSERT_EQ(lanes[3], inverseCubeRoot(x));
        ASSERT_EQ(lanes[2], inverseCubeRoot(2 * x));
    }
}

TEST(EnergyExceeds, AgreesWithTheEnergy) {
    std::mt19937 random(11);
    std::uniform_real_distribution<double> trace(0.1, 30), det(-1, 4);
    int over = 0;
    for (int i = 0; i < 20000; ++i) {
        const double t = trace(random), d = det(random), energy = energyOf(t, d);
        for (const double limit : {2.2, 4.0, 0.4, 1e3}) {
            if (std::abs(energy - limit) < 1e-12 * limit) continue;
            ASSERT_EQ(energyExceeds(t, d, limit), energy > limit) << t << ' ' << d << ' ' << limit;
            over += energy > limit;
        }
        ASSERT_EQ(energyExceeds(t, d, std::numeric_limits<double>::max()), !(d > 0));
    }
    EXPECT_GT(over, 10000);
}

// Some corners around node 0, which is in each of their four places; of unlike sizes and weights, none inside out.
struct Star {
    Band band;
    Positions x;

    explicit Star(unsigned seed, std::size_t corners) {
        std::mt19937 random(seed);
        std::uniform_real_distribution<double> shake(-0.25, 0.25);
        const auto place = [&](double a, double b, double c) { return Vec3{a + shake(random), b + shake(random), c + shake(random)}; };
        x.push_back(place(0, 0, 0));
        RawVector<std::int32_t> around(corners);
        band.corners.list.resize(corners);
        for (std::size_t i = 0; i < corners; ++i) {
            Corner& corner = band.corners.list[i];
            const std::array<Vec3, 4> ideal{Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
            const std::size_t role = i % 4;
            for (std::size_t k = 0; k < 4; ++k) {
                if (k == role) continue;
                const Vec3 at = ideal[k] - ideal[role];
                corner.node[k] = static_cast<std::int32_t>(x.size());
                x.push_back(place(at.x, at.y, at.z));
            }
            corner.node[role] = 0;
            corner.inverseLength = {1, 1.25f, 0.8f};
            corner.weight = i % 3 == 0 ? 4 : 1;
            around[i] = static_cast<std::int32_t>(i);
        }
        band.corners.cellsOf.start.assign(2, 0);
        band.corners.prismsOf.start.assign({0, static_cast<std::int64_t>(corners)});
        band.corners.prismsOf.values = std::move(around);
    }

    double plainEnergy(const Vec3& d) const {
        double sum = 0;
        for (const Corner& c : band.corners.list) {
            std::array<Vec3, 4> p;
            for (std::size_t k = 0; k < 4; ++k) p[k] = x[static_cast<std::size_t>(c.node[k])] + (c.node[k] == 0 ? d : Vec3{});
            double trace = 0;
            for (std::size_t k = 0; k < 3; ++k) trace += norm2(p[k + 1] - p[0]) * double(c.inverseLength[k]) * double(c.inverseLength[k]);
            const double det = determinantOf(c, p[0], p[1], p[2], p[3]);
            const double phi = 0.25 * trace / std::cbrt(det * det) + 0.125 * (det + 1 / det);
            sum += det > 0 ? double(c.weight) * phi * phi * phi : std::numeric_limits<double>::infinity();
        }
        return sum;
    }
};

TEST(LocalCorners, EnergyIsThatOfAPlainSum) {
    for (unsigned seed = 0; seed < 40; ++seed) {
        const Star star(seed, 1 + seed); // groups of four, and such that are not full
        LocalCorners corners;
        corners.gather(star.band, 0, star.x);
        for (const Vec3& d : {Vec3{}, Vec3{0.03, -0.02, 0.05}, Vec3{-0.08, 0.01, 0.02}}) {
            const double plain = star.plainEnergy(d), energy = corners.energy(d);
            if (std::isinf(plain)) EXPECT_TRUE(std::isinf(energy));
            else EXPECT_NEAR(energy / plain, 1, 1e-9); // of almost flat ones D is known to fewer digits
        }
    }
}

TEST(LocalCorners, DerivativesAreThoseOfDifferences) {
    const double step = 1e-5;
    for (unsigned seed = 0; seed < 20; ++seed) {
        const Star star(seed, 9);
        LocalCorners corners;
        corners.gather(star.band, 0, star.x);
        const Vec3 d{0.02, 0.01, -0.03};
        if (std::isinf(corners.energy(d))) continue;
        const Derivatives at = corners.derivatives(d);
        const std::array<std::array<std::size_t, 3>, 3> place{{{0, 1, 2}, {1, 3, 4}, {2, 4, 5}}};
        for (int k = 0; k < 3; ++k) {
            Vec3 up = d, down = d;
            up[k] += step, down[k] -= step;
            const double high = corners.energy(up);
            const Vec3 gradientUp = corners.derivatives(up).gradient;
            const double low = corners.energy(down);
            const Vec3 gradientDown = corners.derivatives(down).gradient;
            const double scale = norm(at.gradient) + std::abs(at.hessian[0]);
            EXPECT_NEAR((high - low) / (2 * step), at.gradient[k], 1e-5 * scale);
            for (int j = 0; j < 3; ++j) {
                const double second = (gradientUp[j] - gradientDown[j]) / (2 * step);
                EXPECT_NEAR(second, at.hessian[place[static_cast<std::size_t>(k)][static_cast<std::size_t>(j)]], 1e-4 * scale);
            }
        }
    }
}

TEST(LocalCorners, InsideOutIsInfiniteAndPulledBack) {
    Star star(3, 1); // one corner, whose tip is node 0
    const Corner& c = star.band.corners.list[0];
    const auto at = [&](std::size_t k) { return star.x[static_cast<std::size_t>(c.node[k])]; };
    const Vec3 normal = normalized(cross(at(2) - at(1), at(3) - at(1)));
    const Vec3 foot = star.x[0] - normal * dot(star.x[0] - at(1), normal);
    const double side = dot(star.x[0] - at(1), normal) > 0 ? 1 : -1;
    for (const double beyond : {0.02, 0.1, 0.3}) {
        star.x[0] = foot - normal * (side * beyond);
        LocalCorners corners;
        corners.gather(star.band, 0, star.x);
        EXPECT_TRUE(std::isinf(corners.energy({})));
        EXPECT_LT(dot(corners.derivatives({}).gradient, normal * side), 0) << "downhill leads back through the plane of the others";
    }
}

} // namespace
} // namespace i2b::test
