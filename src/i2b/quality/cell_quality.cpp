#include "i2b/quality/cell_quality.h"
#include "i2b/core/parallel.h"
#include "i2b/quality/mesh_geometry.h"
#include "i2b/quality/skewness.h"
#include <numbers>

namespace i2b {

CellQuality measureCellQuality(const PolyMesh& mesh) {
    const Rows cellFaces = buildCellFaces(mesh);
    const MeshGeometry g = measureGeometry(mesh, cellFaces);
    const auto faces = static_cast<std::size_t>(mesh.faces()), internal = static_cast<std::size_t>(mesh.internalFaces());
    std::vector<float> angle(faces, 0), skew(faces, 0);
    parallelFor(faces, [&](std::size_t f) {
        const Vec3& area = g.faceArea[f];
        const Vec3& own = g.cellCentre[static_cast<std::size_t>(mesh.owner[f])];
        const Vec3 toFace = g.faceCentre[f] - own;
        Vec3 across;
        if (f < internal) {
            across = g.cellCentre[static_cast<std::size_t>(mesh.neighbour[f])] - own;
            const double lengths = norm(area) * norm(across);
            if (lengths > 0) angle[f] = static_cast<float>(std::acos(std::clamp(dot(area, across) / lengths, -1.0, 1.0)) * 180 / std::numbers::pi);
        } else {
            const Vec3 normal = normalized(area);
            across = normal * dot(normal, toFace);
        }
        const double extent = (f < internal ? 0.2 : 0.4) * norm(across) + tinyDivisor;
        skew[f] = static_cast<float>(skewness(mesh, mesh.face(static_cast<std::int32_t>(f)), g.faceCentre[f], area, toFace, across, extent, 0));
    });
    CellQuality quality;
    const auto cells = static_cast<std::size_t>(mesh.cells);
    quality.nonOrthogonality.assign(cells, 0), quality.skewness.assign(cells, 0), quality.volume.resize(cells);
    parallelFor(cells, [&](std::size_t c) {
        quality.volume[c] = static_cast<float>(g.cellVolume[c]);
        for (std::int32_t f : cellFaces[static_cast<std::int32_t>(c)]) {
            quality.nonOrthogonality[c] = std::max(quality.nonOrthogonality[c], angle[static_cast<std::size_t>(f)]);
            quality.skewness[c] = std::max(quality.skewness[c], skew[static_cast<std::size_t>(f)]);
        }
    });
    return quality;
}

} // namespace i2b
