// The whole road, from options to a mesh in memory: reads as the table of stages. Files are read by the
// geometry stage; nothing is written and nothing printed here.
#pragma once
#include "i2b/assemble/poly_mesh.h"
#include "i2b/carve/kept_cells.h"
#include "i2b/core/context.h"
#include "i2b/geometry/feature_lines.h"
#include "i2b/geometry/read.h"
#include "i2b/geometry/surface_index.h"
#include "i2b/layers/layer_report.h"
#include "i2b/options.h"
#include "i2b/paint/regions.h"
#include "i2b/quality/cell_quality.h"
#include "i2b/sizing/size_field.h"
#include "i2b/write/report.h"
#include <memory>

namespace i2b {

struct GridResult {
    Surface surface;
    FeatureLines featureLines;           // of files; read with the surface, so that what is wrong there shows early
    GeometryNotes notes;
    std::unique_ptr<SurfaceIndex> index; // of surface; do not move the surface away
    SizeField field;
    CellGrid grid;
    CutCells cut;
    Regions regions;
    KeptCells kept; // empty levels where carving was not asked for

    std::vector<std::string> allNotes() const; // of geometry and sizes
};

struct MeshResult {
    std::unique_ptr<GridResult> cartesian;
    PolyMesh mesh;
    WallLayers walls; // wallCell: of the mesh
    CellFigures cells;              // of the mesh, where a file asks for them (vtu); else empty
    WallNodes wallNodes;            // how far each is off the geometry
    std::vector<OffCause> offCauses; // and why; as wallNodes.points
    RunReport report; // all but the total time and memory, which the caller knows at its end
};

// How far the Cartesian stages go: `regions` chooses but carves nothing; `mesh` makes room for the rest of a mesh.
enum class Road : std::uint8_t { regions, grid, mesh };

std::unique_ptr<GridResult> generateGrid(const Options& options, Context& context, Road road);

// The whole mesh: valid (PolyMesh::validate() is empty, no cell of negative volume, no face of wrong
// orientation) or an Error that says what, where and what to do.
MeshResult generate(const Options& options, Context& context);

// What a run of the Cartesian stages alone can report.
RunReport reportOf(const GridResult& result, const Options& options, const Context& context);

} // namespace i2b
