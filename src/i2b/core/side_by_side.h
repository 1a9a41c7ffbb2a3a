// Two pieces of work at once.
#pragma once
#include "i2b/core/parallel.h"
#include <tbb/parallel_invoke.h>

namespace i2b {

template <class First, class Second>
void sideBySide(const First& first, const Second& second) {
    const LoopFence fence;
    tbb::parallel_invoke(
        [&] {
            fence.enter();
            first();
            fence.leave();
        },
        [&] {
            fence.enter();
            second();
            fence.leave();
        });
    fence.join();
}

} // namespace i2b
