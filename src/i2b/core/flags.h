// A byte for each of many things, set by any thread, all to the same; looked through where few are set.
#pragma once
#include "i2b/core/parallel.h"
#include <algorithm>
#include <atomic>
#include <cstdint>
#include <cstring>
#include <vector>

namespace i2b {

inline void setFlag(std::uint8_t& flag) { std::atomic_ref<std::uint8_t>(flag).store(1, std::memory_order_relaxed); }

// Is one of [begin, end) not 0?
inline bool anyFlag(const std::vector<std::uint8_t>& flags, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; i += 8) { // eight as one
        std::uint64_t any = 0;
        std::memcpy(&any, flags.data() + i, std::min(i + 8, end) - i);
        if (any != 0) return true;
    }
    return false;
}

// f(i) for all i with flags[i] not 0, in any order. f may change that flag and no other.
template <class F>
void forFlagged(const std::vector<std::uint8_t>& flags, const F& f) {
    parallelChunks(flags.size(), 8192, [&](std::size_t begin, std::size_t end, std::size_t) {
        for (std::size_t i = begin; i < end; i += 8) { // eight as one
            const std::size_t last = std::min(i + 8, end);
            if (!anyFlag(flags, i, last)) continue;
            for (std::size_t k = i; k < last; ++k)
                if (flags[k]) f(k);
        }
    });
}

} // namespace i2b
