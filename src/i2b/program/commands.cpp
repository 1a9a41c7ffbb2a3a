#include "i2b/program/commands.h"
#include "i2b/core/context.h"
#include "i2b/core/error.h"
#include "i2b/program/case_file.h"
#include "i2b/program/command_line.h"
#include "i2b/program/options.h"
#include "i2b/program/progress.h"
#include "i2b/program/runs.h"
#include <fmt/format.h>
#include <new>
#include <tbb/global_control.h>
#include <tbb/info.h>

namespace i2b {
namespace {

// inspect and check look at their own few options only.
void requireValidShared(const CommandLine& line) {
    CommandLine copy = line;
    Options& options = copy.given.options;
    if (options.geometry.files.empty()) options.geometry.files = {"none needed"};
    options.size.surface = 1;
    requireValid(copy.given);
}

int dispatch(const CommandLine& line, Run& run) {
    switch (line.command) {
    case Command::help:
        return fmt::print(run.out, "{}", line.text), 0;
    case Command::mesh:
        return runMesh(line, run);
    case Command::grid:
        return runGrid(line, run);
    case Command::regions:
        return runRegions(line, run);
    case Command::inspect:
        return runInspect(line, run);
    case Command::check:
        return runCheck(line, run);
    case Command::sample:
        return runSample(line, run);
    }
    return 3;
}

int runParsed(const CommandLine& line, std::FILE* out, std::FILE* err) {
    const bool mesher =
        line.command == Command::mesh || line.command == Command::grid || line.command == Command::regions;
    if (mesher && line.writeCase) return fmt::print(out, "{}", formatCase(line.given)), 0;
    if (mesher)
        requireValid(line.given);
    else
        requireValidShared(line);

    const int threads = line.given.options.threads;
    const tbb::global_control limit(
        tbb::global_control::max_allowed_parallelism,
        static_cast<std::size_t>(threads > 0 ? threads : tbb::info::default_concurrency()));
    Progress progress(err, progressStyle(err, line.given.quiet));
    Context context([&](const ProgressEvent& event) { progress.show(event); });
    const InterruptGuard guard(context);
    Run run{context, out, line.given.quiet};
    return dispatch(line, run);
}

} // namespace

int runProgram(const std::vector<std::string>& arguments, std::FILE* out, std::FILE* err) {
    try {
        return runParsed(parseCommandLine(arguments), out, err);
    } catch (const Cancelled&) {
        fmt::print(err, "i2b: interrupted; nothing was written\n");
        return 130;
    } catch (const Error& error) {
        fmt::print(err, "i2b: {}\n", error.what());
        return error.exitStatus();
    } catch (const std::bad_alloc&) {
        fmt::print(err, "i2b: out of memory: give a larger size, or a smaller box\n");
        return 1;
    } catch (const std::exception& fault) {
        fmt::print(err, "i2b: internal fault: {}\n", fault.what());
        return 3;
    }
}

} // namespace i2b
