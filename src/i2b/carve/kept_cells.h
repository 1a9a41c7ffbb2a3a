// The cells that become the mesh: painted, far enough from the wall or inside a narrow passage, with a front that prisms can be extruded from.
#pragma once
#include "i2b/grid/cell_grid.h"
#include "i2b/paint/regions.h"
#include <cstdint>
#include <string>
#include <vector>

namespace i2b {

struct KeptCells {
    std::vector<Mask::Ptr> levels;                 // by level, all kept cells
    std::vector<std::string> zoneNames;            // one per painted region; a single one needs no cellZone
    std::vector<std::vector<Mask::Ptr>> zones;     // [zone][level]: empty where there is one zone only
    std::vector<Region> leftOut;                   // parts of painted regions behind openings too narrow for cells, but for the smallest
    std::uint64_t carvedForClearance = 0, givenInPassages = 0, carvedForFront = 0, droppedIslands = 0; // cells

    std::uint64_t cellCount() const;
    std::uint64_t checksum() const;
};

} // namespace i2b
