#include "i2b/write/ply_write.h"
#include "i2b/write/output_file.h"
#include <algorithm>
#include <bit>
#include <cstring>
#include <fmt/format.h>

namespace i2b {
namespace {

static_assert(std::endian::native == std::endian::little, "the header says little-endian");

// The faces of the chosen patches one after the other, and the part each belongs to.
struct Wall {
    std::vector<std::int32_t> faces, part;
    std::vector<std::int32_t> points; // into the mesh, ascending
    std::vector<std::int32_t> number; // per mesh point: its place in points, or -1
    std::size_t widest = 0;           // vertices of the largest polygon
    std::string comments;
};

Wall collect(const PolyMesh& mesh, const std::vector<std::string>& names) {
    Wall wall;
    wall.number.assign(mesh.points.size(), -1);
    std::int32_t part = 0;
    for (const Patch& patch : mesh.patches) {
        const bool named = std::find(names.begin(), names.end(), patch.name) != names.end();
        if (names.empty() ? patch.type != "wall" : !named) continue;
        wall.comments += fmt::format("comment part {} {}\n", part, patch.name);
        for (std::int32_t f = patch.start; f < patch.start + patch.count; ++f) {
            wall.faces.push_back(f);
            wall.part.push_back(part);
            wall.widest = std::max(wall.widest, mesh.face(f).size());
            for (const std::int32_t v : mesh.face(f)) wall.number[static_cast<std::size_t>(v)] = 0;
        }
        ++part;
    }
    for (std::size_t v = 0; v < wall.number.size(); ++v)
        if (wall.number[v] == 0) {
            wall.number[v] = static_cast<std::int32_t>(wall.points.size());
            wall.points.push_back(static_cast<std::int32_t>(v));
        }
    return wall;
}

template <class T>
void append(std::string& out, T value) {
    char bytes[sizeof value];
    std::memcpy(bytes, &value, sizeof value);
    out.append(bytes, sizeof value);
}

std::string header(const Wall& wall, const std::vector<PointData>& values) {
    std::string properties;
    for (const PointData& data : values)
        properties += fmt::format("property {} {}\n", std::holds_alternative<std::span<const float>>(data.values) ? "float" : "uchar", data.name);
    return fmt::format(
        "ply\nformat binary_little_endian 1.0\n{}element vertex {}\nproperty double x\nproperty double y\n"
        "property double z\n{}element face {}\nproperty list {} int vertex_indices\nproperty int "
        "part\nend_header\n",
        wall.comments, wall.points.size(), properties, wall.faces.size(), wall.widest < 256 ? "uchar" : "uint");
}

// Of one point, which may have none.
void appendValue(std::string& out, const PointData& data, std::int32_t point) {
    const auto at = std::lower_bound(data.points.begin(), data.points.end(), point);
    const bool found = at != data.points.end() && *at == point;
    std::visit(
        [&](const auto& values) {
            using T = std::remove_const_t<typename std::decay_t<decltype(values)>::element_type>;
            append(out, found ? values[static_cast<std::size_t>(at - data.points.begin())] : T(0));
        },
        data.values);
}

} // namespace

void writePly(const PolyMesh& mesh, const std::filesystem::path& path, const Context& context,
              const std::vector<std::string>& patches, const std::vector<PointData>& values) {
    const Wall wall = collect(mesh, patches);
    OutputFile file(path);
    file.write(header(wall, values));
    const auto points = [&](std::size_t begin, std::size_t end, std::string& out) {
        for (std::size_t i = begin; i < end; ++i) {
            append(out, mesh.points[static_cast<std::size_t>(wall.points[i])]);
            for (const PointData& data : values) appendValue(out, data, wall.points[i]);
        }
    };
    writeBlocks(file, wall.points.size(), 16384, points, context);
    const auto faces = [&](std::size_t begin, std::size_t end, std::string& out) {
        for (std::size_t i = begin; i < end; ++i) {
            const auto face = mesh.face(wall.faces[i]);
            if (wall.widest < 256)
                append(out, static_cast<std::uint8_t>(face.size()));
            else
                append(out, static_cast<std::uint32_t>(face.size()));
            for (auto v = face.rbegin(); v != face.rend(); ++v)
                append(out, wall.number[static_cast<std::size_t>(*v)]);
            append(out, wall.part[i]);
        }
    };
    writeBlocks(file, wall.faces.size(), 16384, faces, context);
    file.close();
}

} // namespace i2b
