#include "i2b/samples/sample.h"
#include "samples/edges.h"
#include "samples/flood.h"
#include <gmock/gmock.h>
#include <set>

namespace i2b {
namespace {

Box boundsOf(const Surface& s, std::int32_t part = -1) {
    Box box;
    for (std::size_t t = 0; t < s.triangles.size(); ++t)
        if (part < 0 || s.partOf[t] == part)
            for (const auto i : s.triangles[t]) box.add(s.points[i]);
    return box;
}

std::int32_t partNamed(const Surface& s, const std::string& name) {
    for (std::size_t i = 0; i < s.parts.size(); ++i)
        if (s.parts[i].name == name) return std::int32_t(i);
    ADD_FAILURE() << "no part " << name;
    return 0;
}

double volumeOf(const Surface& s, std::int32_t part) {
    double six = 0;
    for (std::size_t t = 0; t < s.triangles.size(); ++t)
        if (s.partOf[t] == part)
            six += dot(s.points[s.triangles[t][0]],
                       cross(s.points[s.triangles[t][1]], s.points[s.triangles[t][2]]));
    return six / 6;
}

double area(const Surface& s, std::size_t t) {
    const auto& [a, b, c] = s.triangles[t];
    return norm(cross(s.points[b] - s.points[a], s.points[c] - s.points[a])) / 2;
}

std::array<std::uint32_t, 3> sorted(std::array<std::uint32_t, 3> t) {
    std::sort(t.begin(), t.end());
    return t;
}

// Places that the flow outside must not reach, one in every hollow of the engine.
struct Hollow {
    const char* name;
    Vec3 place;
};
const Hollow hollows[] = {{"valve cover", {0.250, 0.040, 0.590}},
                          {"head", {0.300, 0, 0.500}},
                          {"bore", {0.152, 0, 0.370}},
                          {"block below the jacket", {0.200, 0.055, 0.300}},
                          {"crankcase", {0.300, 0, 0.220}},
                          {"oil pan", {0.200, 0, 0.130}},
                          {"timing cover", {0.068, 0.030, 0.40}},
                          {"plenum", {0.300, 0.215, 0.575}}};

// The promise of the brief: 32 parts, unique names that can be patch names, 20 to 60 thousand triangles,
// size.
TEST(EngineSample, HasThirtyTwoNamedPartsAndTheSizeOfAnEngine) {
    for (const double dirt : {0.0, 1.0}) {
        const Surface s = makeSample("engine", {dirt, 1});
        ASSERT_EQ(s.parts.size(), 32u);
        std::set<std::string> names;
        std::uint64_t sum = 0;
        for (const Part& p : s.parts) {
            names.insert(p.name);
            sum += p.triangles;
            EXPECT_GT(p.triangles, 0u) << p.name;
            EXPECT_EQ(p.name.find_first_not_of("abcdefghijklmnopqrstuvwxyz_0123456789"), std::string::npos)
                << p.name;
        }
        EXPECT_EQ(names.size(), 32u);
        EXPECT_EQ(sum, s.triangles.size());
        EXPECT_EQ(s.partOf.size(), s.triangles.size());
        EXPECT_GT(s.triangles.size(), 20000u);
        EXPECT_LT(s.triangles.size(), 60000u);
        for (const auto& t : s.triangles)
            for (const auto i : t) ASSERT_LT(i, s.points.size());
        for (const Vec3& p : s.points) ASSERT_TRUE(isFinite(p));
        const Vec3 e = boundsOf(s).extent();
        EXPECT_NEAR(e.x, 0.6, 0.05);
        EXPECT_NEAR(e.y, 0.5, 0.05);
        EXPECT_NEAR(e.z, 0.7, 0.05);
    }
}

// The clean twin: each part a set of closed shells with outward normals and no triangle without area.
TEST(EngineSample, CleanPartsAreClosedAndOriented) {
    for (const int resolution : {1, 2}) {
        const Surface s = makeSample("engine", {0, resolution});
        for (std::size_t p = 0; p < s.parts.size(); ++p) {
            const test::EdgeCount e = test::countEdges(s, std::int32_t(p));
            EXPECT_EQ(e.open, 0u) << s.parts[p].name;
            EXPECT_EQ(e.crowded, 0u) << s.parts[p].name;
            EXPECT_EQ(e.flipped, 0u) << s.parts[p].name;
            EXPECT_GT(volumeOf(s, std::int32_t(p)), 0) << s.parts[p].name;
        }
        for (std::size_t t = 0; t < s.triangles.size(); ++t) ASSERT_GT(area(s, t), 1e-12) << t;
    }
}

// Every kind of dirt that sample.h promises is there, in countable numbers.
TEST(EngineSample, DirtIsAsPromised) {
    const Surface s = makeSample("engine");
    // Ribs: in the block, 4 ribs with 6 edges each at three triangles; nothing else is crowded there.
    const auto block = partNamed(s, "cylinder_block");
    EXPECT_EQ(test::countEdges(s, block).three, 24u);
    EXPECT_EQ(test::countEdges(s, block).crowded, 24u);
    // Open rims of hollow parts and of the jacket's lid.
    for (const char* name : {"cylinder_block", "valve_cover", "oil_pan", "timing_cover", "water_jacket"})
        EXPECT_GT(test::countEdges(s, partNamed(s, name)).open, 20u) << name;
    // Triangles twice, and of no area.
    std::set<std::array<std::uint32_t, 3>> seen;
    std::size_t twice = 0, flat = 0;
    for (std::size_t t = 0; t < s.triangles.size(); ++t) {
        flat += area(s, t) < 1e-15;
        twice += !seen.insert(sorted(s.triangles[t])).second;
    }
    EXPECT_EQ(flat, 14u);
    EXPECT_GT(twice, 300u);
    // Inside out as a whole, and triangle by triangle.
    EXPECT_LT(volumeOf(s, partNamed(s, "alternator")), 0);
    EXPECT_LT(volumeOf(s, partNamed(s, "intake_runner_3")), 0);
    EXPECT_GT(test::countEdges(s, partNamed(s, "valve_cover")).flipped, 100u);
    // The stray sheet: the collector's part reaches beyond its clean twin, towards -y.
    const Surface clean = makeSample("engine", {0, 1});
    const auto collector = partNamed(s, "exhaust_collector");
    EXPECT_LT(boundsOf(s, collector).lo.x, boundsOf(clean, collector).lo.x - 0.1);
    EXPECT_EQ(test::countEdges(s, collector).open, 40u); // its rim: 2 (12 + 8) edges
}

// Cracks have the widths that were chosen and grow with dirt; clean parts overlap there instead.
TEST(EngineSample, CracksScaleWithDirt) {
    const auto crack =
        [](double dirt) { // between head and valve cover, oil pan and crankcase, deck and gasket
            const Surface s = makeSample("engine", {dirt, 1});
            // The heights of the faces opposite are fixed.
            return Vec3{boundsOf(s, partNamed(s, "valve_cover")).lo.z - 0.56,
                        0.155 - boundsOf(s, partNamed(s, "oil_pan")).hi.z,
                        boundsOf(s, partNamed(s, "head_gasket")).lo.z - 0.445};
        };
    for (const double dirt : {0.5, 1.0, 2.0}) {
        EXPECT_NEAR(crack(dirt).x, 0.5e-3 * dirt, 1e-9);
        EXPECT_NEAR(crack(dirt).y, 0.8e-3 * dirt, 1e-9);
        EXPECT_NEAR(crack(dirt).z, 0.2e-3 * dirt, 1e-9);
    }
    const Vec3 clean = crack(0);
    EXPECT_NEAR(clean.x, -0.5e-3, 1e-9);
    EXPECT_NEAR(clean.y, -0.5e-3, 1e-9);
    EXPECT_NEAR(clean.z, -0.5e-3, 1e-9);
}

// Overlaps have the depths that were chosen and grow with dirt; clean parts overlap by 1 mm there.
TEST(EngineSample, OverlapsScaleWithDirt) {
    for (const double dirt : {0.0, 0.5, 1.0, 2.0}) {
        const Surface s = makeSample("engine", {dirt, 1});
        const auto box = [&](const char* name) { return boundsOf(s, partNamed(s, name)); };
        const auto depth = [&](double mm) { return dirt > 0 ? 1e-3 * mm * dirt : 1e-3; };
        EXPECT_NEAR(box("exhaust_runner_2").hi.y - -0.088, depth(1), 1e-9);                 // into the head
        EXPECT_NEAR(0.351 - box("exhaust_runner_2").lo.z, depth(3), 1e-9);                  // the collector
        EXPECT_NEAR(box("throttle_body").hi.x - box("intake_plenum").lo.x, depth(2), 1e-9); // the plenum
        EXPECT_LT(box("throttle_body").lo.x, box("intake_plenum").lo.x);
    }
}

// The contract of the paper: holes smaller than the cells do not matter. At 2 mm and more, wherever the
// lattice lies, the flow outside reaches no hollow of the engine, clean or dirty.
TEST(EngineSample, OutsideIsClosedForCellsOfTwoMillimetres) {
    for (const double dirt : {0.0, 1.0}) {
        const Surface s = makeSample("engine", {dirt, 1});
        for (const auto& [size, shift] :
             {std::pair{0.002, 0.0}, {0.002, 0.37}, {0.003, 0.61}, {0.005, 0.2}}) {
            test::Voxels v = test::voxelise(s, size, 0.02, shift);
            flood(v, v.box.lo);
            EXPECT_TRUE(v.reached(v.box.hi - Vec3{size, size, size}));
            for (const Hollow& h : hollows) EXPECT_FALSE(v.reached(h.place)) << h.name << " at " << size;
            EXPECT_FALSE(v.reached(*sampleSeed("engine", "jacket")));
        }
    }
}

// The hollows are real: with cracks wider than the cells the flow finds its way in.
TEST(EngineSample, WideCracksLeak) {
    const Surface s = makeSample("engine", {8, 1});
    test::Voxels v = test::voxelise(s, 0.0015, 0.02);
    flood(v, v.box.lo);
    EXPECT_TRUE(v.reached({0.250, 0.040, 0.590})); // under the valve cover
    EXPECT_TRUE(v.reached({0.200, 0, 0.130}));     // in the oil pan
    EXPECT_TRUE(v.reached({0.200, 0.055, 0.300})); // in the hollow block
}

// The jacket's region is closed at 3 mm and runs round all four bores and through both coolant bores to the
// plugs.
TEST(EngineSample, JacketIsOneClosedRegion) {
    for (const double dirt : {0.0, 1.0}) {
        const Surface s = makeSample("engine", {dirt, 1});
        for (const double shift : {0.0, 0.45}) {
            test::Voxels v = test::voxelise(s, 0.003, 0.02, shift);
            flood(v, *sampleSeed("engine", "jacket"));
            EXPECT_FALSE(v.reached(v.box.lo));
            for (const Hollow& h : hollows) EXPECT_FALSE(v.reached(h.place)) << h.name;
            for (int c = 0; c < 4; ++c)
                for (const double side : {-0.053, 0.053})
                    EXPECT_TRUE(v.reached({0.152 + 0.096 * c, side, 0.370})) << c;
            EXPECT_TRUE(v.reached({0.248, 0.095, 0.350})); // inlet bore
            EXPECT_TRUE(v.reached({0.556, 0, 0.480}));     // outlet bore, near its plug
            const double volume = double(v.count(2)) * 27e-9;
            EXPECT_GT(volume, 0.0009); // of 2.4 litres cut by bores: what lies clear of the walls
            EXPECT_LT(volume, 0.0024);
        }
    }
}

} // namespace
} // namespace i2b
