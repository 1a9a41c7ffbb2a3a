// A few bits for each of many items, nearly all of them 0, with a count of the others for each block of items: finding these takes
// no longer where there are more items without any.
#pragma once
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace i2b {

class Flags {
  public:
    explicit Flags(std::size_t items) : flags_(items, 0), counts_((items + block - 1) / block, 0) {}
    std::size_t size() const { return flags_.size(); }
    std::uint8_t operator[](std::size_t i) const { return flags_[i]; }
    // May be called for different items at once.
    void set(std::size_t i, std::uint8_t to) {
        const int more = (to != 0) - (flags_[i] != 0);
        flags_[i] = to;
        if (more != 0) std::atomic_ref(counts_[i / block]).fetch_add(more, std::memory_order_relaxed);
    }
    // f(item) for those that are not 0, ascending.
    template <class F>
    void forEach(const F& f) const {
        for (std::size_t b = 0; b < counts_.size(); ++b) {
            int left = counts_[b];
            for (std::size_t i = b * block; left > 0; ++i)
                if (flags_[i] != 0) --left, f(i);
        }
    }

  private:
    static constexpr std::size_t block = 1024;
    std::vector<std::uint8_t> flags_;
    std::vector<std::int32_t> counts_; // per block
};

} // namespace i2b
