#include "i2b/repair/moved_parts.h"
#include "i2b/core/sort_unique.h"
#include "i2b/paint/union_find.h"

namespace i2b {
MovedParts::MovedParts(Optimiser& optimiser) {
    for (const auto& [node, from] : optimiser.tracked()) {
        const auto n = static_cast<std::int32_t>(nodes.size());
        nodes.push_back(node);
        const Optimiser::Star& star = optimiser.starOf(node, from.cell);
        for (const std::int32_t c : star.cells) changed.emplace_back(c, n);
        for (const std::int32_t c : star.reads) read.emplace_back(c, n);
    }
    std::sort(changed.begin(), changed.end());
    UnionFind parts(nodes.size());
    for (const auto& [cell, n] : read) // what it has changed is among it
        forPartsOf(changed, cell, [&, n = n](std::int32_t other) { parts.join(static_cast<std::uint32_t>(n), static_cast<std::uint32_t>(other)); });
    for (std::uint32_t n = 0; n < nodes.size(); ++n) partOf.push_back(static_cast<std::int32_t>(parts.find(n)));
    for (Cells* cells : {&changed, &read}) {
        for (auto& [cell, n] : *cells) n = partOf[static_cast<std::size_t>(n)];
        sortUnique(*cells);
    }
}

} // namespace i2b
