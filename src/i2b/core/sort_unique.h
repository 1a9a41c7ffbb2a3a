// A vector as a set.
#pragma once
#include <algorithm>
#include <vector>

namespace i2b {

// Ascending, each once.
template <class T>
void sortUnique(std::vector<T>& items) {
    std::sort(items.begin(), items.end());
    items.erase(std::unique(items.begin(), items.end()), items.end());
}

} // namespace i2b
