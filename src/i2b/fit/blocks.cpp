#include "i2b/fit/blocks.h"
#include "i2b/core/give_up.h"
#include "i2b/core/parallel_turns.h"
#include "i2b/fit/band.h"
#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <tbb/parallel_sort.h>

namespace i2b {
namespace {

constexpr double edge = 10; // of a block, in h of its nodes
constexpr std::uint8_t none = 255;

struct Keyed { // a node and the block that it lies in
    std::uint64_t key;
    std::int32_t node;
    friend auto operator<=>(const Keyed&, const Keyed&) = default;
};

// The lattice's nodes lie on multiples of h: half of one off, none lies between two blocks.
std::uint64_t keyOf(const Vec3& place, double h, const Vec3& origin) {
    const auto at = [&](double x) { return static_cast<std::uint64_t>(std::max(0.0, (x / h + 0.5) / edge)) & 0x7ffff; };
    const Vec3 p = place - origin;
    const auto level = static_cast<std::uint64_t>(std::ilogb(h) & 0x7f);
    return level << 57 | at(p.x) << 38 | at(p.y) << 19 | at(p.z);
}

NodeBlocks::Kind kindOf(const Band& band, std::size_t n) {
    return n < band.walls ? NodeBlocks::wall : n < band.walls + band.fronts ? NodeBlocks::front : NodeBlocks::core;
}

// The movable nodes that share a corner with one, or look at its place.
template <class F>
void forNodesAround(const Band& band, std::size_t n, const F& f) {
    const auto offer = [&](std::int32_t m) {
        if (static_cast<std::size_t>(m) < band.movable) f(static_cast<std::size_t>(m));
    };
    band.corners.around(n, [&](const Corner& c) {
        for (const std::int32_t m : c.node) offer(m);
    });
    if (n < band.walls) offer(band.frontNode[n]);
    if (kindOf(band, n) == NodeBlocks::front)
        for (const std::int32_t fan : band.fansOf[n - band.walls]) offer(fan);
}

} // namespace

NodeBlocks::NodeBlocks(const Band& band) {
    gather(band);
    colour(order(band));
    giveUp(blockOf_);
}

void NodeBlocks::gather(const Band& band) {
    Box bounds;
    for (std::size_t n = band.walls; n < band.movable; ++n) bounds.add(band.start[n]);
    RawVector<Keyed> sorted(band.movable);
    parallelFor(band.movable, [&](std::size_t n) {
        const std::size_t at = n < band.walls ? static_cast<std::size_t>(band.frontNode[n]) : n;
        sorted[n] = {keyOf(band.start[at], band.h[at], bounds.lo), static_cast<std::int32_t>(n)};
    });
    tbb::parallel_sort(sorted);
    blockOf_.resize(band.movable);
    nodes_.resize(band.movable);
    const auto isFirst = [&](std::size_t i) { return i == 0 || sorted[i].key != sorted[i - 1].key; };
    RawVector<std::uint32_t> begun(sorted.size() + 1); // blocks before each place
    begun.back() = 0;
    parallelFor(sorted.size(), [&](std::size_t i) { begun[i] = isFirst(i); });
    kindFrom_.resize(exclusiveScan(begun));
    parallelFor(sorted.size(), [&](std::size_t i) {
        const std::uint32_t block = begun[i + 1] - 1;
        nodes_[i] = sorted[i].node;
        blockOf_[static_cast<std::size_t>(nodes_[i])] = block;
        if (isFirst(i)) kindFrom_[block].front() = i;
        if (i + 1 == sorted.size() || isFirst(i + 1)) kindFrom_[block].back() = i + 1;
    });
}

// By kind, then by colour: those of one share no corner. Gives the blocks beside each, in the order in which they are met.
std::vector<std::vector<std::uint32_t>> NodeBlocks::order(const Band& band) {
    std::vector<std::uint8_t> colourOf(band.movable, none);
    std::vector<std::vector<std::uint32_t>> beside(size());
    const auto rank = [&](std::int32_t n) { return std::pair(kindOf(band, static_cast<std::size_t>(n)), colourOf[static_cast<std::size_t>(n)]); };
    parallelFor(size(), [&](std::size_t b) {
        const std::span<std::int32_t> nodes = all(b);
        for (const std::int32_t n : nodes) {
            std::uint64_t used = 0;
            forNodesAround(band, static_cast<std::size_t>(n), [&](std::size_t m) {
                const std::uint32_t other = blockOf_[m];
                if (other == b) used |= colourOf[m] != none ? std::uint64_t(1) << colourOf[m] : 0;
                else if (std::ranges::find(beside[b], other) == beside[b].end()) beside[b].push_back(other);
            });
            colourOf[static_cast<std::size_t>(n)] = static_cast<std::uint8_t>(std::min(63, std::countr_one(used)));
        }
        std::ranges::stable_sort(nodes, {}, rank);
        for (const Kind kind : {front, core}) {
            const auto at = std::ranges::lower_bound(nodes, kind, {}, [&](std::int32_t n) { return kindOf(band, static_cast<std::size_t>(n)); });
            kindFrom_[b][kind] = kindFrom_[b].front() + static_cast<std::size_t>(at - nodes.begin());
        }
    }, 1);
    return beside;
}

// Greedy, in order.
void NodeBlocks::colour(const std::vector<std::vector<std::uint32_t>>& beside) {
    std::vector<std::uint32_t> colourOf(size(), ~0u);
    std::vector<std::uint8_t> taken;
    for (std::size_t b = 0; b < size(); ++b) {
        taken.assign(colours_.size() + 1, 0);
        for (const std::uint32_t other : beside[b])
            if (colourOf[other] != ~0u) taken[colourOf[other]] = 1;
        const auto free = static_cast<std::size_t>(std::ranges::find(taken, 0) - taken.begin());
        if (free == colours_.size()) colours_.emplace_back();
        colourOf[b] = static_cast<std::uint32_t>(free);
        colours_[free].push_back(static_cast<std::uint32_t>(b));
    }
    beside_.resize(size());
    parallelFor(size(), [&](std::size_t b) {
        for (const std::uint32_t other : beside[b]) (colourOf[other] < colourOf[b] ? beside_[b].earlier : beside_[b].later).push_back(other);
    });
}

// A turn is a block at one of the kinds. It comes after the turns of its earlier neighbours at that kind, and of its later ones and
// itself at the kind before: each of these counts it down when done, and the last one starts it.
void NodeBlocks::sweep(std::span<const Kind> kinds, const Work& work) const {
    if (kinds.empty()) return;
    struct Turn { std::uint32_t block, step; };
    const std::size_t blocks = size();
    std::vector<std::atomic<std::uint32_t>> waits(kinds.size() * blocks);
    std::vector<Turn> first;
    for (std::size_t step = 0; step < kinds.size(); ++step) {
        for (std::size_t b = 0; b < blocks; ++b)
            waits[step * blocks + b].store(static_cast<std::uint32_t>(beside_[b].earlier.size() + (step > 0 ? 1 + beside_[b].later.size() : 0)), std::memory_order_relaxed);
    }
    for (std::size_t b = 0; b < blocks; ++b)
        if (beside_[b].earlier.empty()) first.push_back({static_cast<std::uint32_t>(b), 0});
    parallelTurns(first, [&](const Turn& turn, tbb::feeder<Turn>& feeder) {
        waits[turn.step * blocks + turn.block].load(std::memory_order_acquire); // whoever works on it sees what those before have done
        work(turn.block, kinds[turn.step]);
        const auto countDown = [&](std::uint32_t block, std::size_t step) {
            if (step < kinds.size() && waits[step * blocks + block].fetch_sub(1, std::memory_order_acq_rel) == 1) feeder.add({block, static_cast<std::uint32_t>(step)});
        };
        for (const std::uint32_t other : beside_[turn.block].later) countDown(other, turn.step);
        countDown(turn.block, turn.step + 1);
        for (const std::uint32_t other : beside_[turn.block].earlier) countDown(other, turn.step + 1);
    });
}

} // namespace i2b
