// Counting what fails a check, in parallel and yet in order: each chunk of a loop keeps a tally of its own,
// and the tallies are joined in the order of the chunks.
#pragma once
#include "i2b/core/parallel.h"
#include "i2b/core/side_by_side.h"
#include <cstdint>
#include <limits>
#include <vector>

namespace i2b {

struct Tally {
    static constexpr std::size_t idLimit = 1000; // ids kept
    std::int64_t count = 0;
    std::vector<std::int32_t> ids;
    double worst = -std::numeric_limits<double>::infinity();
    std::int32_t worstId = -1;

    // Ids come in ascending order; the larger badness, the worse; of equals the first stays.
    void hit(std::int32_t id, double badness = 0) {
        ++count;
        if (ids.size() < idLimit) ids.push_back(id);
        if (worstId < 0 || badness > worst) worst = badness, worstId = id;
    }
    void join(const Tally& next) {
        if (next.count == 0) return;
        count += next.count;
        for (const std::int32_t id : next.ids) {
            if (ids.size() >= idLimit) break;
            ids.push_back(id);
        }
        if (worstId < 0 || next.worst > worst) worst = next.worst, worstId = next.worstId;
    }
};

struct Extremes {
    double least = std::numeric_limits<double>::infinity();
    double most = -std::numeric_limits<double>::infinity();

    void add(double v) {
        if (v < least) least = v;
        if (v > most) most = v;
    }
    void join(const Extremes& o) {
        if (o.least < least) least = o.least;
        if (o.most > most) most = o.most;
    }
};

// Loops over [0, n) in blocks; body(begin, end, part) over the fixed chunks of a block in parallel, then
// their parts join total in order. afterBlock(begin, end) on one thread, block after block, while the others are at the next:
// there the values of a block are summed one by one, since only a plain sum has the round-off of a plain sum.
template <class Part, class Body, class AfterBlock>
void orderedBlocks(std::size_t n, std::size_t block, Part& total, const Body& body,
                   const AfterBlock& afterBlock) {
    constexpr std::size_t chunk = 2048;
    for (std::size_t begin = 0; begin < n; begin += block) {
        const std::size_t end = begin + block < n ? begin + block : n;
        std::vector<Part> parts((end - begin + chunk - 1) / chunk);
        const auto measure = [&] {
            parallelChunks(end - begin, chunk, [&](std::size_t b, std::size_t e, std::size_t c) { body(begin + b, begin + e, parts[c]); });
        };
        if (begin == 0) measure();
        else sideBySide(measure, [&] { afterBlock(begin - block, begin); });
        for (const Part& part : parts) total.join(part);
    }
    if (n > 0) afterBlock((n - 1) / block * block, n);
}

template <class Part, class Body>
void orderedLoop(std::size_t n, Part& total, const Body& body) {
    orderedBlocks(n, n == 0 ? 1 : n, total, body, [](std::size_t, std::size_t) {});
}

} // namespace i2b
