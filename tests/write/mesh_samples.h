// Meshes made by hand for the writers' tests.
#pragma once
#include "i2b/assemble/poly_mesh.h"
#include "temp_folder.h"
#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace i2b::test {

// n[0] x n[1] x n[2] hexahedra of the given edge from the origin; patches "bottom" (wall, z low) and "sides"
// (patch).
inline PolyMesh boxMesh(std::array<int, 3> n, double edge = 1) {
    PolyMesh mesh;
    const auto point = [&](int i, int j, int k) { return (k * (n[1] + 1) + j) * (n[0] + 1) + i; };
    const auto cell = [&](int i, int j, int k) { return (k * n[1] + j) * n[0] + i; };
    for (int k = 0; k <= n[2]; ++k)
        for (int j = 0; j <= n[1]; ++j)
            for (int i = 0; i <= n[0]; ++i)
                mesh.points.push_back(Vec3{double(i), double(j), double(k)} * edge);
    mesh.cells = n[0] * n[1] * n[2];
    mesh.faceOffsets.push_back(0);
    const auto add = [&](std::array<int, 4> v, int owner) {
        mesh.faceVertices.insert(mesh.faceVertices.end(), v.begin(), v.end());
        mesh.faceOffsets.push_back(static_cast<std::uint32_t>(mesh.faceVertices.size()));
        mesh.owner.push_back(owner);
    };
    const auto high = [&](int axis, int i, int j, int k) -> std::array<int, 4> { // normal along +axis
        if (axis == 0)
            return {point(i + 1, j, k), point(i + 1, j + 1, k), point(i + 1, j + 1, k + 1),
                    point(i + 1, j, k + 1)};
        if (axis == 1)
            return {point(i, j + 1, k), point(i, j + 1, k + 1), point(i + 1, j + 1, k + 1),
                    point(i + 1, j + 1, k)};
        return {point(i, j, k + 1), point(i + 1, j, k + 1), point(i + 1, j + 1, k + 1),
                point(i, j + 1, k + 1)};
    };
    const auto low = [&](int axis, int i, int j, int k) {
        auto v = high(axis, i - (axis == 0), j - (axis == 1), k - (axis == 2));
        std::reverse(v.begin(), v.end());
        return v;
    };
    const auto forCells = [&](const auto& body) {
        for (int k = 0; k < n[2]; ++k)
            for (int j = 0; j < n[1]; ++j)
                for (int i = 0; i < n[0]; ++i) body(i, j, k);
    };
    forCells([&](int i, int j, int k) {
        const std::array<int, 3> at{i, j, k};
        for (int axis = 0; axis < 3; ++axis) {
            if (at[std::size_t(axis)] + 1 == n[std::size_t(axis)]) continue;
            add(high(axis, i, j, k), cell(i, j, k));
            mesh.neighbour.push_back(cell(i + (axis == 0), j + (axis == 1), k + (axis == 2)));
        }
    });
    const auto begin = [&](const char* name, const char* type) {
        mesh.patches.push_back({name, type, mesh.faces(), 0});
    };
    const auto end = [&] { mesh.patches.back().count = mesh.faces() - mesh.patches.back().start; };
    begin("bottom", "wall");
    forCells([&](int i, int j, int k) {
        if (k == 0) add(low(2, i, j, k), cell(i, j, k));
    });
    end();
    begin("sides", "patch");
    forCells([&](int i, int j, int k) {
        const std::array<int, 3> at{i, j, k};
        for (int axis = 0; axis < 3; ++axis) {
            if (at[std::size_t(axis)] + 1 == n[std::size_t(axis)]) add(high(axis, i, j, k), cell(i, j, k));
            if (axis < 2 && at[std::size_t(axis)] == 0) add(low(axis, i, j, k), cell(i, j, k));
        }
    });
    end();
    return mesh;
}

