// Deterministic parallel loops on TBB: the result never depends on the number of threads or on scheduling.
// Rule of the house: count, scan, fill; sums in fixed chunks joined in order.
#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_scan.h>
#include <vector>

#if defined(__SANITIZE_THREAD__)
extern "C" void __tsan_acquire(void*);
extern "C" void __tsan_release(void*);
#endif

namespace i2b {

// Tells the thread checker what it cannot see inside a TBB that it has not instrumented: a loop's bodies come after what
// went before the loop, and before what follows it. Costs nothing in other builds.
class LoopFence {
  public:
#if defined(__SANITIZE_THREAD__)
    LoopFence() { __tsan_release(&before_); }
    void enter() const { __tsan_acquire(&before_); }
    void leave() const { __tsan_release(&after_); }
    void join() const { __tsan_acquire(&after_); }

  private:
    mutable char before_ = 0, after_ = 0;
#else
    void enter() const {}
    void leave() const {}
    void join() const {}
#endif
};

// body(i) for i in [0, n), in any order, each exactly once.
template <class Body>
void parallelFor(std::size_t n, const Body& body, std::size_t grain = 256) {
    if (n <= grain) { // one task: small meshes are measured by the thousand within other loops
        for (std::size_t i = 0; i < n; ++i) body(i);
        return;
    }
    const LoopFence fence;
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, n, grain), [&](const tbb::blocked_range<std::size_t>& r) {
        fence.enter();
        for (std::size_t i = r.begin(); i != r.end(); ++i) body(i);
        fence.leave();
    });
    fence.join();
}

// body(begin, end, chunk) over fixed chunks of [0, n); chunk bounds depend on n and size alone.
template <class Body>
void parallelChunks(std::size_t n, std::size_t size, const Body& body) {
    const std::size_t chunks = (n + size - 1) / size;
    if (chunks == 1) return void(body(0, n, 0));
    const LoopFence fence;
    tbb::parallel_for(std::size_t(0), chunks, [&](std::size_t c) {
        fence.enter();
        const std::size_t begin = c * size;
        body(begin, begin + size < n ? begin + size : n, c);
        fence.leave();
    });
    fence.join();
}

// join(... join(join(init, part_0), part_1) ..., part_k) with part_c = body(begin, end) of fixed chunks: the same
// floating-point result on any number of threads.
template <class T, class Body, class Join>
T orderedReduce(std::size_t n, T init, const Body& body, const Join& join, std::size_t size = 4096) {
    struct Part { T value; }; // of truth values, too, each in memory of its own
    std::vector<Part> parts((n + size - 1) / size, Part{init});
    parallelChunks(n, size, [&](std::size_t begin, std::size_t end, std::size_t c) { parts[c].value = body(begin, end); });
    T result = init;
    for (const Part& part : parts) result = join(result, part.value);
    return result;
}

// Turns counts, whole numbers, into starting offsets in place and returns their sum.
template <class T, class Allocator>
T exclusiveScan(std::vector<T, Allocator>& counts) {
    using Range = tbb::blocked_range<std::size_t>;
    constexpr std::size_t grain = 8192;
    const LoopFence fence;
    const auto scan = [&](const Range& r, T sum, bool isFinal) {
        fence.enter();
        for (std::size_t i = r.begin(); i != r.end(); ++i) {
            const T n = counts[i];
            if (isFinal) counts[i] = sum;
            sum += n;
        }
        fence.leave();
        return sum;
    };
    if (counts.size() <= grain) return scan(Range(0, counts.size()), T(0), true);
    const T sum = tbb::parallel_scan(Range(0, counts.size(), grain), T(0), scan, std::plus<T>());
    fence.join();
    return sum;
}

} // namespace i2b
