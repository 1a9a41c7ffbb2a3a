// What carved cells must fulfil, looked up in a plain array of the finest cells and not by the stage's own
// means.
#pragma once
#include "i2b/carve/kept_cells.h"
#include "i2b/geometry/surface_index.h"
#include "paint/random_grid.h"
#include "pipeline/random_case.h"
#include <memory>
#include <string>

namespace i2b::test {

// "" or the first fault: a fan without direction, an edge that comes apart in two ways, more than one
// face-connected piece a zone.
std::string frontFault(const CellGrid& grid, const KeptCells& kept);

// Least distance of kept cells' vertices to the geometry, in edges of the finest cell around the vertex.
double leastClearance(const CellGrid& grid, const KeptCells& kept, const SurfaceIndex& index);

// "" or the first kept cut cell nearer than RoomOptions::least to the geometry, or with geometry between its centre and that of a kept
// cell that it shares a face with.
std::string wallBetweenKept(const CellGrid& grid, const CutCells& cut, const KeptCells& kept, const SurfaceIndex& index);

// "" or where cells that no geometry meets are missing amid kept ones: a wall without a cause.
std::string voidInFlow(const CellGrid& grid, const CutCells& cut, const Regions& regions, const KeptCells& kept);

// The Cartesian stages up to paint.
struct Painted {
    explicit Painted(const RandomCase& c);
    Surface soup;
    std::unique_ptr<SurfaceIndex> index;
    SizeField field;
    CellGrid grid;
    CutCells cut;
    Regions regions;
};

// Random walls instead of a geometry, the largest region kept and carved; the geometry is one triangle far
// away.
struct CarvedAtRandom {
    CarvedAtRandom(unsigned seed, const Index3& count, int levels, int buffer, double closed, bool perAxis = false);
    Surface far;
    std::unique_ptr<SurfaceIndex> index;
    CellGrid grid;
    Regions regions;
    KeptCells kept;
};

} // namespace i2b::test
