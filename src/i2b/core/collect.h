// What loops find, in the order of the items that they found it at: fixed chunks side by side, put together in their order.
#pragma once
#include "i2b/core/give_up.h"
#include "i2b/core/parallel.h"
#include "i2b/core/raw_vector.h"
#include <algorithm>
#include <cstddef>
#include <vector>

namespace i2b {

// body(i, put) calls put(item) any number of times for i in [0, n). The same on any number of threads.
template <class T, class Body>
RawVector<T> collect(std::size_t n, const Body& body, std::size_t chunk = 16384) {
    std::vector<std::vector<T>> found((n + chunk - 1) / chunk);
    parallelChunks(n, chunk, [&](std::size_t begin, std::size_t end, std::size_t c) {
        std::vector<T>& own = found[c];
        for (std::size_t i = begin; i < end; ++i) body(i, [&](const T& item) { own.push_back(item); });
    });
    std::vector<std::size_t> first(found.size());
    for (std::size_t c = 0; c < found.size(); ++c) first[c] = found[c].size();
    RawVector<T> all(exclusiveScan(first));
    parallelFor(found.size(), [&](std::size_t c) {
        std::copy(found[c].begin(), found[c].end(), all.begin() + static_cast<std::ptrdiff_t>(first[c]));
        giveUp(found[c]);
    }, 1);
    return all;
}

} // namespace i2b
