// Meshes made by hand, cell by cell: each cell is a list of faces, each a loop of points seen from outside in
// counter-clockwise order. Faces that two cells share become internal; the order is upper triangular.
#pragma once
#include "i2b/assemble/poly_mesh.h"
#include <algorithm>
#include <array>
#include <map>
#include <vector>

namespace i2b::test {

using Loop = std::vector<std::int32_t>;
using CellLoops = std::vector<Loop>;

inline PolyMesh meshOfCells(std::vector<Vec3> points, const std::vector<CellLoops>& cells) {
    struct Side {
        std::int32_t cell;
        Loop loop;
    };
    std::map<Loop, std::vector<Side>> faces; // by sorted points
    for (std::size_t c = 0; c < cells.size(); ++c)
        for (const Loop& loop : cells[c]) {
            Loop key = loop;
            std::sort(key.begin(), key.end());
            faces[key].push_back({static_cast<std::int32_t>(c), loop});
        }
    PolyMesh mesh;
    mesh.points.assign(points.begin(), points.end());
    mesh.cells = static_cast<std::int32_t>(cells.size());
    mesh.faceOffsets.push_back(0);
    const auto add = [&](const Side& side) {
        mesh.faceVertices.insert(mesh.faceVertices.end(), side.loop.begin(), side.loop.end());
        mesh.faceOffsets.push_back(static_cast<std::uint32_t>(mesh.faceVertices.size()));
        mesh.owner.push_back(side.cell);
    };
    std::vector<std::pair<std::array<std::int32_t, 2>, const Side*>> internal;
    for (const auto& [key, sides] : faces)
        if (sides.size() == 2) internal.push_back({{sides[0].cell, sides[1].cell}, &sides[0]});
    std::sort(internal.begin(), internal.end());
    for (const auto& [ends, side] : internal) {
        add(*side);
        mesh.neighbour.push_back(ends[1]);
    }
    mesh.patches.push_back({"wall", "wall", mesh.faces(), 0});
    for (const auto& [key, sides] : faces)
        if (sides.size() == 1) add(sides[0]);
    mesh.patches.back().count = mesh.faces() - mesh.patches.back().start;
    return mesh;
}

// Corners in OpenFOAM's order: 0-3 counter-clockwise seen from above, 4-7 above them.
inline CellLoops hexLoops(const std::array<std::int32_t, 8>& p) {
    return {{p[0], p[3], p[2], p[1]}, {p[4], p[5], p[6], p[7]}, {p[0], p[1], p[5], p[4]},
            {p[1], p[2], p[6], p[5]}, {p[2], p[3], p[7], p[6]}, {p[3], p[0], p[4], p[7]}};
}

inline std::array<std::int32_t, 8> corners(std::int32_t first) {
    std::array<std::int32_t, 8> p{};
    for (std::int32_t i = 0; i < 8; ++i) p[static_cast<std::size_t>(i)] = first + i;
    return p;
}

inline std::vector<Vec3> boxPoints(const Vec3& lo, const Vec3& hi) {
    return {{lo.x, lo.y, lo.z}, {hi.x, lo.y, lo.z}, {hi.x, hi.y, lo.z}, {lo.x, hi.y, lo.z},
            {lo.x, lo.y, hi.z}, {hi.x, lo.y, hi.z}, {hi.x, hi.y, hi.z}, {lo.x, hi.y, hi.z}};
}

// Hexahedra on top of each other: levels of four corners each.
inline PolyMesh columnOf(const std::vector<std::array<Vec3, 4>>& levels) {
    std::vector<Vec3> points;
    for (const auto& level : levels) points.insert(points.end(), level.begin(), level.end());
    std::vector<CellLoops> cells;
    for (std::size_t i = 0; i + 1 < levels.size(); ++i)
        cells.push_back(hexLoops(corners(static_cast<std::int32_t>(4 * i))));
    return meshOfCells(std::move(points), cells);
}

inline std::array<Vec3, 4> square(double z, const Vec3& shift = {}) {
    return {Vec3{0, 0, z} + shift, Vec3{1, 0, z} + shift, Vec3{1, 1, z} + shift, Vec3{0, 1, z} + shift};
}

// A cube of edge 2 beside four of edge 1, as at a jump in level: the large one has nine faces.
inline PolyMesh levelJump() {
    std::vector<Vec3> points = boxPoints({0, 0, 0}, {2, 2, 2}); // 0-7
    // Plane x = 2 as a 3 x 3 lattice (j, k), corners from the large cube; then the same at x = 3.
    std::int32_t near[3][3], far[3][3];
    for (int k = 0; k < 3; ++k)
        for (int j = 0; j < 3; ++j) {
            const bool corner = j != 1 && k != 1;
            near[j][k] = corner ? (k == 0 ? (j == 0 ? 1 : 2) : (j == 0 ? 5 : 6))
                                : static_cast<std::int32_t>(points.size());
            if (!corner) points.push_back({2, double(j), double(k)});
        }
    for (int k = 0; k < 3; ++k)
        for (int j = 0; j < 3; ++j) {
            far[j][k] = static_cast<std::int32_t>(points.size());
            points.push_back({3, double(j), double(k)});
        }
    CellLoops large{{0, 3, 2, near[1][0], 1},
                    {4, 5, near[1][2], 6, 7},
                    {0, 1, near[0][1], 5, 4},
                    {2, 3, 7, 6, near[2][1]},
                    {3, 0, 4, 7}};
    std::vector<CellLoops> small;
    for (int k = 0; k < 2; ++k)
        for (int j = 0; j < 2; ++j) {
            large.push_back({near[j][k], near[j + 1][k], near[j + 1][k + 1], near[j][k + 1]});
            small.push_back(hexLoops({near[j][k], far[j][k], far[j + 1][k], near[j + 1][k], near[j][k + 1],
                                      far[j][k + 1], far[j + 1][k + 1], near[j + 1][k + 1]}));
        }
    std::vector<CellLoops> cells{large};
    cells.insert(cells.end(), small.begin(), small.end());
    return meshOfCells(std::move(points), cells);
}

// Two cubes that have one corner in common, point 6.
inline PolyMesh cubesAtCorner() {
    std::vector<Vec3> points = boxPoints({0, 0, 0}, {1, 1, 1});
    const std::vector<Vec3> second = boxPoints({1, 1, 1}, {2, 2, 2});
    points.insert(points.end(), second.begin() + 1, second.end());
    return meshOfCells(std::move(points), {hexLoops(corners(0)), hexLoops({6, 8, 9, 10, 11, 12, 13, 14})});
}

// Two cubes that have one edge in common, from point 2 to point 6.
inline PolyMesh cubesAtEdge() {
    std::vector<Vec3> points = boxPoints({0, 0, 0}, {1, 1, 1});
    const std::vector<Vec3> second = boxPoints({1, 1, 0}, {2, 2, 1});
    for (const std::size_t i : {1, 2, 3, 5, 6, 7}) points.push_back(second[i]);
    return meshOfCells(std::move(points), {hexLoops(corners(0)), hexLoops({2, 8, 9, 10, 6, 11, 12, 13})});
}

// Two cubes on each other whose common face is two boundary faces on the same points, the first and the last.
inline PolyMesh cubesWithBaffle() {
    PolyMesh mesh = columnOf({square(0), square(1), square(2)});
    const std::vector<std::int32_t> shared(mesh.face(0).begin(), mesh.face(0).end());
    mesh.neighbour.clear();
    mesh.faceVertices.insert(mesh.faceVertices.end(), shared.rbegin(), shared.rend());
    mesh.faceOffsets.push_back(static_cast<std::uint32_t>(mesh.faceVertices.size()));
    mesh.owner.push_back(1);
    mesh.patches.at(0) = {"wall", "wall", 0, mesh.faces()};
    return mesh;
}

} // namespace i2b::test
