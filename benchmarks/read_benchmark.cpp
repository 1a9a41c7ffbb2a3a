// Reading of STL: bytes a second and memory, for both kinds and for triangles in random order, which is where
// welding costs most. A file is written once to the temporary folder and stays in the system's cache, so the
// disk is not measured.
#include "i2b/core/memory.h"
#include "i2b/geometry/read.h"
#include "i2b/geometry/write_stl.h"
#include <algorithm>
#include <benchmark/benchmark.h>
#include <filesystem>
#include <random>
#include <unistd.h>

namespace {

// A wavy sheet of 2 n^2 triangles.
i2b::Surface sheet(std::uint32_t n, bool shuffled) {
    i2b::Surface s;
    for (std::uint32_t j = 0; j <= n; ++j)
        for (std::uint32_t i = 0; i <= n; ++i) {
            const double x = double(i) / n, y = double(j) / n;
            s.points.push_back({x, y, 0.1 * std::sin(20 * x) * std::cos(15 * y)});
        }
    for (std::uint32_t j = 0; j < n; ++j)
        for (std::uint32_t i = 0; i < n; ++i) {
            const std::uint32_t a = j * (n + 1) + i, b = a + n + 1;
            s.triangles.push_back({a, a + 1, b + 1});
            s.triangles.push_back({a, b + 1, b});
        }
    if (shuffled) std::shuffle(s.triangles.begin(), s.triangles.end(), std::mt19937(1));
    s.partOf.assign(s.triangles.size(), 0);
    s.parts.push_back({"sheet", "", s.triangles.size()});
    return s;
}

void readStl(benchmark::State& state, i2b::StlFormat format, bool shuffled) {
    const auto n = static_cast<std::uint32_t>(state.range(0));
    const std::string path = (std::filesystem::temp_directory_path() /
                              ("i2b-read-benchmark-" + std::to_string(::getpid()) + ".stl"))
                                 .string();
    i2b::writeStl(sheet(n, shuffled), path, format);
    for ([[maybe_unused]] auto round : state) {
        i2b::GeometryNotes notes;
        benchmark::DoNotOptimize(i2b::readSurface({path}, 1, notes));
    }
    const auto bytes = static_cast<std::int64_t>(std::filesystem::file_size(path));
    state.SetBytesProcessed(state.iterations() * bytes);
    state.SetItemsProcessed(state.iterations() * 2 * n * n);
    state.counters["peak_rss_MB"] = double(i2b::peakResidentBytes()) / 1e6;
    std::filesystem::remove(path);
}

BENCHMARK_CAPTURE(readStl, binary, i2b::StlFormat::binary, false)
    ->Arg(500)
    ->Arg(1500)
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(readStl, binary_random_order, i2b::StlFormat::binary, true)
    ->Arg(1500)
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(readStl, ascii, i2b::StlFormat::ascii, false)
    ->Arg(500)
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

} // namespace
