// The commands, one function each: from a parsed command line to printed lines, files and an exit status.
#pragma once
#include "i2b/core/context.h"
#include "i2b/program/command_line.h"
#include <cstdio>

namespace i2b {

struct Run {
    Context& context;
    std::FILE* out; // for results
    bool quiet;     // nothing but what was asked for
};

int runMesh(const CommandLine& line, Run& run);
int runGrid(const CommandLine& line, Run& run);
int runRegions(const CommandLine& line, Run& run);
int runInspect(const CommandLine& line, Run& run);
int runCheck(const CommandLine& line, Run& run);
int runSample(const CommandLine& line, Run& run);

} // namespace i2b
