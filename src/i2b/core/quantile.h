// Order statistics of a few numbers or of many, in linear time.
#pragma once
#include <algorithm>
#include <cstddef>
#include <vector>

namespace i2b {

// The value that this share (0 to 1) of them does not exceed, of two beside it the lower one; 0 of none. Reorders the values.
inline double quantile(std::vector<double>& values, double share) {
    if (values.empty()) return 0;
    const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), at, values.end());
    return *at;
}

inline double median(std::vector<double>& values) { return quantile(values, 0.5); }

} // namespace i2b
