// Nodes with nowhere to go: those that stayed where they are when they were last asked, while nothing around them has moved since.
// Asking them again would cost as much as the first time and end the same way.
#pragma once
#include "i2b/repair/mesh_nodes.h"
#include <algorithm>
#include <map>
#include <unordered_map>
#include <vector>

namespace i2b {

// Of one kind of move; for as long as nothing else moves nodes. Its size goes with the nodes asked, not with the mesh.
class RestingNodes {
  public:
    // reads: all cells that the answer depends on.
    bool has(const MeshNode& node, const std::vector<std::int32_t>& reads) const {
        const auto at = stayed_.find(node);
        return at != stayed_.end() && std::ranges::all_of(reads, [&](std::int32_t c) {
                   const auto changed = changed_.find(c);
                   return changed == changed_.end() || changed->second <= at->second;
               });
    }
    void stays(const MeshNode& node) { stayed_[node] = now_; }
    void moves(const std::vector<std::int32_t>& cells) { // all that use a point of the node
        for (const std::int32_t c : cells) changed_[c] = now_;
    }
    void next() { ++now_; } // the ones before were asked at once, none of them reading what another changed

  private:
    std::map<MeshNode, std::uint32_t> stayed_;
    std::unordered_map<std::int32_t, std::uint32_t> changed_;
    std::uint32_t now_ = 0;
};

} // namespace i2b
