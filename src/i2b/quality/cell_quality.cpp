#include "i2b/quality/cell_quality.h"
#include "i2b/core/parallel.h"
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

CellQuality measureCellQuality(const PolyMesh& mesh) {
    const RawVector<CellMoments> moments = measureCellMoments(mesh, buildCellFaces(mesh));
    CellQuality quality;
    quality.nonOrthogonality.assign(moments.size(), 0);
    quality.skewness.assign(moments.size(), 0);
    quality.volume.resize(moments.size());
    parallelFor(moments.size(), [&](std::size_t c) { quality.volume[c] = static_cast<float>(moments[c].volume); });
    const auto internal = static_cast<std::size_t>(mesh.internalFaces());
    parallelFor(static_cast<std::size_t>(mesh.faces()), [&](std::size_t f) {
        const auto face = static_cast<std::int32_t>(f);
        const FaceShape shape = measureFace(mesh, face);
        const auto own = static_cast<std::size_t>(mesh.owner[f]);
        if (f >= internal) {
            raise(quality.skewness[own], static_cast<float>(faceSkewness(mesh, face, shape, moments[own].centre, nullptr, 0)));
            return;
        }
        const auto nei = static_cast<std::size_t>(mesh.neighbour[f]);
        const double cosine = std::clamp(pairValues(shape, moments[own], moments[nei]).ortho, -1.0, 1.0);
        const auto angle = static_cast<float>(std::acos(cosine) * 180 / std::numbers::pi);
        const auto skew = static_cast<float>(faceSkewness(mesh, face, shape, moments[own].centre, &moments[nei].centre, 0));
        for (const std::size_t c : {own, nei}) {
            raise(quality.nonOrthogonality[c], angle);
            raise(quality.skewness[c], skew);
        }
    });
    return quality;
}

} // namespace i2b
