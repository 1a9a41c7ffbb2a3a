// Nodes that have moved (Optimiser::tracked()), in parts that can go back each by itself: none has changed a cell by which a node of
// another is judged.
#pragma once
#include "i2b/repair/optimise.h"
#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

namespace i2b {

struct MovedParts {
    explicit MovedParts(Optimiser& optimiser);

    using Cells = std::vector<std::pair<std::int32_t, std::int32_t>>; // and parts, ascending
    std::vector<MeshNode> nodes;      // ascending
    std::vector<std::int32_t> partOf; // per node: the first one of its part, by which the part goes
    Cells changed, read;              // cells that parts have changed, and those by which they are judged

    // f(part), of each that has the cell.
    template <class F>
    static void forPartsOf(const Cells& cells, std::int32_t cell, const F& f) {
        for (auto at = std::ranges::lower_bound(cells, std::pair{cell, std::int32_t(-1)}); at != cells.end() && at->first == cell; ++at) f(at->second);
    }
};

} // namespace i2b
