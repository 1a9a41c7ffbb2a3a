// Proves: stacks of layers higher than a cell are reached on smooth walls, by meshes that keep to the limits.
#include "i2b/geometry/write_stl.h"
#include "i2b/program/generate.h"
#include "i2b/samples/sample.h"
#include "pipeline/shape_run.h"
#include <filesystem>
#include <gtest/gtest.h>
#include <unistd.h>

namespace i2b::test {
namespace {

MeshResult meshOf(const char* name, double h, double cells) {
    const std::filesystem::path file = std::filesystem::temp_directory_path() / ("i2b_thick_" + std::to_string(getpid()) + "_" + name + ".stl");
    writeStl(makeSample(name), file.string(), StlFormat::binary);
    Options options;
    options.geometry.files = {file.string()};
    options.size.surface = h;
    options.layers.count = 6, options.layers.thickness = cells, options.layers.unit = LayerUnit::cell;
    Context context;
    MeshResult result = generate(options, context);
    std::filesystem::remove(file);
    return result;
}

TEST(ThickLayers, AreReachedOnSmoothWalls) {
    for (const char* name : {"sphere", "box"}) {
        for (const double cells : {1.5, 3.0}) {
            const MeshResult r = meshOf(name, 0.05, cells);
            EXPECT_EQ(r.mesh.validate(), "") << name;
            EXPECT_EQ(plainFailures(*r.report.quality), "") << name << ' ' << cells;
            EXPECT_LE(r.report.quality->maxNonOrthogonality, 65) << name << ' ' << cells;
            EXPECT_GT(r.report.layers->thicknessFraction, 0.97) << name << ' ' << cells;
        }
    }
}

} // namespace
} // namespace i2b::test
