// What paint reaches: every face-connected set of cells that the geometry does not meet is a region.
#pragma once
#include "i2b/core/vec.h"
#include "i2b/grid/cell_grid.h"
#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace i2b {

struct Region {
    std::int32_t id = 0;               // index in Regions::table, by first cell in lattice order
    std::string name;                  // of the zone, from a named seed; else "region<id>"
    std::uint64_t cells = 0;
    double volume = 0;                 // m^3
    Box box;                           // m
    bool touchesDomainBox = false;
    bool painted = false;              // chosen for the mesh
    std::vector<std::int32_t> parts;   // that cut cells beside it belong to, ascending
    Vec3 seed;                         // m, centre of its largest, then first cell: a place to paint from
};

// One tree node's cells of one region: bits per cell, whatever the number of regions.
struct RegionPiece {
    std::array<std::int32_t, 3> origin{}; // of the 8x8x8 node, level coordinates
    std::array<std::uint64_t, 8> mask{};  // OpenVDB's leaf order: word x, bit y * 8 + z
    std::int32_t region = 0;
};

// An opening between places that someone holds to be apart.
struct Leak {
    Vec3 place;             // m, its widest
    double width = 0;       // m, of the largest ball that goes through there
    std::string text;       // between what, and which part is beside it
    double area = 0;        // m^2, of cells in it as seen along the way through: what is within a cell of its rim is left out; 0: no opening, all is open
    Box box;                // m
    std::int32_t part = -1; // nearest to its widest place
    std::int32_t pair = 0;  // of places: those between the same two follow each other, the widest first
    bool keepOut = false;   // leads to a place that the flow must not reach:
    Vec3 beyond;            // m, where it is widest around that, or around the second seed
    std::vector<std::array<Vec3, 4>> faces{}; // m, corners of the cells' faces in the opening, their normals towards what is beyond
};

struct Regions {
    std::vector<Region> table;
    std::vector<std::vector<RegionPiece>> pieces; // by level, in lattice order of nodes, then first cell
    std::vector<Leak> leaks;

    // Cells of one region, by level.
    std::vector<Mask::Ptr> cellsOf(std::int32_t region) const;
    std::uint64_t checksum() const;
};

} // namespace i2b
