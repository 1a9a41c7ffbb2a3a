// grid.vdb: what the grid stages found, for Houdini, Blender (3.4 and later: float and bool grids) and
// pyopenvdb.
//
//   level     float  level of the leaf cell, -1 outside the domain         \  on the finest lattice; large cells
//   region    float  number of its region, -1 where it has none             | are tiles
//   cut       bool   cells that the geometry meets                          |
//   kept      bool   cells of the mesh                                     /
//   surface   float  level set of the geometry, m, positive in the fluid   \  on the lattice of vdb_band.h's level
//   distance  float  distance to the geometry in the fluid near it, m      /
//   cells_L<level>         bool  leaf cells of one level, with its own transform
//   cells_L<x>_<y>_<z>     bool  the same where the axes' levels differ
//
// Index (i, j, k) is the centre of the cell (i, j, k). Metadata of the file: program, version, case,
// size_surface, size_min, size_max (m), levels. Blosc-compressed. The file is the same on any number of
// threads: even its UUID comes from what is in it.
#pragma once
#include "i2b/carve/kept_cells.h"
#include "i2b/core/context.h"
#include "i2b/grid/cell_grid.h"
#include "i2b/paint/regions.h"
#include "i2b/write/vdb_band.h"
#include <filesystem>
#include <string>

namespace i2b {

// What is absent gives no grid. Nothing is kept after the call.
struct VdbInput {
    const CellGrid& grid;
    const CutCells* cut = nullptr;
    const Regions* regions = nullptr;
    const KeptCells* kept = nullptr;
    DistanceFunction distance; // for surface and distance; empty: neither is written
};

struct VdbWriteOptions {
    std::string caseName, version;
    double surfaceSize = 0, minSize = 0, maxSize = 0; // m
    int halfWidth = 3;                                // voxels of the band of `surface` on each side
    int bandLevel = -1; // level of its lattice; -1: the one most of the cut cells have, or a coarser one for room
    std::vector<std::pair<std::string, std::string>> texts = {}; // further metadata of the file: name, text
    bool values = true; // false: the cells_L masks alone
    std::uint64_t mostBandCells = 1'000'000;  // of the geometry on that lattice
    std::uint64_t mostValueCells = 50'000'000; // of a grid that level, region, cut and kept are written for
};

// Grids are made and written one after the other, so that no two are in memory but the one being written and the next.
// Of a larger grid, or where a level's axes differ, there are masks by level in place of level, region, cut and kept:
// painted_L<level> (cells of painted regions), cut_L<level> and kept_L<level>, bits a cell; the file's metadata then
// say why under "masks". Throws Error{input} (unwritable, disk full) and
// Cancelled.
void writeVdb(const VdbInput& input, const std::filesystem::path& path, const VdbWriteOptions& options,
              const Context& context);

} // namespace i2b
