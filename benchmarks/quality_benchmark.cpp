// Speed of the quality check and of PolyMesh::validate on a hexahedral mesh of n^3 cells with jittered
// points, and of the check on a mesh read from I2B_BENCHMARK_MESH (an OpenFOAM case) where that is set.
// Compare with the time of "checkMesh -allTopology -allGeometry" on the same case.
#include "i2b/core/memory.h"
#include "i2b/quality/quality_report.h"
#include "i2b/write/foam_read.h"
#include <benchmark/benchmark.h>
#include <cstdlib>
#include <random>

namespace {

using namespace i2b;

PolyMesh jitteredBox(std::int32_t n) {
    PolyMesh mesh;
    std::mt19937 random(3);
    std::uniform_real_distribution<double> jitter(-0.1, 0.1);
    const std::int32_t m = n + 1;
    for (std::int32_t k = 0; k < m; ++k)
        for (std::int32_t j = 0; j < m; ++j)
            for (std::int32_t i = 0; i < m; ++i)
                mesh.points.push_back({i + jitter(random), j + jitter(random), k + jitter(random)});
    mesh.cells = n * n * n;
    mesh.faceOffsets.push_back(0);
    const std::int32_t step[3] = {1, m, m * m}, cellStep[3] = {1, n, n * n};
    // The face on the low side of point p across an axis, its normal along the axis or against it.
    const auto add = [&](std::int32_t p, int axis, std::int32_t owner, bool along) {
        const std::int32_t u = step[(axis + 1) % 3], v = step[(axis + 2) % 3];
        const std::int32_t loop[4] = {p, p + u, p + u + v, p + v};
        for (int i = 0; i < 4; ++i) mesh.faceVertices.push_back(loop[along ? i : 3 - i]);
        mesh.faceOffsets.push_back(static_cast<std::uint32_t>(mesh.faceVertices.size()));
        mesh.owner.push_back(owner);
    };
    for (const bool inside : {true, false}) {
        for (std::int32_t c = 0; c < mesh.cells; ++c) {
            const std::int32_t at[3] = {c % n, c / n % n, c / n / n};
            const std::int32_t p = at[0] + m * (at[1] + m * at[2]);
            for (int axis = 0; axis < 3; ++axis) {
                if ((at[axis] + 1 < n) == inside) {
                    add(p + step[axis], axis, c, true);
                    if (inside) mesh.neighbour.push_back(c + cellStep[axis]);
                }
                if (!inside && at[axis] == 0) add(p, axis, c, false);
            }
        }
    }
    mesh.patches.push_back({"wall", "wall", mesh.internalFaces(), mesh.faces() - mesh.internalFaces()});
    return mesh;
}

void run(benchmark::State& state, const PolyMesh& mesh) {
    for (auto _ : state) benchmark::DoNotOptimize(measureQuality(mesh).failedChecks);
    state.SetItemsProcessed(state.iterations() * mesh.cells);
    state.counters["cells"] = mesh.cells;
    state.counters["peak_MB"] = static_cast<double>(peakResidentBytes()) / 1e6;
}

void measureBox(benchmark::State& state) {
    run(state, jitteredBox(static_cast<std::int32_t>(state.range(0))));
}
BENCHMARK(measureBox)->Arg(40)->Arg(76)->Arg(140)->Unit(benchmark::kMillisecond)->UseRealTime();

void validateBox(benchmark::State& state) {
    const PolyMesh mesh = jitteredBox(static_cast<std::int32_t>(state.range(0)));
    for (auto _ : state) benchmark::DoNotOptimize(mesh.validate());
    state.SetItemsProcessed(state.iterations() * mesh.cells);
}
BENCHMARK(validateBox)->Arg(76)->Unit(benchmark::kMillisecond)->UseRealTime();

void measureFile(benchmark::State& state) {
    const char* folder = std::getenv("I2B_BENCHMARK_MESH");
    if (folder == nullptr) {
        state.SkipWithError("I2B_BENCHMARK_MESH names no OpenFOAM case");
        return;
    }
    run(state, readFoam(folder));
}
BENCHMARK(measureFile)->Unit(benchmark::kMillisecond)->UseRealTime();

} // namespace
