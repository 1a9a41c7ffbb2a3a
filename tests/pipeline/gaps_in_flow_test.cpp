// Proves: gaps get smaller cells where the flow comes to them, those that it enters only with cells as small too, and the room
// inside thin solids does not; the mesh is valid, on the geometry, and the same on any number of threads.
#include "grid/cell_at.h"
#include "i2b/program/generate.h"
#include "pipeline/stages_run.h"
#include "pipeline/temporary_stl.h"
#include <gtest/gtest.h>
#include <tbb/global_control.h>

namespace i2b::test {
namespace {

// Two slabs 0.13 m thick, one above the other for part of their length.
Surface slabs(double gap) {
    Surface s;
    addPart(s, samples::box({0.013, 0.021, 0.007}, {3.013, 1.021, 0.137}), "lower");
    addPart(s, samples::box({2.013, 0.021, 0.137 + gap}, {5.013, 1.021, 0.267 + gap}), "upper");
    return s;
}

Options optionsOf(const TemporaryStl& file, int gapCells) {
    Options options;
    options.geometry.files = {file.path()};
    options.size.surface = 0.1, options.size.max = 0.8, options.size.gapCells = gapCells;
    options.domain.box = Box{{-2, -2, -2}, {7.6, 2.8, 2}};
    return options;
}

TEST(GapsInFlow, AreRefinedAndThinSolidsAreNot) {
    for (const double gap : {0.06, 0.09, 0.15}) { // the first two are too narrow for cells of 0.1 m
        const TemporaryStl file(slabs(gap));
        Context context;
        const auto grid = generateGrid(optionsOf(file, 2), context, Road::grid);
        for (double x = 2.05; x < 3; x += 0.09) {
            EXPECT_LE(cellAt(grid->grid, {x, 0.5, 0.137 + gap / 2}), 0.05) << gap << " " << x;
        }
        for (double x = 0.2; x < 1.7; x += 0.09) {
            EXPECT_GT(cellAt(grid->grid, {x, 0.5, 0.072}), 0.05) << gap << " " << x;
            EXPECT_GT(cellAt(grid->grid, {x + 3.2, 0.5, 0.2 + gap}), 0.05) << gap << " " << x;
        }
        EXPECT_EQ(generateGrid(optionsOf(file, 0), context, Road::grid)->grid.levels.size() + 1, grid->grid.levels.size());
    }
}

TEST(GapsInFlow, AreMeshedToTheirEnd) {
    const TemporaryStl file(slabs(0.09));
    Context context;
    const MeshResult mesh = generate(optionsOf(file, 2), context);
    EXPECT_EQ(mesh.mesh.validate(), "");
    EXPECT_TRUE(mesh.report.quality->negativeVolumeCells == 0 && mesh.report.quality->wrongOrientedFaces == 0);
    EXPECT_GT(mesh.report.fit->wallNodesOnGeometryFraction, 0.98);
    EXPECT_GT(mesh.report.fit->featureCaptureFraction, 0.85);
    EXPECT_EQ(mesh.report.fit->tilted45FaceFraction, 0);
    std::size_t inside = 0; // wall nodes on the lower slab under the upper one
    for (const std::int32_t n : mesh.wallNodes.points) {
        const Vec3& p = mesh.mesh.points[static_cast<std::size_t>(n)];
        inside += std::abs(p.z - 0.137) < 1e-3 && p.x > 2.1 && p.x < 2.95 && p.y > 0.1 && p.y < 0.95;
    }
    EXPECT_GT(inside, 200u);
    for (const std::size_t threads : {1, 3}) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        EXPECT_EQ(generate(optionsOf(file, 2), context).mesh.checksum(), mesh.mesh.checksum());
    }
}

} // namespace
} // namespace i2b::test
