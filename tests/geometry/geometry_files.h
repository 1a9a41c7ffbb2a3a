// Files for the readers' tests: STL and OBJ texts and bytes, gzip, the real files.
#pragma once
#include "i2b/core/error.h"
#include "i2b/core/vec.h"
#include "i2b/geometry/read.h"
#include "temp_folder.h"
#include <array>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <gtest/gtest.h>
#include <optional>
#include <random>
#include <string>
#include <vector>
#include <zlib.h>

namespace i2b::test {

using Corners = std::array<Vec3, 3>;

inline std::string gzip(const std::string& bytes) {
    z_stream z{};
    deflateInit2(&z, 6, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY);
    std::string out(deflateBound(&z, bytes.size()) + 64, '\0');
    z.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
    z.avail_in = static_cast<uInt>(bytes.size());
    z.next_out = reinterpret_cast<Bytef*>(out.data());
    z.avail_out = static_cast<uInt>(out.size());
    deflate(&z, Z_FINISH);
    out.resize(z.total_out);
    deflateEnd(&z);
    return out;
}

inline std::string asciiFacet(const Corners& c) {
    std::string text = "  facet normal 0 0 1\n    outer loop\n";
    for (const Vec3& p : c) text += fmt::format("      vertex {} {} {}\n", p.x, p.y, p.z);
    return text + "    endloop\n  endfacet\n";
}

inline std::string asciiSolid(const std::string& name, const std::vector<Corners>& triangles) {
    std::string text = "solid " + name + "\n";
    for (const Corners& c : triangles) text += asciiFacet(c);
    return text + "endsolid " + name + "\n";
}

inline std::string binaryStl(const std::vector<Corners>& triangles, std::string header = "binary",
                             std::optional<std::uint32_t> count = {}) {
    header.resize(80, ' ');
    const std::uint32_t n = count.value_or(static_cast<std::uint32_t>(triangles.size()));
    header.append(reinterpret_cast<const char*>(&n), 4);
    for (const Corners& c : triangles) {
        float v[12] = {0, 0, 1};
        for (int i = 0; i < 9; ++i) v[3 + i] = static_cast<float>(c[static_cast<std::size_t>(i / 3)][i % 3]);
        header.append(reinterpret_cast<const char*>(v), sizeof v);
        header.append(2, '\0');
    }
    return header;
}

inline std::vector<Corners> tetrahedron(const Vec3& at = {}) {
    const Vec3 a = at, b = at + Vec3{1, 0, 0}, c = at + Vec3{0, 1, 0}, d = at + Vec3{0, 0, 1};
    return {{a, c, b}, {a, b, d}, {a, d, c}, {b, c, d}};
}

// n x n squares of two triangles over the unit square; exact in single precision for n a power of two.
inline std::vector<Corners> sheet(int n) {
    std::vector<Corners> triangles;
    const auto at = [&](int i, int j) { return Vec3{double(i) / n, double(j) / n, double((i * j) % 7) / 8}; };
    for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) {
            triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
            triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
        }
    return triangles;
}

inline std::vector<std::string> partNames(const Surface& s) {
    std::vector<std::string> names;
    for (const Part& part : s.parts) names.push_back(part.name);
    return names;
}

inline std::array<Vec3, 3> cornersOf(const Surface& s, std::size_t t) {
    return {s.points[s.triangles[t][0]], s.points[s.triangles[t][1]], s.points[s.triangles[t][2]]};
}

struct ReadResult {
    Surface surface;
    GeometryNotes notes;
    std::optional<Error> error;
};

inline ReadResult read(const std::vector<std::string>& files, double scale = 1) {
    ReadResult result;
    try {
        result.surface = readSurface(files, scale, result.notes);
        EXPECT_EQ(result.surface.validate(), "");
        EXPECT_FALSE(result.surface.triangles.empty());
    } catch (const Error& error) {
        result.error = error;
    }
    return result;
}

// Cut off every few bytes, and with bytes under `below` strewn in: read or refused, and never anything else.
inline void readDamaged(const TempFolder& folder, const std::string& name, const std::string& whole, std::size_t step, unsigned below) {
    std::mt19937 random(3);
    for (std::size_t k = 1; k <= whole.size(); k += step) read({folder.write(name, whole.substr(0, k))});
    for (int k = 0; k < 300; ++k) {
        std::string damaged = whole;
        for (int times = 0; times < 3; ++times) damaged[random() % damaged.size()] = static_cast<char>(random() % below);
        read({folder.write(name, damaged)});
    }
}

inline bool contains(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

// Where real geometry lies: the environment's I2B_GEOMETRY_DIR, else beside the checkout. Need not exist.
inline std::string realFile(const std::string& name) {
    const char* const folder = std::getenv("I2B_GEOMETRY_DIR");
    return (std::filesystem::path(folder ? folder : I2B_GEOMETRY_DIR_DEFAULT) / name).string();
}

} // namespace i2b::test
