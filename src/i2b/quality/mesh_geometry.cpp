#include "i2b/quality/mesh_geometry.h"
#include "i2b/core/parallel.h"
#include <array>

namespace i2b {
namespace {

using Index = std::size_t;
constexpr double tinyVolume = 1e-300; // below it a cell has no volume to weigh with

} // namespace

FaceShape measureFace(const PolyMesh& mesh, std::int32_t face) {
    const std::span<const std::int32_t> v = mesh.face(face);
    const auto gather = [&](Vec3* points) {
        for (Index i = 0; i < v.size(); ++i) points[i] = mesh.points[Index(v[i])];
    };
    if (v.size() == 4) {
        std::array<Vec3, 4> four;
        gather(four.data());
        return shapeOfPolygon(four.data(), std::integral_constant<Index, 4>{});
    }
    if (std::array<Vec3, 16> few; v.size() <= few.size()) {
        gather(few.data());
        return shapeOfPolygon(few.data(), v.size());
    }
    std::vector<Vec3> many(v.size());
    gather(many.data());
    return shapeOfPolygon(many.data(), v.size());
}

void measureCell(const PolyMesh& mesh, std::span<const std::int32_t> faces, std::int32_t cell,
                 MeshGeometry& geometry) {
    Vec3 mean;
    for (const std::int32_t f : faces) mean += geometry.faceCentre[Index(f)];
    mean = divided(mean, static_cast<double>(faces.size()));
    Vec3 weighted;
    double volume3 = 0;
    for (const std::int32_t f : faces) {
        const Vec3& centre = geometry.faceCentre[Index(f)];
        const Vec3 outwards = mesh.owner[Index(f)] == cell ? centre - mean : mean - centre;
        const double pyramid3 = dot(geometry.faceArea[Index(f)], outwards);
        weighted += pyramid3 * ((3.0 / 4.0) * centre + (1.0 / 4.0) * mean);
        volume3 += pyramid3;
    }
    geometry.cellCentre[Index(cell)] = std::abs(volume3) > tinyVolume ? divided(weighted, volume3) : mean;
    geometry.cellVolume[Index(cell)] = volume3 * (1.0 / 3.0);
}

MeshGeometry measureGeometry(const PolyMesh& mesh, const Rows& cellFaces) {
    MeshGeometry g;
    const auto faces = static_cast<Index>(mesh.faces()), cells = static_cast<Index>(mesh.cells);
    g.faceCentre.resize(faces);
    g.faceArea.resize(faces);
    parallelFor(faces, [&](Index f) {
        const FaceShape shape = measureFace(mesh, static_cast<std::int32_t>(f));
        g.faceCentre[f] = shape.centre;
        g.faceArea[f] = shape.area;
    });
    g.cellCentre.resize(cells);
    g.cellVolume.resize(cells);
    parallelFor(cells, [&](Index c) {
        const auto cell = static_cast<std::int32_t>(c);
        measureCell(mesh, cellFaces[cell], cell, g);
    });
    return g;
}

} // namespace i2b
