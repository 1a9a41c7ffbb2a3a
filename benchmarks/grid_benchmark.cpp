// The grid stages one by one, and beside each the OpenVDB tool that comes nearest to it, on the same input and in the
// same run: meshToVolume for the cut, extractActiveVoxelSegmentMasks for paint. Items are cells: those that are cut
// for both cutters, those of the grid for build and cutLeaf, the open cells of the finest level for both painters.
#include "grid_cases.h"
#include "i2b/core/memory.h"
#include "i2b/grid/build.h"
#include "i2b/grid/cut.h"
#include "i2b/grid/mask_ops.h"
#include "i2b/paint/paint.h"
#include <benchmark/benchmark.h>
#include <openvdb/tools/LevelSetUtil.h>
#include <openvdb/tools/MeshToVolume.h>
#include <tbb/global_control.h>

namespace {

using namespace i2b;
using namespace i2b::benchmarks;

// What each stage is given; the last case asked for is kept, so that one is in memory at a time.
struct Input {
    std::string name;
    double millimetres = 0;
    SizeField field;
    std::vector<CellLevel> atTarget;
    CellGrid grid;
    CutCells cut;
};

const Input& inputOf(const std::string& name, double millimetres) {
    static Input input;
    if (input.name == name && input.millimetres == millimetres) return input;
    input = {};
    input.name = name;
    input.millimetres = millimetres;
    input.field = fieldOf(name, millimetres, 3);
    input.atTarget = cutAtTargetLevels(surfaceOf(name), input.field);
    input.grid = buildCellGrid(input.field, wantedCells(input.field, input.atTarget));
    input.cut = cutLeafCells(surfaceOf(name), input.field, input.grid, input.atTarget);
    return input;
}

void report(benchmark::State& state, std::uint64_t items) {
    const auto n = static_cast<double>(items);
    state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(items));
    state.counters["items"] = n;
    state.counters["peak_MB"] = static_cast<double>(peakResidentBytes()) * 1e-6;
}

std::uint64_t countOf(const std::vector<CellLevel>& levels) {
    std::uint64_t n = 0;
    for (const CellLevel& level : levels) n += i2b::countOf(*level.cells);
    return n;
}

void cut(benchmark::State& state, const Input& in) {
    for (auto _ : state) benchmark::DoNotOptimize(cutAtTargetLevels(surfaceOf(in.name), in.field));
    report(state, countOf(in.atTarget));
}

// The unsigned distance of the voxels that a triangle can meet: within half a diagonal, rounded up to its unit.
void meshToVolume(benchmark::State& state, const Input& in) {
    const Surface& surface = surfaceOf(in.name);
    const double h = in.millimetres * 1e-3;
    std::vector<openvdb::Vec3s> points;
    for (const Vec3& p : surface.points) {
        const Vec3 q = (p - in.field.lattice.origin) / h - Vec3{0.5, 0.5, 0.5};
        points.emplace_back(static_cast<float>(q.x), static_cast<float>(q.y), static_cast<float>(q.z));
    }
    std::vector<openvdb::Vec3I> triangles;
    for (const auto& t : surface.triangles) triangles.emplace_back(t[0], t[1], t[2]);
    const openvdb::tools::QuadAndTriangleDataAdapter<openvdb::Vec3s, openvdb::Vec3I> mesh(points, triangles);
    std::uint64_t voxels = 0;
    for (auto _ : state) {
        const auto grid = openvdb::tools::meshToVolume<openvdb::FloatGrid>(mesh, openvdb::math::Transform(), 1.0f, 1.0f,
                                                                          openvdb::tools::UNSIGNED_DISTANCE_FIELD);
        voxels = grid->activeVoxelCount();
    }
    report(state, countOf(in.atTarget));
    state.counters["voxels"] = static_cast<double>(voxels);
}

void build(benchmark::State& state, const Input& in) {
    for (auto _ : state) benchmark::DoNotOptimize(buildCellGrid(in.field, wantedCells(in.field, in.atTarget)));
    report(state, in.grid.cellCount());
}

void cutLeaf(benchmark::State& state, const Input& in) {
    for (auto _ : state) benchmark::DoNotOptimize(cutLeafCells(surfaceOf(in.name), in.field, in.grid, in.atTarget));
    report(state, in.grid.cellCount());
}

void paint(benchmark::State& state, const Input& in) {
    for (auto _ : state) benchmark::DoNotOptimize(labelRegions(in.grid, in.cut));
    report(state, in.grid.cellCount());
}

// Of the finest level alone, as the peer knows no levels.
void paintFinest(benchmark::State& state, const Input& in) {
    CellGrid grid;
    grid.lattice = in.field.lattice;
    grid.levels = {in.grid.levels.back()};
    const CutCells walls{{in.cut.levels.back()}};
    std::size_t regions = 0;
    for (auto _ : state) regions = labelRegions(grid, walls).table.size();
    report(state, grid.cellCount() - walls.cellCount());
    state.counters["regions"] = static_cast<double>(regions);
}

void segmentMasks(benchmark::State& state, const Input& in) {
    const Mask::Ptr open = differenceOf(*in.grid.levels.back().cells, *in.cut.levels.back());
    std::size_t regions = 0;
    for (auto _ : state) {
        std::vector<openvdb::BoolTree::Ptr> segments;
        openvdb::tools::extractActiveVoxelSegmentMasks(*open, segments);
        regions = segments.size();
    }
    report(state, i2b::countOf(*open));
    state.counters["regions"] = static_cast<double>(regions);
}

using Body = void (*)(benchmark::State&, const Input&);

void registerCase(const std::string& name, int millimetres) {
    const std::pair<const char*, Body> bodies[] = {{"cut", cut}, {"meshToVolume", meshToVolume}, {"build", build}, {"cutLeaf", cutLeaf},
                                                   {"paint", paint}, {"paintFinest", paintFinest}, {"segmentMasks", segmentMasks}};
    for (const auto& [stage, body] : bodies) {
        const std::string label = std::string(stage) + "/" + name + "/" + std::to_string(millimetres) + "mm";
        benchmark::RegisterBenchmark(label.c_str(), [body = body, name, millimetres](benchmark::State& state) {
            if (surfaceOf(name).triangles.empty()) {
                state.SkipWithError("motorBike.obj.gz is neither in $I2B_GEOMETRY_DIR nor in /usr/share/doc/openfoam-examples");
                return;
            }
            body(state, inputOf(name, millimetres));
        })->Unit(benchmark::kMillisecond)->UseRealTime();
    }
}

} // namespace

// $I2B_THREADS threads; all there are without it.
int main(int argc, char** argv) {
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
    const char* asked = std::getenv("I2B_THREADS");
    const int threads = asked ? std::atoi(asked) : 0;
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism,
                                      threads > 0 ? static_cast<std::size_t>(threads) : std::thread::hardware_concurrency());
    for (const char* name : {"engine", "motorBike"}) {
        for (int millimetres : {4, 2, 1}) registerCase(name, millimetres);
    }
    benchmark::RunSpecifiedBenchmarks();
}
