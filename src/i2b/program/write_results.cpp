#include "i2b/program/write_results.h"
#include "i2b/core/give_up.h"
#include "i2b/program/print.h"
#include "i2b/core/memory.h"
#include "i2b/quality/cell_quality.h"
#include "i2b/write/atomic_folder.h"
#include "i2b/write/foam_write.h"
#include "i2b/write/leaks_write.h"
#include "i2b/write/ply_write.h"
#include "i2b/write/report_write.h"
#include "i2b/write/vdb_write.h"
#include "i2b/write/vtu_write.h"
#include <filesystem>
#include <fmt/format.h>

namespace i2b {
namespace {

// What the layers came to, on the cells at the wall.
std::vector<CellData> layerData(const WallLayers& walls) {
    const auto data = [&](const char* name, const auto& values) {
        CellData d{name, std::vector<float>(values.size()), &walls.wallCell};
        std::transform(values.begin(), values.end(), d.values.begin(), [](auto v) { return static_cast<float>(v); });
        return d;
    };
    return {data("layersAsked", walls.asked), data("layersAchieved", walls.achieved), data("layerCause", walls.cause),
            data("firstLayerHeight", walls.first), data("layerThickness", walls.thickness)};
}

void writeMeshFiles(MeshResult& result, const OutputOptions& output, AtomicFolder& folder,
                    Context& context) {
    const PolyMesh& mesh = result.mesh;
    Stage stage(context, "write");
    stage.items = static_cast<std::uint64_t>(mesh.cells);
    if (output.wants("openfoam")) {
        FoamWriteOptions options;
        options.ascii = output.ascii;
        options.note = "i2b " I2B_VERSION;
        writeFoam(mesh, folder, options, context);
    }
    static_assert(sizeof(OffCause) == 1);
    const std::vector<float> off(result.wallNodes.distanceInH.begin(), result.wallNodes.distanceInH.end());
    const auto* const causes = reinterpret_cast<const std::uint8_t*>(result.offCauses.data());
    const std::vector<PointData> values{{"off_geometry", result.wallNodes.points, std::span<const float>(off)},
                                        {"off_cause", result.wallNodes.points, std::span(causes, result.offCauses.size())}};
    if (output.wants("vtu")) {
        CellQuality& q = result.cells.quality;
        std::vector<CellData> data = layerData(result.walls);
        data.push_back({"nonOrthogonality", std::move(q.nonOrthogonality)});
        data.push_back({"skewness", std::move(q.skewness)});
        data.push_back({"volume", std::move(q.volume)});
        writeVtu(mesh, result.cells.faces, data, folder.place("mesh.vtu"), {}, context, values);
    }
    if (output.wants("ply")) writePly(mesh, folder.place("wall.ply"), context, {}, values);
}

void writeGridFile(const GridResult& result, const RunReport& report, const Options& options, AtomicFolder& folder,
                   Context& context) {
    if (!options.output.wants("vdb")) return;
    Stage stage(context, "write grid");
    stage.items = result.grid.cellCount();
    const bool carved = !result.kept.levels.empty();
    const VdbInput input{result.grid, &result.cut, &result.regions, carved ? &result.kept : nullptr,
                         [&](const Vec3& p, double reach) { return result.index->closest(p, reach).distance; }};
    VdbWriteOptions vdb;
    vdb.caseName = std::filesystem::path(options.output.folder).filename().string();
    vdb.version = I2B_VERSION;
    vdb.surfaceSize = options.size.surface;
    vdb.minSize = result.field.minSize;
    vdb.maxSize = result.field.lattice.h(0);
    for (const Region& region : result.regions.table)
        vdb.texts.emplace_back(fmt::format("region{}", region.id), regionRecord(region, report.parts));
    writeVdb(input, folder.place("grid.vdb"), vdb, context);
}

void writeLeaksFile(const GridResult& result, const OutputOptions& output, AtomicFolder& folder) {
    if (output.wants("ply") && !result.regions.leaks.empty()) writeLeaks(result.regions.leaks, folder.place("leaks.ply"));
}

void writeReportFile(RunReport& report, const OutputOptions& output, AtomicFolder& folder,
                     const CompleteReport& complete) {
    complete(report);
    if (output.wants("report")) writeReport(report, folder.place("report.json"));
}

} // namespace

void writeMeshResults(MeshResult& result, const Options& options, Context& context,
                      const CompleteReport& complete) {
    AtomicFolder folder(options.output.folder);
    writeMeshFiles(result, options.output, folder, context);
    result.mesh = {}, result.cells = {}, result.walls = {}, result.wallNodes = {}, giveUp(result.offCauses); // on the disk by now
    returnFreedMemory();
    writeGridFile(*result.cartesian, result.report, options, folder, context);
    writeLeaksFile(*result.cartesian, options.output, folder);
    writeReportFile(result.report, options.output, folder, complete);
    context.checkCancelled();
    folder.commit();
}

void writeGridResults(const GridResult& result, RunReport& report, const Options& options, Context& context,
                      const CompleteReport& complete) {
    AtomicFolder folder(options.output.folder);
    writeGridFile(result, report, options, folder, context);
    writeLeaksFile(result, options.output, folder);
    writeReportFile(report, options.output, folder, complete);
    context.checkCancelled();
    folder.commit();
}

} // namespace i2b
