// A union-find that many threads may join in at once: the larger root is hung under the smaller by compare and swap,
// so the final sets and their representatives (the smallest member) do not depend on the order of joins.
#pragma once
#include <atomic>
#include <cstdint>
#include <memory>

namespace i2b {

class UnionFind {
  public:
    explicit UnionFind(std::size_t n) : parent_(std::make_unique<std::atomic<std::uint32_t>[]>(n)) {
        for (std::size_t i = 0; i < n; ++i) parent_[i].store(static_cast<std::uint32_t>(i), std::memory_order_relaxed);
    }
    std::uint32_t find(std::uint32_t i) {
        for (std::uint32_t p = parent_[i].load(); p != i; p = parent_[i].load()) {
            const std::uint32_t grand = parent_[p].load();
            if (grand != p) parent_[i].compare_exchange_weak(p, grand); // path halving; losing the race does no harm
            i = grand;
        }
        return i;
    }
    void join(std::uint32_t a, std::uint32_t b) {
        for (;;) {
            a = find(a), b = find(b);
            if (a == b) return;
            if (a > b) std::swap(a, b);
            std::uint32_t expected = b;
            if (parent_[b].compare_exchange_strong(expected, a)) return;
        }
    }

  private:
    std::unique_ptr<std::atomic<std::uint32_t>[]> parent_;
};

} // namespace i2b
