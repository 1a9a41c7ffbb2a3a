// A long vector as a set, sorted by all threads; for short ones sortUnique().
#pragma once
#include <algorithm>
#include <tbb/parallel_sort.h>
#include <vector>

namespace i2b {

// Ascending, each once.
template <class T, class Allocator>
void parallelSortUnique(std::vector<T, Allocator>& items) {
    tbb::parallel_sort(items.begin(), items.end());
    items.erase(std::unique(items.begin(), items.end()), items.end());
}

} // namespace i2b
