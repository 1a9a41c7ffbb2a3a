// Deterministic parallel loops on TBB: the result never depends on the number of threads or on scheduling.
// Rule of the house: count, scan, fill; sums in fixed chunks joined in order.
#pragma once
#include <cstddef>
#include <cstdint>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <vector>

namespace i2b {

// body(i) for i in [0, n), in any order, each exactly once.
template <class Body>
void parallelFor(std::size_t n, const Body& body, std::size_t grain = 256) {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, n, grain), [&](const tbb::blocked_range<std::size_t>& r) {
        for (std::size_t i = r.begin(); i != r.end(); ++i) body(i);
    });
}

// body(begin, end, chunk) over fixed chunks of [0, n); chunk bounds depend on n and size alone.
template <class Body>
void parallelChunks(std::size_t n, std::size_t size, const Body& body) {
    const std::size_t chunks = (n + size - 1) / size;
    tbb::parallel_for(std::size_t(0), chunks, [&](std::size_t c) {
        const std::size_t begin = c * size;
        body(begin, begin + size < n ? begin + size : n, c);
    });
}

// join(... join(join(init, part_0), part_1) ..., part_k) with part_c = body(begin, end) of fixed chunks: the same
// floating-point result on any number of threads.
template <class T, class Body, class Join>
T orderedReduce(std::size_t n, T init, const Body& body, const Join& join, std::size_t size = 4096) {
    std::vector<T> parts((n + size - 1) / size, init);
    parallelChunks(n, size, [&](std::size_t begin, std::size_t end, std::size_t c) { parts[c] = body(begin, end); });
    T result = init;
    for (const T& part : parts) result = join(result, part);
    return result;
}

// Turns counts into starting offsets in place and returns their sum.
template <class T>
T exclusiveScan(std::vector<T>& counts) {
    T sum = 0;
    for (T& c : counts) {
        const T n = c;
        c = sum;
        sum += n;
    }
    return sum;
}

} // namespace i2b
