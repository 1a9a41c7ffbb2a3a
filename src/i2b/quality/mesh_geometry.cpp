#include "i2b/quality/mesh_geometry.h"
#include "i2b/core/parallel.h"
#include "i2b/quality/glances.h"
#include <array>

namespace i2b {
namespace {

using Index = std::size_t;
constexpr double tinyVolume = 1e-300; // below it a cell has no volume to weigh with

} // namespace

FaceShape measureFace(const PolyMesh& mesh, std::int32_t face) {
    const std::span<const std::int32_t> v = mesh.face(face);
    const auto at = [&](Index i) -> const Vec3& { return mesh.points[Index(v[i])]; };
    if (v.size() == 4) return shapeOfQuad(at(0), at(1), at(2), at(3));
    if (v.size() == 3) {
        const std::array<Vec3, 3> three{at(0), at(1), at(2)};
        return shapeOfPolygon(three.data(), three.size());
    }
    const auto gather = [&](Vec3* points) {
        for (Index i = 0; i < v.size(); ++i) points[i] = at(i);
    };
    if (std::array<Vec3, 8> few; v.size() <= few.size()) { // more would take long to be made
        gather(few.data());
        return shapeOfPolygon(few.data(), v.size());
    }
    std::vector<Vec3> many(v.size());
    gather(many.data());
    return shapeOfPolygon(many.data(), v.size());
}

CellMoments measureCell(const PolyMesh& mesh, std::span<const std::int32_t> faces,
                        std::span<const FaceShape> shapes, std::int32_t cell) {
    Vec3 mean;
    for (const FaceShape& shape : shapes) mean += shape.centre;
    mean = divided(mean, static_cast<double>(faces.size()));
    Vec3 weighted;
    double volume3 = 0;
    for (Index i = 0; i < faces.size(); ++i) {
        const Vec3& centre = shapes[i].centre;
        const Vec3 outwards = mesh.owner[Index(faces[i])] == cell ? centre - mean : mean - centre;
        const double pyramid3 = dot(shapes[i].area, outwards);
        weighted += pyramid3 * ((3.0 / 4.0) * centre + (1.0 / 4.0) * mean);
        volume3 += pyramid3;
    }
    return {std::abs(volume3) > tinyVolume ? divided(weighted, volume3) : mean, volume3 * (1.0 / 3.0)};
}

RawVector<CellMoments> measureCellMoments(const PolyMesh& mesh, const Rows& cellFaces) {
    RawVector<CellMoments> cells(static_cast<Index>(mesh.cells));
    parallelChunks(cells.size(), 2048, [&](Index begin, Index end, Index) {
        CellFaceShapes shapes(mesh);
        HexGlance hexes(mesh, cellFaces, openHexBounds);
        const auto clear = [&](std::int32_t cell, const HexBatch&, Index lane) { cells[Index(cell)] = hexes.moments(lane); };
        const auto closely = [&](std::int32_t cell) {
            const std::span<const std::int32_t> faces = cellFaces[cell];
            cells[Index(cell)] = measureCell(mesh, faces, shapes.of(faces), cell);
        };
        for (Index c = begin; c < end; ++c) {
            const auto cell = static_cast<std::int32_t>(c);
            if (hexes.isHex(cellFaces[cell])) hexes.add(cell, clear, closely);
            else closely(cell);
        }
        hexes.finish(clear, closely);
    });
    return cells;
}

} // namespace i2b
