// i2b mesh, grid and regions: run the stages, write what was asked for, say what came of it.
#include "i2b/core/memory.h"
#include "i2b/program/generate.h"
#include "i2b/program/print.h"
#include "i2b/program/runs.h"
#include "i2b/program/write_results.h"
#include "i2b/write/atomic_folder.h"
#include <chrono>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <tbb/global_control.h>

namespace i2b {
namespace {

using Clock = std::chrono::steady_clock;

void completeReport(RunReport& report, const Run& run, Clock::time_point start) {
    report.programVersion = I2B_VERSION;
    report.threads =
        static_cast<int>(tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism));
    report.stages = run.context.stages();
    report.peakRssBytes = peakResidentBytes();
    report.seconds = std::chrono::duration<double>(Clock::now() - start).count();
}

void printNotes(const GridResult& result, const Run& run) {
    if (run.quiet) return;
    for (const std::string& message : result.allNotes()) fmt::print(run.out, "note: {}\n", message);
}

void printEnd(const RunReport& report, const OutputOptions& output, const Run& run) {
    if (run.quiet) return;
    fmt::print(run.out, "{}written to {}: {}\n", summaryText(report), output.folder,
               fmt::join(output.formats, ", "));
}

} // namespace

int runMesh(const CommandLine& line, Run& run) {
    const Clock::time_point start = Clock::now();
    const Options& options = line.given.options;
    checkWritable(options.output.folder);
    MeshResult result = generate(options, run.context);
    printNotes(*result.cartesian, run);
    writeMeshResults(result, options, run.context,
                     [&](RunReport& report) { completeReport(report, run, start); });
    printEnd(result.report, options.output, run);
    return 0;
}

int runGrid(const CommandLine& line, Run& run) {
    const Clock::time_point start = Clock::now();
    const Options& options = line.given.options;
    checkWritable(options.output.folder);
    const auto result = generateGrid(options, run.context, Road::grid);
    printNotes(*result, run);
    RunReport report = reportOf(*result, options, run.context);
    writeGridResults(*result, report, options, run.context,
                     [&](RunReport& r) { completeReport(r, run, start); });
    if (!run.quiet)
        fmt::print(run.out, "{} cells, {} kept, in {:.1f} s and {:.0f} MB\nwritten to {}\n",
                   result->grid.cellCount(), result->kept.cellCount(), report.seconds,
                   static_cast<double>(report.peakRssBytes) * 1e-6, options.output.folder);
    return 0;
}

// A look first: files only where the command line itself names a place for them.
int runRegions(const CommandLine& line, Run& run) {
    const Clock::time_point start = Clock::now();
    const Options& options = line.given.options;
    if (line.outGiven) checkWritable(options.output.folder);
    const auto result = generateGrid(options, run.context, Road::regions);
    printNotes(*result, run);
    RunReport report = reportOf(*result, options, run.context);
    fmt::print(run.out, "{}", regionsText(result->regions, report.parts));
    if (!line.outGiven) return 0;
    writeGridResults(*result, report, options, run.context,
                     [&](RunReport& r) { completeReport(r, run, start); });
    if (!run.quiet) fmt::print(run.out, "written to {}\n", options.output.folder);
    return 0;
}

} // namespace i2b
