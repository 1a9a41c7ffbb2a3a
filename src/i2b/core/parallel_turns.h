// Work that makes further work ready.
#pragma once
#include "i2b/core/parallel.h"
#include <tbb/parallel_for_each.h>
#include <vector>

namespace i2b {

// body(turn, feeder) for the first turns and for those that bodies add to the feeder, in any order, several at once. What one turn must
// see of another is the caller's to order.
template <class Turn, class Body>
void parallelTurns(const std::vector<Turn>& first, const Body& body) {
    const LoopFence fence;
    tbb::parallel_for_each(first.begin(), first.end(), [&](const Turn& turn, tbb::feeder<Turn>& feeder) {
        fence.enter();
        body(turn, feeder);
        fence.leave();
    });
    fence.join();
}

} // namespace i2b
