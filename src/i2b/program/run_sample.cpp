// i2b sample: the built-in geometries as files.
#include "i2b/core/error.h"
#include "i2b/geometry/write_stl.h"
#include "i2b/program/runs.h"
#include "i2b/samples/sample.h"
#include <filesystem>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace i2b {

int runSample(const CommandLine& line, Run& run) {
    if (line.sample.empty()) {
        for (const std::string& name : sampleNames()) fmt::print(run.out, "{}\n", name);
        return 0;
    }
    const Surface surface = makeSample(line.sample, {line.dirt, line.resolution});
    if (line.sampleFile.empty())
        throw Error(ErrorKind::usage, "no file is named", "command line",
                    fmt::format("write i2b sample {} -o {}.stl", line.sample, line.sample));
    const bool oneFile = std::filesystem::path(line.sampleFile).extension() == ".stl";
    // ASCII keeps the parts and every digit.
    if (oneFile)
        writeStl(surface, line.sampleFile, StlFormat::ascii);
    else
        writeStlFolder(surface, line.sampleFile, StlFormat::ascii);
    if (!run.quiet)
        fmt::print(run.out, "{}: {} triangles in {} parts\n", line.sampleFile, surface.triangles.size(),
                   surface.parts.size());
    return 0;
}

} // namespace i2b
