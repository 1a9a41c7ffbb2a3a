// Everything a run has to tell about itself, as values; report_write.h turns it into report.json.
#pragma once
#include "i2b/core/context.h"
#include "i2b/edit/last_resort.h"
#include "i2b/layers/layer_report.h"
#include "i2b/paint/regions.h"
#include "i2b/quality/fit_report.h"
#include "i2b/quality/off_places.h"
#include "i2b/quality/quality_report.h"
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace i2b {

struct ReportPart {
    std::string name;
    std::uint64_t triangles = 0;
};

struct RunReport {
    std::string programName = "i2b", programVersion;
    std::vector<std::string> files; // of the geometry, as given
    std::uint64_t triangles = 0;
    std::vector<ReportPart> parts;
    int threads = 0;
    double surfaceSize = 0, minSize = 0, maxSize = 0; // m, cells as built
    int levels = 0;                                   // of refinement, coarsest to finest
    double seconds = 0;                               // wall clock of the whole run
    std::uint64_t peakRssBytes = 0;
    std::vector<StageRecord> stages;
    std::int64_t cells = 0, faces = 0, points = 0, wallFaces = 0;
    // Absent where the run stopped before: written as null.
    std::optional<QualityReport> quality;
    std::optional<FitReport> fit;
    std::optional<OffGeometry> offGeometry; // only beside fit
    MeshChanges changes;                    // where no node could be moved to mend the mesh
    bool fitCutShort = false;               // by its budget of time: another run may give another mesh
    std::optional<LayerReport> layers;
    std::vector<Patch> patches;
    std::vector<Region> regions;
    std::vector<Leak> leaks;
    std::vector<std::string> notes; // what was done otherwise than the input says, and why
    std::string checksum; // of the mesh, 16 hexadecimal digits
};

} // namespace i2b
