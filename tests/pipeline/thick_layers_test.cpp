// Proves: stacks of layers higher than a cell are reached on smooth walls, and walls that face each other share the way
// between them, by meshes that keep to the limits.
#include "i2b/geometry/write_stl.h"
#include "i2b/program/generate.h"
#include "i2b/samples/sample.h"
#include "pipeline/shape_run.h"
#include <filesystem>
#include <gtest/gtest.h>
#include <unistd.h>

namespace i2b::test {
namespace {

MeshResult meshOf(const Surface& geometry, double h, double cells) {
    const std::filesystem::path file = std::filesystem::temp_directory_path() / ("i2b_thick_" + std::to_string(getpid()) + ".stl");
    writeStl(geometry, file.string(), StlFormat::ascii); // parts by name
    Options options;
    options.geometry.files = {file.string()};
    options.size.surface = h;
    options.layers.count = 6, options.layers.thickness = cells, options.layers.unit = LayerUnit::cell;
    Context context;
    MeshResult result = generate(options, context);
    std::filesystem::remove(file);
    return result;
}

// Two slabs of 2 x 2 x 0.2 m over one another; the walls that face each other are the part "slot".
Surface slabs(double gap) {
    const Surface box = makeSample("box");
    const Vec3 lo = box.bounds().lo;
    Surface s;
    s.parts = {{"slab", "", 0}, {"slot", "", 0}};
    for (const double z : {0.0, 0.2 + gap}) {
        const auto base = static_cast<std::uint32_t>(s.points.size());
        for (const Vec3& p : box.points) s.points.push_back({2 * (p.x - lo.x), 2 * (p.y - lo.y), z + 0.2 * (p.z - lo.z)});
        const double facing = z == 0 ? 0.2 : z;
        for (const auto& t : box.triangles) {
            s.triangles.push_back({t[0] + base, t[1] + base, t[2] + base});
            bool isFacing = true;
            for (const std::uint32_t v : s.triangles.back()) isFacing = isFacing && std::abs(s.points[v].z - facing) < 1e-9;
            s.partOf.push_back(isFacing ? 1 : 0);
            ++s.parts[isFacing ? 1 : 0].triangles;
        }
    }
    return s;
}

TEST(ThickLayers, AreReachedOnSmoothWalls) {
    for (const char* name : {"sphere", "box"}) {
        for (const double cells : {1.5, 3.0}) {
            const MeshResult r = meshOf(makeSample(name), 0.05, cells);
            EXPECT_EQ(r.mesh.validate(), "") << name;
            EXPECT_EQ(plainFailures(*r.report.quality), "") << name << ' ' << cells;
            EXPECT_LE(r.report.quality->maxNonOrthogonality, 65) << name << ' ' << cells;
            EXPECT_GT(r.report.layers->thicknessFraction, 0.97) << name << ' ' << cells;
        }
    }
}

TEST(ThickLayers, ShareTheWayBetweenWallsThatFaceEachOther) {
    const double h = 0.05, gap = 5 * h;
    const MeshResult r = meshOf(slabs(gap), h, 3);
    EXPECT_EQ(r.mesh.validate(), "");
    EXPECT_EQ(plainFailures(*r.report.quality), "");
    EXPECT_EQ(r.report.quality->dictionaryFaces, 0);
    ASSERT_EQ(r.report.layers->parts.size(), 2U);
    const LayerRow &slab = r.report.layers->parts[0], &slot = r.report.layers->parts[1];
    ASSERT_EQ(slot.part, "slot");
    EXPECT_EQ(slot.meanCount, 6);
    EXPECT_GT(slot.meanThickness, 0.3 * gap); // without its front moved inwards a cell, 0.2
    EXPECT_LT(slot.meanThickness, 0.37 * gap); // a third, and more at the mouth
    EXPECT_GT(slab.meanThickness, 0.9 * 3 * h);
}

} // namespace
} // namespace i2b::test
