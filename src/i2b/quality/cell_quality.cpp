#include "i2b/quality/cell_quality.h"
#include "i2b/core/parallel.h"
#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>

namespace i2b {

namespace {

// Values are not negative and the largest of a set does not depend on the order: the same on any number of threads.
void raise(float& to, double value) {
    const auto wanted = static_cast<float>(value);
    std::atomic_ref<float> at(to);
    float now = at.load(std::memory_order_relaxed);
    while (now < wanted && !at.compare_exchange_weak(now, wanted, std::memory_order_relaxed)) {
    }
}

} // namespace

CellQualityMaker::CellQualityMaker(const RawVector<CellMoments>& moments) {
    quality_.nonOrthogonality.assign(moments.size(), 0);
    quality_.skewness.assign(moments.size(), 0);
    quality_.volume.resize(moments.size());
    parallelFor(moments.size(), [&](std::size_t c) { quality_.volume[c] = static_cast<float>(moments[c].volume); });
}

void CellQualityMaker::addPair(std::int32_t own, std::int32_t nei, double cosine, double skewness) {
    for (const std::int32_t c : {own, nei}) {
        raise(quality_.nonOrthogonality[static_cast<std::size_t>(c)], 1 - cosine); // keeps its digits where angles are small
        raise(quality_.skewness[static_cast<std::size_t>(c)], skewness);
    }
}

void CellQualityMaker::addBoundary(std::int32_t own, double skewness) { raise(quality_.skewness[static_cast<std::size_t>(own)], skewness); }

CellQuality CellQualityMaker::take() {
    parallelFor(quality_.nonOrthogonality.size(), [&](std::size_t c) {
        float& value = quality_.nonOrthogonality[c];
        value = static_cast<float>(std::acos(std::clamp(1.0 - value, -1.0, 1.0)) * 180 / std::numbers::pi);
    });
    return std::move(quality_);
}

} // namespace i2b
