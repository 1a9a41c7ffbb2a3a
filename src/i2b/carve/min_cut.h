// Two sets at least cost: each item is taken or left, at a price of its own, and pairs of items have a price for being
// parted. The least total is a minimum cut (Boykov and Kolmogorov, IEEE Trans. Pattern Anal. Mach. Intell. 26 (2004)
// 1124-1137; the algorithm is Boost.Graph's).
#pragma once
#include <cstddef>
#include <vector>

namespace i2b {

class MinCut {
  public:
    explicit MinCut(std::size_t items) : taken_(items, 0), left_(items, 0) {}

    // Prices are whole numbers and not below zero. Each item adds up what it is told.
    void addTaken(std::size_t item, long price) { taken_[item] += price; }
    void addLeft(std::size_t item, long price) { left_[item] += price; }
    // first: what it costs to take a and leave b; second: to take b and leave a.
    void addPair(std::size_t a, std::size_t b, long first, long second) { pairs_.push_back({a, b, first, second}); }

    // By item, 1 where it is taken. Runs on one thread: of cuts that cost alike the same one each time.
    std::vector<unsigned char> solve() const;

  private:
    struct Pair {
        std::size_t a, b;
        long first, second;
    };
    std::vector<long> taken_, left_;
    std::vector<Pair> pairs_;
};

} // namespace i2b
