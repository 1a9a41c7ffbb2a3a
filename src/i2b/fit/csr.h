// Rows of values, one after the other.
#pragma once
#include "i2b/core/raw_vector.h"
#include <cstddef>
#include <cstdint>
#include <span>

namespace i2b {

template <class T>
struct Csr { // rows of values
    RawVector<std::int64_t> start;        // rows + 1
    RawVector<T> values;
    std::size_t rows() const { return start.empty() ? 0 : start.size() - 1; }
    std::span<const T> operator[](std::size_t row) const {
        return {values.data() + start[row], values.data() + start[row + 1]};
    }
};

// Rows the first of which change: these are by themselves, beside what they are made from.
template <class T>
struct ChangingCsr {
    Csr<T> changing, fixed;
    std::span<const T> operator[](std::size_t row) const { return row < changing.rows() ? changing[row] : fixed[row]; }
};

} // namespace i2b
