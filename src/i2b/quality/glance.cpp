// The kernels for the instruction sets that they gain most from; the machine's best is picked when the first is called.
#include "i2b/quality/glance_hexes.h"
#include "i2b/quality/glance_quads.h"
#include "i2b/quality/measures.h"

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic ignored "-Wpsabi" // no vector passes from one translation unit to another by value
#endif

#define I2B_LANES [[gnu::always_inline]] static inline

namespace i2b {
#define I2B_LANE_BYTES 16
namespace plain {
#include "i2b/quality/lane_maths.inl"
#include "i2b/quality/glance_quads.inl"
#include "i2b/quality/glance_hexes.inl"
} // namespace plain
#undef I2B_LANE_BYTES

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#define I2B_WIDER
#pragma GCC push_options
#pragma GCC target("arch=haswell")
#define I2B_LANE_BYTES 32
namespace haswell {
#include "i2b/quality/lane_maths.inl"
#include "i2b/quality/glance_quads.inl"
#include "i2b/quality/glance_hexes.inl"
} // namespace haswell
#undef I2B_LANE_BYTES
#pragma GCC pop_options
#pragma GCC push_options
#pragma GCC target("arch=skylake-avx512")
#define I2B_LANE_BYTES 64
namespace avx512 {
#include "i2b/quality/lane_maths.inl"
#include "i2b/quality/glance_quads.inl"
#include "i2b/quality/glance_hexes.inl"
} // namespace avx512
#undef I2B_LANE_BYTES
#pragma GCC pop_options
#endif

namespace {

struct Kernels {
    unsigned (*quads)(QuadBatch&, const QuadBounds&, QuadExtremes&) = plain::glanceAtQuads;
    unsigned (*hexes)(HexBatch&, const HexBounds&, HexExtremes&) = plain::glanceAtHexes;
};

Kernels bestKernels() {
#if defined(I2B_WIDER)
    __builtin_cpu_init();
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512dq") &&
        __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512cd"))
        return {avx512::glanceAtQuads, avx512::glanceAtHexes};
    if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("bmi2") && __builtin_cpu_supports("fma"))
        return {haswell::glanceAtQuads, haswell::glanceAtHexes};
#endif
    return {};
}

const Kernels& kernels() {
    static const Kernels best = bestKernels();
    return best;
}

} // namespace

unsigned glanceAtQuads(QuadBatch& batch, const QuadBounds& bounds, QuadExtremes& extremes) {
    return kernels().quads(batch, bounds, extremes);
}

unsigned glanceAtHexes(HexBatch& batch, const HexBounds& bounds, HexExtremes& extremes) {
    return kernels().hexes(batch, bounds, extremes);
}

} // namespace i2b
