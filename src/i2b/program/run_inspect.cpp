// i2b inspect: what a geometry holds, before anything is meshed.
#include "i2b/geometry/features.h"
#include "i2b/geometry/inspect.h"
#include "i2b/geometry/read.h"
#include "i2b/program/runs.h"
#include <fmt/format.h>

namespace i2b {

int runInspect(const CommandLine& line, Run& run) {
    const GeometryOptions& options = line.given.options.geometry;
    GeometryNotes notes;
    Surface surface;
    FeatureLines lines;
    {
        Stage stage(run.context, "read");
        lines = readFeatureLines(options.featureLines, options.scale, notes.messages);
        surface = readSurface(options.files, options.scale, notes);
        stage.items = surface.triangles.size();
    }
    FeatureGraph features;
    {
        Stage stage(run.context, "features");
        features = buildFeatureGraph(surface, featureOptions(options, lines));
        stage.items = features.edges.size();
    }
    fmt::print(run.out, "{}", format(inspect(surface, features)));
    for (const auto* const list : {&notes.messages, &features.notes})
        for (const std::string& message : *list) fmt::print(run.out, "note: {}\n", message);
    return 0;
}

} // namespace i2b
