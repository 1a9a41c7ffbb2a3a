// Speed of the check and of the optimiser, in cells a second, on one thread and on all.
// The check goes stage by stage (read, measure, write the text) over an OpenFOAM case: that of I2B_BENCHMARK_MESH where that
// is set, else a hexahedral mesh of n^3 cells with jittered points. Beside it, where checkMesh is installed, its time for
// the same case as a whole process: the figure to hold against checkWhole.
// The optimiser mends a box, many of whose wall nodes were put in bad places.
#include "i2b/core/context.h"
#include "i2b/core/memory.h"
#include "i2b/quality/quality_report.h"
#include "i2b/repair/optimise.h"
#include "i2b/write/atomic_folder.h"
#include "i2b/write/foam_read.h"
#include "i2b/write/foam_write.h"
#include "pipeline/stages_run.h"
#include <benchmark/benchmark.h>
#include <cstdlib>
#include <filesystem>
#include <fmt/format.h>
#include <map>
#include <random>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <unistd.h>

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

constexpr int allThreads = 0;

// Threads of a run: the second argument, 0: all.
struct Threads {
    explicit Threads(benchmark::State& state)
        : count(state.range(1) == allThreads ? static_cast<std::size_t>(tbb::info::default_concurrency())
                                             : static_cast<std::size_t>(state.range(1))),
          limit(tbb::global_control::max_allowed_parallelism, count) {
        state.counters["threads"] = static_cast<double>(count);
    }
    std::size_t count;
    tbb::global_control limit;
};

void count(benchmark::State& state, std::int64_t cells) {
    state.SetItemsProcessed(state.iterations() * cells);
    state.counters["cells"] = static_cast<double>(cells);
    state.counters["peak_MB"] = static_cast<double>(peakResidentBytes()) / 1e6;
}

// The case on disk; one of our own goes away with the program.
class CaseOnDisk {
  public:
    explicit CaseOnDisk(std::int32_t n) {
        if (const char* const given = std::getenv("I2B_BENCHMARK_MESH")) {
            path_ = given;
            return;
        }
        path_ = std::filesystem::temp_directory_path() / fmt::format("i2b_quality_benchmark_{}_{}", n, getpid());
        own_ = true;
        AtomicFolder folder(path_);
        writeFoam(jitteredBox(n), folder, {}, Context());
        folder.commit();
    }
    ~CaseOnDisk() {
        std::error_code ignored;
        if (own_) std::filesystem::remove_all(path_, ignored);
    }
    CaseOnDisk(const CaseOnDisk&) = delete;
    CaseOnDisk& operator=(const CaseOnDisk&) = delete;
    std::string path() const { return path_.string(); }

    static const CaseOnDisk& of(std::int64_t n) {
        static std::map<std::int64_t, CaseOnDisk> cases;
        return cases.try_emplace(n, static_cast<std::int32_t>(n)).first->second;
    }

  private:
    std::filesystem::path path_;
    bool own_ = false;
};

void checkRead(benchmark::State& state) {
    const CaseOnDisk& disk = CaseOnDisk::of(state.range(0));
    const Threads threads(state);
    std::int64_t cells = 0;
    for (auto _ : state) cells = readFoam(disk.path()).cells;
    count(state, cells);
}

void checkMeasure(benchmark::State& state) {
    const PolyMesh mesh = readFoam(CaseOnDisk::of(state.range(0)).path());
    const Threads threads(state);
    for (auto _ : state) benchmark::DoNotOptimize(measureQuality(mesh).failedChecks);
    count(state, mesh.cells);
}

void checkText(benchmark::State& state) {
    const PolyMesh mesh = readFoam(CaseOnDisk::of(state.range(0)).path());
    const QualityReport report = measureQuality(mesh);
    const Threads threads(state);
    for (auto _ : state) benchmark::DoNotOptimize(formatQuality(report).size());
    count(state, mesh.cells);
}

// What i2b check does, all of it.
void checkWhole(benchmark::State& state) {
    const CaseOnDisk& disk = CaseOnDisk::of(state.range(0));
    const Threads threads(state);
    std::int64_t cells = 0;
    for (auto _ : state) {
        const PolyMesh mesh = readFoam(disk.path());
        benchmark::DoNotOptimize(formatQuality(measureQuality(mesh)).size());
        cells = mesh.cells;
    }
    count(state, cells);
}

// As a process; OpenFOAM's programs need to know where their etc folder is, which Debian's package does not say.
void checkMesh(benchmark::State& state) {
    if (std::system("command -v checkMesh > /dev/null 2>&1") != 0) {
        state.SkipWithError("OpenFOAM's checkMesh is not installed");
        return;
    }
    setenv("WM_PROJECT_DIR", "/usr/share/openfoam", 0);
    const std::string path = CaseOnDisk::of(state.range(0)).path();
    const std::string command = fmt::format("checkMesh -case '{}' -allTopology -allGeometry > /dev/null", path);
    for (auto _ : state)
        if (std::system(command.c_str()) != 0) state.SkipWithError("checkMesh failed");
    count(state, readFoam(path).cells);
}

