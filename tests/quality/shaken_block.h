// A cube of hexahedra whose points are shaken: a mesh of every kind of fault.
#pragma once
#include "quality/cell_mesh.h"
#include <random>

namespace i2b::test {

// edge: cells; shake: of a cell's edge, at most, along each axis.
inline PolyMesh shakenBlock(int edge, double shake, std::mt19937& random) {
    std::uniform_real_distribution<double> off(-shake, shake);
    std::vector<Vec3> points;
    std::vector<CellLoops> cells;
    const auto at = [&](int x, int y, int z) { return (x * (edge + 1) + y) * (edge + 1) + z; };
    for (int x = 0; x <= edge; ++x)
        for (int y = 0; y <= edge; ++y)
            for (int z = 0; z <= edge; ++z) points.push_back({x + off(random), y + off(random), z + off(random)});
    for (int x = 0; x < edge; ++x)
        for (int y = 0; y < edge; ++y)
            for (int z = 0; z < edge; ++z)
                cells.push_back(hexLoops({at(x, y, z), at(x + 1, y, z), at(x + 1, y + 1, z), at(x, y + 1, z), at(x, y, z + 1),
                                          at(x + 1, y, z + 1), at(x + 1, y + 1, z + 1), at(x, y + 1, z + 1)}));
    return meshOfCells(std::move(points), cells);
}

} // namespace i2b::test
