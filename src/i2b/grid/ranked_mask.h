// Numbers the set bits of a mask tree: leaf by leaf in tree order, bit by bit inside. Costs some forty bytes a leaf node
// beside the mask, nothing per cell; a look-up is a cached tree probe and one popcount.
#pragma once
#include "i2b/grid/mask_ops.h"
#include <algorithm>
#include <array>
#include <bit>

namespace i2b {

class RankedMask {
  public:
    RankedMask() = default;
    explicit RankedMask(Mask::ConstPtr mask, std::int64_t first = 0);

    const Mask& mask() const { return *mask_; }
    std::int64_t first() const { return first_; }
    std::int64_t size() const { return size_; }
    std::size_t leafCount() const { return leaves_.size(); }
    const MaskLeaf& leaf(std::size_t i) const { return *leaves_[i]; }
    std::int64_t leafFirst(std::size_t i) const { return first_ + starts_[i]; }
    Index3 at(std::int64_t rank) const; // the coordinates of the bit of this number

    // f(rank, coordinates) for every set bit, in parallel by leaf.
    template <class F>
    void forEach(const F& f) const {
        parallelFor(
            leaves_.size(),
            [&](std::size_t i) {
                std::int64_t rank = leafFirst(i);
                const Index3 o = toIndex(leaves_[i]->origin());
                bits::forEach(leafBits(leaves_[i]), [&](int x, int y, int z) {
                    f(rank++, Index3{o[0] + x, o[1] + y, o[2] + z});
                });
            },
            16);
    }

    // Not to be shared between threads: it remembers where it looked last.
    class Reader {
      public:
        explicit Reader(const RankedMask& ranked) : ranked_(&ranked), index_(*ranked.index_) {}
        // -1 where the bit is not set.
        std::int64_t rank(const Index3& c);
        bool has(const Index3& c);
        std::int32_t leafIndex(const Index3& c); // -1: no leaf there

      private:
        const RankedMask* ranked_;
        openvdb::tree::ValueAccessor<const openvdb::Int32Tree> index_;
        Index3 lastKey_{-1, -1, -1};
        std::int32_t last_ = -1;
    };

  private:
    Mask::ConstPtr mask_;
    std::vector<const MaskLeaf*> leaves_;
    std::vector<std::int64_t> starts_;
    std::vector<std::array<std::uint16_t, 8>> before_; // set bits of a leaf before each of its words
    std::shared_ptr<openvdb::Int32Tree> index_; // leaf number at (leaf origin / 8)
    std::int64_t first_ = 0, size_ = 0;
};

inline Index3 RankedMask::at(std::int64_t rank) const {
    const auto leaf = static_cast<std::size_t>(std::upper_bound(starts_.begin(), starts_.end(), rank - first_) - starts_.begin()) - 1;
    const std::array<std::uint16_t, 8>& before = before_[leaf];
    const auto within = static_cast<std::uint16_t>(rank - leafFirst(leaf));
    const auto word = static_cast<std::size_t>(std::upper_bound(before.begin(), before.end(), within) - before.begin()) - 1;
    std::uint64_t w = leaves_[leaf]->getValueMask().getWord<openvdb::Index64>(static_cast<openvdb::Index>(word));
    for (int skip = within - before[word]; skip > 0; --skip) w &= w - 1;
    const int bit = std::countr_zero(w);
    const Index3 o = toIndex(leaves_[leaf]->origin());
    return {o[0] + static_cast<int>(word), o[1] + (bit >> 3), o[2] + (bit & 7)};
}

inline std::int32_t RankedMask::Reader::leafIndex(const Index3& c) {
    const Index3 key{c[0] >> 3, c[1] >> 3, c[2] >> 3};
    if (key != lastKey_) {
        lastKey_ = key;
        last_ = index_.getValue(toCoord(key));
    }
    return last_;
}

inline bool RankedMask::Reader::has(const Index3& c) {
    const std::int32_t leaf = leafIndex(c);
    if (leaf < 0) return false;
    return ranked_->leaves_[static_cast<std::size_t>(leaf)]->getValueMask().isOn(
        static_cast<openvdb::Index32>(bits::offset(c[0], c[1], c[2])));
}

inline std::int64_t RankedMask::Reader::rank(const Index3& c) {
    const std::int32_t leaf = leafIndex(c);
    if (leaf < 0) return -1;
    const auto& mask = ranked_->leaves_[static_cast<std::size_t>(leaf)]->getValueMask();
    const int offset = bits::offset(c[0], c[1], c[2]);
    const auto word = static_cast<openvdb::Index>(offset >> 6);
    const std::uint64_t w = mask.getWord<openvdb::Index64>(word);
    if (!(w >> (offset & 63) & 1)) return -1;
    const auto i = static_cast<std::size_t>(leaf);
    return ranked_->leafFirst(i) + ranked_->before_[i][word] + std::popcount(w & ((std::uint64_t(1) << (offset & 63)) - 1));
}

} // namespace i2b
