// Proves that paint never runs through a wall whose cracks are smaller than a cell: a closed body is torn into single
// triangles, each corner of each moved by less than half the smallest cell, some turned over, some there twice; the cells
// inside and those outside stay different regions. (A path of open cells that crosses the wall has, around the place
// where it does, two cells that hold all points within half a cell of it; one of these is on the soup.) And that a hole
// of several cells is found.
#include "geometry/exact_box.h"
#include "i2b/grid/build.h"
#include "i2b/grid/cut.h"
#include "i2b/grid/mask_ops.h"
#include "i2b/paint/paint.h"
#include <gtest/gtest.h>
#include <random>

namespace i2b {
namespace {

using Triangle = std::array<Vec3, 3>;

class Leak : public testing::TestWithParam<int> {
  protected:
    double uniform(double lo, double hi) { return std::uniform_real_distribution<double>(lo, hi)(engine_); }
    Vec3 direction() {
        for (;;) {
            const Vec3 d{uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)};
            if (norm2(d) > 0.01 && norm2(d) <= 1) return normalized(d);
        }
    }

    // A bumpy body about the origin, within radii 0.5 and 1.5; all rays from the origin leave it once.
    std::vector<Triangle> bumpy(int splits) {
        std::vector<Triangle> sphere;
        for (int i = 0; i < 8; ++i) {
            sphere.push_back({Vec3{i & 4 ? -1.0 : 1.0, 0, 0}, Vec3{0, i & 2 ? -1.0 : 1.0, 0}, Vec3{0, 0, i & 1 ? -1.0 : 1.0}});
        }
        for (; splits > 0; --splits) {
            std::vector<Triangle> finer;
            for (const auto& [a, b, c] : sphere) {
                const Vec3 ab = normalized(a + b), bc = normalized(b + c), ca = normalized(c + a);
                finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
            }
            sphere = finer;
        }
        const Vec3 wave = direction() * uniform(2, 9);
        const double phase = uniform(0, 6), height = uniform(0, 0.4);
        for (Triangle& t : sphere) {
            for (Vec3& v : t) v = v * (1 + height * std::sin(dot(wave, v) + phase));
        }
        return sphere;
    }
    // A cube whose faces lie in planes of the lattice, or nearly.
    std::vector<Triangle> cube(double edge) {
        std::vector<Triangle> faces;
        const double r = edge / 2;
        for (int axis = 0; axis < 3; ++axis) {
            for (double side : {-r, r}) {
                std::array<Vec3, 4> q;
                for (int k = 0; k < 4; ++k) {
                    q[std::size_t(k)][axis] = side;
                    q[std::size_t(k)][(axis + 1) % 3] = k == 1 || k == 2 ? r : -r;
                    q[std::size_t(k)][(axis + 2) % 3] = k > 1 ? r : -r;
                }
                faces.push_back({q[0], q[1], q[2]});
                faces.push_back({q[0], q[2], q[3]});
            }
        }
        return faces;
    }
    void rotate(std::vector<Triangle>& body) {
        const Vec3 x = direction(), z = normalized(cross(x, direction())), y = cross(z, x);
        for (Triangle& t : body) {
            for (Vec3& v : t) v = x * v.x + y * v.y + z * v.z;
        }
    }
    void tear(std::vector<Triangle>& body, double reach) {
        const std::size_t n = body.size();
        for (std::size_t i = 0; i < n; ++i) {
            if (uniform(0, 1) < 0.2) body.push_back(body[i]);
        }
        for (Triangle& t : body) {
            if (uniform(0, 1) < 0.3) std::swap(t[0], t[1]);
            const Vec3 centre = (t[0] + t[1] + t[2]) / 3;
            const int how = static_cast<int>(uniform(0, 3));
            const Vec3 along = direction() * reach;
            for (Vec3& v : t) {
                if (how == 0) v += direction() * (reach * uniform(0, 1)); // each corner its own way
                if (how == 1) v += along;                                 // all the same way
                if (how == 2) v += normalized(centre - v) * std::min(reach, 0.9 * norm(centre - v)); // shrunk
            }
        }
        std::shuffle(body.begin(), body.end(), engine_);
    }
    static Surface surfaceOf(const std::vector<Triangle>& body) {
        Surface s;
        for (std::size_t i = 0; i < body.size(); ++i) {
            const auto k = static_cast<std::uint32_t>(3 * i);
            s.points.insert(s.points.end(), body[i].begin(), body[i].end());
            s.triangles.push_back({k, k + 1, k + 2});
            s.partOf.push_back(static_cast<std::int32_t>(i % 3));
        }
        for (const char* name : {"a", "b", "c"}) s.parts.push_back({name, "", 0});
        return s;
    }

