// Where what many items give begins, when each gives some.
#pragma once
#include "i2b/core/parallel.h"
#include "i2b/core/raw_vector.h"
#include <cstddef>
#include <functional>
#include <tbb/parallel_scan.h>

namespace i2b {

// Of whole numbers count(i), i in [0, n): the sum of those before each, and of all at the end. count may be asked twice.
template <class T, class Count>
RawVector<T> sumsBefore(std::size_t n, const Count& count) {
    RawVector<T> sums(n + 1);
    const LoopFence fence;
    sums[n] = tbb::parallel_scan(
        tbb::blocked_range<std::size_t>(0, n, 8192), T(0),
        [&](const tbb::blocked_range<std::size_t>& r, T sum, bool isFinal) {
            fence.enter();
            for (std::size_t i = r.begin(); i != r.end(); ++i) {
                if (isFinal) sums[i] = sum;
                sum += static_cast<T>(count(i));
            }
            fence.leave();
            return sum;
        },
        std::plus<T>());
    fence.join();
    return sums;
}

} // namespace i2b
