// Raw vectors filled and copied by all threads, which then fetch their pages, too.
#pragma once
#include "i2b/core/parallel.h"
#include "i2b/core/raw_vector.h"
#include <cstddef>

namespace i2b {

// count copies of a value.
template <class T>
RawVector<T> filled(std::size_t count, const T& value) {
    RawVector<T> all(count);
    parallelFor(count, [&](std::size_t i) { all[i] = value; }, 8192);
    return all;
}

// One copy after another may go to the same memory.
template <class T>
void copyTo(RawVector<T>& copy, const RawVector<T>& from) {
    copy.resize(from.size());
    parallelFor(from.size(), [&](std::size_t i) { copy[i] = from[i]; }, 8192);
}

} // namespace i2b