    // Whether paint from a corner of the domain reaches the origin.
    static bool leaks(const Surface& soup, const SizeField& field) {
        const std::vector<CellLevel> at = cutAtTargetLevels(soup, field);
        const CellGrid grid = buildCellGrid(field, wantedCells(field, at));
        const Regions regions = labelRegions(grid, cutLeafCells(soup, field, grid, at));
        const std::int32_t inside = regionAt(regions, grid, {}), outside = regionAt(regions, grid, grid.lattice.origin);
        EXPECT_GE(inside, 0);
        EXPECT_GE(outside, 0);
        return inside == outside;
    }
    static std::int32_t regionAt(const Regions& regions, const CellGrid& grid, const Vec3& place) {
        for (std::size_t l = 0; l < grid.levels.size(); ++l) {
            const Index3 c = grid.lattice.cellAt(grid.levels[l].level, place);
            for (const RegionPiece& p : regions.pieces[l]) {
                const bool here = p.origin == Index3{c[0] & ~7, c[1] & ~7, c[2] & ~7};
                if (here && bits::test(p.mask, bits::offset(c[0], c[1], c[2]))) return p.region;
            }
        }
        return -1;
    }
    SizeField randomField(const Surface& soup, double h) {
        SizeOptions size;
        size.surface = h;
        size.max = 0.5;
        size.bufferCells = 1 + static_cast<int>(uniform(0, 3));
        if (uniform(0, 1) < 0.5) size.parts.push_back({"b", sameSize(2 * h)});
        if (uniform(0, 1) < 0.3) size.parts.push_back({"c", {h, 2 * h, 4 * h}});
        DomainOptions domain;
        const Vec3 low{-2 - uniform(0, 0.3), -2.2, -2 - uniform(0, 0.1)};
        domain.box = Box{low, low + Vec3{4.5, 4.5, 4.5}};
        return makeSizeField(soup, size, domain);
    }
    static double smallest(const SizeField& field) {
        const Vec3 s = field.lattice.cellSize(field.lattice.maxLevel);
        return std::min(s.x, std::min(s.y, s.z));
    }

    std::mt19937_64 engine_{static_cast<unsigned>(GetParam())};
};

TEST_P(Leak, PaintDoesNotRunThroughCracksSmallerThanACell) {
    for (int i = 0; i < exact::rounds(5); ++i) {
        std::vector<Triangle> body = i % 3 ? bumpy(2 + i % 3) : cube(uniform(1, 2));
        if (i % 2) rotate(body);
        const SizeField field = randomField(surfaceOf(body), uniform(0.05, 0.13)); // sizes do not depend on where triangles are
        std::vector<Triangle> torn = body;
        tear(torn, 0.499 * smallest(field));
        SizeField tornField = field;
        const Surface soup = surfaceOf(torn);
        ASSERT_FALSE(leaks(soup, tornField)) << i;
    }
}

TEST_P(Leak, WallsInPlanesOfTheLatticeAreTight) {
    SizeOptions size;
    size.surface = 0.0625;
    size.max = 0.5;
    DomainOptions domain;
    domain.box = Box{{-2, -2, -2}, {2, 2, 2}};
    std::vector<Triangle> body = cube(2);
    for (int i = 0; i < 4; ++i) {
        ASSERT_FALSE(leaks(surfaceOf(body), makeSizeField(surfaceOf(body), size, domain)));
        tear(body, 1e-16 * std::pow(10, 3 * i));
    }
}

TEST_P(Leak, AHoleOfSeveralCellsIsFound) {
    std::vector<Triangle> body = bumpy(4);
    rotate(body);
    const Vec3 way = direction();
    std::erase_if(body, [&](const Triangle& t) { return dot(normalized(t[0] + t[1] + t[2]), way) > 0.8; });
    const Surface soup = surfaceOf(body);
    EXPECT_TRUE(leaks(soup, randomField(soup, 0.1)));
}

INSTANTIATE_TEST_SUITE_P(Random, Leak, testing::Range(1, 9));

} // namespace
} // namespace i2b
