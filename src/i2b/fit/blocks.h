// The movable nodes of a band in blocks of neighbours: what a sweep of Gauss-Seidel works on. Nodes of a block are worked on one
// after the other, in order, while their corners are in the cache; blocks of one colour share no corner and go at once.
// Blocks and colours follow from the band alone, so a sweep ends the same on any number of threads.
#pragma once
#include "i2b/core/raw_vector.h"
#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace i2b {

struct Band;

class NodeBlocks {
  public:
    NodeBlocks() = default;
    // Of a band whose rows of corners are there. Stays right when prisms are divided: a wall node is of the block of its front
    // node, and the nodes of a face share corners from the start.
    explicit NodeBlocks(const Band& band);

    std::size_t size() const { return kindFrom_.size(); }
    // Of a block, in the order in which they are worked on: no move runs on through the block from one to the next.
    enum Kind : std::uint8_t { wall, front, core };
    std::span<const std::int32_t> nodes(std::size_t block, Kind kind) const {
        return {nodes_.data() + kindFrom_[block][kind], nodes_.data() + kindFrom_[block][kind + 1u]};
    }
    // Ascending numbers of blocks that share no corner.
    const std::vector<std::vector<std::uint32_t>>& colours() const { return colours_; }
    // work(block, kind) for all blocks, kind by kind and colour by colour; but no block waits for others than those that it shares
    // corners with, which come to the same.
    using Work = std::function<void(std::size_t, Kind)>;
    void sweep(std::span<const Kind> kinds, const Work& work) const;

  private:
    void gather(const Band& band);
    std::vector<std::vector<std::uint32_t>> order(const Band& band);
    void colour(const std::vector<std::vector<std::uint32_t>>& beside);
    std::span<std::int32_t> all(std::size_t block) { return {nodes_.data() + kindFrom_[block].front(), nodes_.data() + kindFrom_[block].back()}; }

    RawVector<std::int32_t> nodes_;                       // block by block, kind by kind
    std::vector<std::array<std::size_t, 4>> kindFrom_;    // per block: where each kind begins, and where the block ends
    RawVector<std::uint32_t> blockOf_;                    // per node, while these are found
    std::vector<std::vector<std::uint32_t>> colours_;
    struct Beside { std::vector<std::uint32_t> earlier, later; }; // blocks of lower and of higher colours that share corners
    std::vector<Beside> beside_;                          // per block
};

} // namespace i2b