void sizesAndThreads(benchmark::internal::Benchmark* b) {
    const bool given = std::getenv("I2B_BENCHMARK_MESH") != nullptr; // of which there is one size
    for (const std::int64_t n : given ? std::vector<std::int64_t>{0} : std::vector<std::int64_t>{76, 144})
        for (const std::int64_t threads : {1, allThreads}) b->Args({n, threads});
    b->Unit(benchmark::kMillisecond)->UseRealTime()->ArgNames({"n", "threads"});
}
void sizes(benchmark::internal::Benchmark* b) {
    const bool given = std::getenv("I2B_BENCHMARK_MESH") != nullptr;
    for (const std::int64_t n : given ? std::vector<std::int64_t>{0} : std::vector<std::int64_t>{76, 144}) b->Args({n});
    b->Unit(benchmark::kMillisecond)->UseRealTime()->ArgName("n")->Iterations(1);
}
BENCHMARK(checkRead)->Apply(sizesAndThreads);
BENCHMARK(checkMeasure)->Apply(sizesAndThreads);
BENCHMARK(checkText)->Apply(sizesAndThreads);
BENCHMARK(checkWhole)->Apply(sizesAndThreads);
BENCHMARK(checkMesh)->Apply(sizes);

void validateBox(benchmark::State& state) {
    const PolyMesh mesh = jitteredBox(static_cast<std::int32_t>(state.range(0)));
    const Threads threads(state);
    for (auto _ : state) benchmark::DoNotOptimize(mesh.validate());
    count(state, mesh.cells);
}
BENCHMARK(validateBox)->ArgNames({"n", "threads"})->Args({76, 1})->Args({76, allThreads})->Unit(benchmark::kMillisecond)->UseRealTime();

// Every fifth free node of the wall glides by up to the given share of a cell, to and fro by turns. Returns how many.
std::int64_t disturb(PolyMesh& mesh, Front& front, const LayerStack& layers, const std::vector<Snap>& snaps, double share) {
    MeshNodes nodes(front, layers);
    std::mt19937 random(7);
    std::uniform_real_distribution<double> step(-share, share);
    std::int64_t moved = 0;
    for (std::size_t v = 0; v < front.firstInserted(); v += 5) {
        const MeshNode node{MeshNode::wall, static_cast<std::int32_t>(v)};
        if (snaps[v].kind != SnapKind::none || nodes.outside(node) != 0) continue;
        const double h = nodes.h(node);
        const Vec3 to = nodes.place(node) + h * Vec3{step(random), step(random), step(random)};
        MeshNodes::Moved points;
        nodes.follow(node, to, points);
        for (const auto& [p, x] : points) mesh.points[static_cast<std::size_t>(p)] = x;
        nodes.moveTo(node, to);
        ++moved;
    }
    return moved;
}

// First argument: cells of the box along its length of 2 m.
void optimise(benchmark::State& state) {
    Options options = test::stagesOptions();
    options.size.surface = 2.0 / static_cast<double>(state.range(0));
    options.size.max = 4 * options.size.surface;
    const test::ToMesh run(test::turnedBox(), options);
    const Rows cellFaces = buildCellFaces(run.mesh);
    const std::vector<Snap> wishes(run.fitted.snaps.size());
    const Threads threads(state);
    QualityLimits limits;
    limits.nonOrthogonality = 40, limits.skewness = 2; // a box is easy
    std::int64_t nodes = 0, moves = 0;
    FaultCount before, after;
    for (auto _ : state) {
        state.PauseTiming();
        PolyMesh mesh = run.mesh;
        Front front = run.front;
        LayerStack layers = run.layers;
        std::vector<Snap> snaps = run.fitted.snaps;
        nodes = disturb(mesh, front, layers, snaps, 0.3);
        state.ResumeTiming();
        MeshFaults faults(mesh, cellFaces, limits);
        faults.poorCells(before);
        Optimiser optimiser(mesh, cellFaces, faults, front, layers, {*run.painted.index, run.features, snaps, wishes});
        moves += optimiser.mend(12) + optimiser.pullIn(3);
        faults.poorCells(after);
    }
    count(state, run.mesh.cells);
    state.counters["disturbed"] = static_cast<double>(nodes);
    state.counters["moves_per_second"] = benchmark::Counter(static_cast<double>(moves), benchmark::Counter::kIsRate);
    state.counters["faults_before"] = static_cast<double>(before.all);
    state.counters["faults_after"] = static_cast<double>(after.all);
}
BENCHMARK(optimise)->ArgNames({"n", "threads"})->Args({40, 1})->Args({40, allThreads})->Args({100, 1})->Args({100, allThreads})->Unit(benchmark::kMillisecond)->UseRealTime();

} // namespace
