#include "i2b/quality/cell_quality.h"
#include "i2b/core/parallel.h"
#include "i2b/quality/glances.h"
#include "i2b/quality/mesh_geometry.h"
#include "i2b/quality/measures.h"
#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>

namespace i2b {

namespace {

// Values are not negative and the largest of a set does not depend on the order: the same on any number of threads.
void raise(float& to, float value) {
    std::atomic_ref<float> at(to);
    float now = at.load(std::memory_order_relaxed);
    while (now < value && !at.compare_exchange_weak(now, value, std::memory_order_relaxed)) {
    }
}

} // namespace

CellGeometry geometryOfCells(const PolyMesh& mesh) {
    CellGeometry cells{buildCellFaces(mesh), {}};
    cells.moments = measureCellMoments(mesh, cells.faces);
    return cells;
}

CellQuality measureCellQuality(const PolyMesh& mesh, const CellGeometry& cells) {
    const RawVector<CellMoments>& moments = cells.moments;
    CellQuality quality;
    quality.nonOrthogonality.assign(moments.size(), 0);
    quality.skewness.assign(moments.size(), 0);
    quality.volume.resize(moments.size());
    parallelFor(moments.size(), [&](std::size_t c) { quality.volume[c] = static_cast<float>(moments[c].volume); });
    const auto internal = static_cast<std::size_t>(mesh.internalFaces());
    const auto raiseBoth = [&](std::size_t f, double ortho, double skew) {
        const auto angle = static_cast<float>(std::acos(std::clamp(ortho, -1.0, 1.0)) * 180 / std::numbers::pi);
        for (const std::int32_t c : {mesh.owner[f], mesh.neighbour[f]}) {
            raise(quality.nonOrthogonality[static_cast<std::size_t>(c)], angle);
            raise(quality.skewness[static_cast<std::size_t>(c)], static_cast<float>(skew));
        }
    };
    const auto closely = [&](std::size_t f) {
        const auto face = static_cast<std::int32_t>(f);
        const FaceShape shape = measureFace(mesh, face);
        const CellMoments& own = moments[static_cast<std::size_t>(mesh.owner[f])];
        if (f >= internal) {
            raise(quality.skewness[static_cast<std::size_t>(mesh.owner[f])], static_cast<float>(faceSkewness(mesh, face, shape, own.centre, nullptr, 0)));
            return;
        }
        const CellMoments& nei = moments[static_cast<std::size_t>(mesh.neighbour[f])];
        raiseBoth(f, pairValues(shape, own, nei).ortho, faceSkewness(mesh, face, shape, own.centre, &nei.centre, 0));
    };
    parallelChunks(static_cast<std::size_t>(mesh.faces()), 4096, [&](std::size_t begin, std::size_t end, std::size_t) {
        QuadGlance quads(mesh, moments.data(), openQuadBounds);
        const auto clear = [&](std::size_t f, const QuadBatch& batch, std::size_t lane) { raiseBoth(f, batch.ortho[lane], batch.skewness[lane]); };
        for (std::size_t f = begin; f < end; ++f)
            if (!quads.add(f, clear, closely)) closely(f);
        quads.finish(clear, closely);
    });
    return quality;
}

} // namespace i2b
