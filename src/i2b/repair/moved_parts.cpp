#include "i2b/repair/moved_parts.h"
#include "i2b/core/sort_unique.h"

namespace i2b {
namespace {

// Sets of numbers, each known by its least.
class Sets {
  public:
    explicit Sets(std::vector<std::int32_t>& parents) : parents_(parents) {}
    std::int32_t of(std::int32_t n) {
        std::int32_t* parent = &parents_[static_cast<std::size_t>(n)];
        while (*parent != n) n = *parent = parents_[static_cast<std::size_t>(*parent)], parent = &parents_[static_cast<std::size_t>(n)];
        return n;
    }
    void unite(std::int32_t a, std::int32_t b) {
        a = of(a), b = of(b);
        parents_[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
    }

  private:
    std::vector<std::int32_t>& parents_;
};

} // namespace

MovedParts::MovedParts(Optimiser& optimiser) {
    for (const auto& [node, from] : optimiser.tracked()) {
        const auto n = static_cast<std::int32_t>(nodes.size());
        nodes.push_back(node), partOf.push_back(n);
        const Optimiser::Star& star = optimiser.starOf(node, from.cell);
        for (const std::int32_t c : star.cells) changed.emplace_back(c, n);
        for (const std::int32_t c : star.reads) read.emplace_back(c, n);
    }
    std::sort(changed.begin(), changed.end());
    Sets sets(partOf);
    for (const auto& [cell, n] : read) // what it has changed is among it
        forPartsOf(changed, cell, [&, n = n](std::int32_t other) { sets.unite(n, other); });
    for (std::int32_t& part : partOf) part = sets.of(part);
    for (Cells* cells : {&changed, &read}) {
        for (auto& [cell, n] : *cells) n = partOf[static_cast<std::size_t>(n)];
        sortUnique(*cells);
    }
}

} // namespace i2b
