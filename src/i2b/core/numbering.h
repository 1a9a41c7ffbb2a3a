// A few whole numbers out of many, and the place of each among them: for small parts of a mesh, where an array over the whole of it
// would cost more than the part.
#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace i2b {

// Open addressing, linear probing (Knuth, The Art of Computer Programming, volume 3, section 6.4, algorithm L), at most half full.
class Numbering {
  public:
    // Numbers not below zero, in any order, also more than once.
    void add(std::int32_t number) {
        std::size_t at = find(number);
        if (slots_[at].number == number) return;
        items_.push_back(number);
        if (2 * items_.size() <= slots_.size()) slots_[at].number = number;
        else grow();
    }
    // When all are in: places follow their order.
    void close() {
        std::sort(items_.begin(), items_.end());
        for (std::size_t i = 0; i < items_.size(); ++i) slots_[find(items_[i])].place = static_cast<std::int32_t>(i);
    }
    std::int32_t placeOf(std::int32_t number) const { return slots_[find(number)].place; } // -1: not among them
    const std::vector<std::int32_t>& items() const { return items_; }                      // after close() ascending

  private:
    struct Slot {
        std::int32_t number = -1, place = -1;
    };
    // Where the number is, or would be.
    std::size_t find(std::int32_t number) const {
        const std::size_t mask = slots_.size() - 1;
        std::size_t at = (static_cast<std::size_t>(number) * 0x9e3779b97f4a7c15u >> 32) & mask;
        while (slots_[at].number != number && slots_[at].number >= 0) at = (at + 1) & mask;
        return at;
    }
    void grow() {
        slots_.assign(2 * slots_.size(), {});
        for (const std::int32_t item : items_) slots_[find(item)].number = item;
    }

    std::vector<Slot> slots_ = std::vector<Slot>(512);
    std::vector<std::int32_t> items_;
};

} // namespace i2b
