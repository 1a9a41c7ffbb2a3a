#include "i2b/program/write_results.h"
#include "i2b/write/atomic_folder.h"
#include "i2b/write/foam_write.h"
#include "i2b/write/ply_write.h"
#include "i2b/write/report_write.h"
#include "i2b/write/vtu_write.h"
#include <algorithm>

namespace i2b {
namespace {

bool wants(const OutputOptions& output, const char* format) {
    return std::ranges::find(output.formats, format) != output.formats.end();
}

void writeMeshFiles(const PolyMesh& mesh, const OutputOptions& output, AtomicFolder& folder,
                    Context& context) {
    Stage stage(context, "write");
    stage.items = static_cast<std::uint64_t>(mesh.cells);
    if (wants(output, "openfoam")) {
        FoamWriteOptions options;
        options.ascii = output.ascii;
        options.note = "i2b " I2B_VERSION;
        writeFoam(mesh, folder, options, context);
    }
    if (wants(output, "vtu")) writeVtu(mesh, {}, folder.place("mesh.vtu"), {}, context);
    if (wants(output, "ply")) writePly(mesh, folder.place("wall.ply"), context);
}

void writeReportFile(RunReport& report, const OutputOptions& output, AtomicFolder& folder,
                     const CompleteReport& complete) {
    complete(report);
    if (wants(output, "report")) writeReport(report, folder.place("report.json"));
}

} // namespace

void writeMeshResults(MeshResult& result, const Options& options, Context& context,
                      const CompleteReport& complete) {
    AtomicFolder folder(options.output.folder);
    writeMeshFiles(result.mesh, options.output, folder, context);
    writeReportFile(result.report, options.output, folder, complete);
    context.checkCancelled();
    folder.commit();
}

void writeGridResults(const GridResult&, RunReport& report, const Options& options, Context& context,
                      const CompleteReport& complete) {
    AtomicFolder folder(options.output.folder);
    writeReportFile(report, options.output, folder, complete);
    context.checkCancelled();
    folder.commit();
}

} // namespace i2b