// Cells given by their faces' vertex lists, each seen from outside: shared faces are found by their vertex
// sets.
inline PolyMesh meshOf(std::vector<Vec3> points,
                       const std::vector<std::vector<std::vector<std::int32_t>>>& cells) {
    struct Side {
        std::vector<std::int32_t> face, key;
        std::int32_t owner, neighbour = -1;
    };
    std::vector<Side> sides;
    for (std::size_t c = 0; c < cells.size(); ++c)
        for (const auto& face : cells[c]) {
            auto key = face;
            std::sort(key.begin(), key.end());
            const auto same =
                std::find_if(sides.begin(), sides.end(), [&](const Side& s) { return s.key == key; });
            if (same == sides.end())
                sides.push_back({face, key, static_cast<std::int32_t>(c), -1});
            else
                same->neighbour = static_cast<std::int32_t>(c);
        }
    const auto order = [](const Side& s) {
        return s.neighbour < 0 ? std::array{1, 0, 0} : std::array{0, s.owner, s.neighbour};
    };
    std::stable_sort(sides.begin(), sides.end(),
                     [&](const Side& a, const Side& b) { return order(a) < order(b); });
    PolyMesh mesh;
    mesh.points.assign(points.begin(), points.end());
    mesh.cells = static_cast<std::int32_t>(cells.size());
    mesh.faceOffsets.push_back(0);
    for (const Side& s : sides) {
        mesh.faceVertices.insert(mesh.faceVertices.end(), s.face.begin(), s.face.end());
        mesh.faceOffsets.push_back(static_cast<std::uint32_t>(mesh.faceVertices.size()));
        mesh.owner.push_back(s.owner);
        if (s.neighbour >= 0) mesh.neighbour.push_back(s.neighbour);
    }
    mesh.patches.push_back({"body", "wall", mesh.internalFaces(), mesh.faces() - mesh.internalFaces()});
    return mesh;
}

// One cell of each kind, five in all, volume 3 in all.
//   0 hexahedron  [0,1]^3                                   volume 1
//   1 wedge       over x in [1,2], z under the slope 2-x    volume 1/2
//   2 pyramid     on the hexahedron's top, apex (0.5,0.5,2) volume 1/3
//   3 tetrahedron on the pyramid's side y = 0, apex (0.5,-1,1) volume 1/6
//   4 polyhedron  [-1,0]x[0,1]x[0,1], side x = -1 of two quads (a hanging edge at z = 0.5): 7 faces, volume 1
inline PolyMesh zooMesh() {
    std::vector<Vec3> p{{0, 0, 0},  {1, 0, 0},  {1, 1, 0},  {0, 1, 0},  {0, 0, 1},   {1, 0, 1},
                        {1, 1, 1},  {0, 1, 1},  {2, 0, 0},  {2, 1, 0},  {.5, .5, 2}, {.5, -1, 1},
                        {-1, 0, 0}, {-1, 1, 0}, {-1, 0, 1}, {-1, 1, 1}, {-1, 0, .5}, {-1, 1, .5}};
    return meshOf(p, {{{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}},
                      {{1, 5, 6, 2}, {1, 2, 9, 8}, {5, 8, 9, 6}, {1, 8, 5}, {2, 6, 9}},
                      {{4, 7, 6, 5}, {4, 5, 10}, {5, 6, 10}, {6, 7, 10}, {7, 4, 10}},
                      {{4, 10, 5}, {4, 5, 11}, {5, 10, 11}, {10, 4, 11}},
                      {{0, 4, 7, 3},
                       {12, 13, 3, 0},
                       {14, 4, 7, 15},
                       {12, 0, 4, 14, 16},
                       {13, 17, 15, 7, 3},
                       {12, 16, 17, 13},
                       {16, 14, 15, 17}}});
}

inline std::string contents(const std::filesystem::path& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

inline void put(const std::filesystem::path& path, const std::string& text) {
    std::filesystem::create_directories(path.parent_path());
    std::ofstream(path, std::ios::binary) << text;
}

// Standard output and error of a command, and its status.
struct Ran {
    int status = -1;
    std::string text;
};
inline Ran shell(const std::string& command) {
    Ran ran;
    FILE* pipe = ::popen((command + " 2>&1").c_str(), "r");
    if (!pipe) return ran;
    char buffer[4096];
    while (const std::size_t n = std::fread(buffer, 1, sizeof buffer, pipe)) ran.text.append(buffer, n);
    ran.status = ::pclose(pipe);
    return ran;
}

} // namespace i2b::test
