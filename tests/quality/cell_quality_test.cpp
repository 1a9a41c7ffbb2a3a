// Proves: the worst of the cell-by-cell figures is the worst that the report gives, and volumes add up to its total.
#include "cell_mesh.h"
#include "i2b/quality/cell_quality.h"
#include "i2b/quality/quality_report.h"
#include <algorithm>
#include <gtest/gtest.h>
#include <numeric>

namespace i2b {
namespace {

// A block of 3 x 3 x 3 hexahedra with every inner point moved.
PolyMesh block() {
    std::vector<Vec3> points;
    const auto at = [](int i, int j, int k) { return static_cast<std::int32_t>((k * 4 + j) * 4 + i); };
    for (int k = 0; k < 4; ++k)
        for (int j = 0; j < 4; ++j)
            for (int i = 0; i < 4; ++i) {
                const double s = i % 3 && j % 3 && k % 3 ? 0.2 : 0;
                points.push_back({i + s * std::sin(3.0 * i + j), j + s * std::cos(i + 2.0 * k), k + s * std::sin(1.0 * j + k)});
            }
    std::vector<test::CellLoops> cells;
    for (int k = 0; k < 3; ++k)
        for (int j = 0; j < 3; ++j)
            for (int i = 0; i < 3; ++i)
                cells.push_back(test::hexLoops({at(i, j, k), at(i + 1, j, k), at(i + 1, j + 1, k), at(i, j + 1, k), at(i, j, k + 1),
                                                at(i + 1, j, k + 1), at(i + 1, j + 1, k + 1), at(i, j + 1, k + 1)}));
    return test::meshOfCells(points, cells);
}

TEST(CellQuality, WorstCellIsTheReportsWorst) {
    const PolyMesh mesh = block();
    CellFigures cells;
    const QualityReport report = measureQuality(mesh, {}, {}, &cells);
    const CellQuality& q = cells.quality;
    EXPECT_GT(report.maxNonOrthogonality, 1);
    EXPECT_FLOAT_EQ(*std::max_element(q.nonOrthogonality.begin(), q.nonOrthogonality.end()), static_cast<float>(report.maxNonOrthogonality));
    EXPECT_FLOAT_EQ(*std::max_element(q.skewness.begin(), q.skewness.end()), static_cast<float>(report.maxSkewness));
    EXPECT_NEAR(std::accumulate(q.volume.begin(), q.volume.end(), 0.0), report.totalVolume, 1e-5);
}

} // namespace
} // namespace i2b
