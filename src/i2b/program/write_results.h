// The files of a run, written under their final names only when all are complete.
#pragma once
#include "i2b/core/context.h"
#include "i2b/options.h"
#include "i2b/program/generate.h"
#include "i2b/write/report.h"
#include <functional>

namespace i2b {

// Called after everything but the report is written, to fill in the times and the memory of the whole run.
using CompleteReport = std::function<void(RunReport&)>;

// Those of options.output.formats, into options.output.folder. Throws Error (input) where that cannot be,
// Cancelled.
void writeMeshResults(MeshResult& result, const Options& options, Context& context,
                      const CompleteReport& complete);
// grid.vdb, leaks.ply where there are any, and the report.
void writeGridResults(const GridResult& result, RunReport& report, const Options& options, Context& context,
                      const CompleteReport& complete);

} // namespace i2b
