// i2b check: quality of any polyMesh, and how well its walls fit a geometry.
#include "i2b/geometry/features.h"
#include "i2b/geometry/read.h"
#include "i2b/geometry/rims.h"
#include "i2b/geometry/surface_index.h"
#include "i2b/program/print.h"
#include "i2b/program/runs.h"
#include "i2b/quality/cell_quality.h"
#include "i2b/quality/fit_report.h"
#include "i2b/quality/patch_names.h"
#include "i2b/quality/quality_report.h"
#include "i2b/write/foam_read.h"
#include <fmt/format.h>

namespace i2b {
namespace {

FitReport fitTo(const PolyMesh& mesh, const Rows& cellFaces, const GeometryOptions& geometry, const std::vector<std::string>& patches,
                Run& run) {
    GeometryNotes notes;
    Surface surface;
    FeatureLines lines;
    {
        Stage stage(run.context, "read");
        lines = readFeatureLines(geometry.featureLines, geometry.scale, notes.messages);
        surface = readSurface(geometry.files, geometry.scale, notes);
        stage.items = surface.triangles.size();
    }
    Stage stage(run.context, "fit");
    const SurfaceIndex index(surface);
    const FeatureOptions options = featureOptions(geometry, lines);
    FeatureGraph features = buildFeatureGraph(surface, options);
    for (const std::string& note : features.notes) fmt::print(run.out, "note: {}\n", note);
    markRims(features, index, options);
    FitReport fit = measureFit(mesh, cellFaces, index, features, patches);
    measurePartBorders(mesh, cellFaces, index, patches, fit);
    stage.items = static_cast<std::uint64_t>(fit.wallFaces);
    return fit;
}

} // namespace

int runCheck(const CommandLine& line, Run& run) {
    PolyMesh mesh;
    {
        Stage stage(run.context, "read mesh");
        mesh = readFoam(line.caseFolder);
        stage.items = static_cast<std::uint64_t>(mesh.cells);
    }
    const std::vector<std::string> patches = patchesNamed(mesh.patches, line.patches); // complains before the work
    const bool hasGeometry = !line.given.options.geometry.files.empty();
    CellFigures cells{.wantsQuality = false}; // where the fit is asked for
    QualityReport quality;
    {
        Stage stage(run.context, "quality");
        quality = measureQuality(mesh, {}, line.given.options.quality, hasGeometry ? &cells : nullptr);
        stage.items = static_cast<std::uint64_t>(mesh.cells);
    }
    fmt::print(run.out, "{}", formatQuality(quality));
    if (hasGeometry)
        fmt::print(run.out, "\n{}", fitText(fitTo(mesh, cells.faces, line.given.options.geometry, patches, run)));
    return quality.ok() ? 0 : 1;
}

} // namespace i2b
