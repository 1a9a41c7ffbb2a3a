#include "i2b/core/collect.h"
#include "i2b/layers/layer_stack.h"
#include <array>

namespace i2b {
namespace {

constexpr std::size_t chunk = 4096;

// f(other) for every face that shares an edge with this one.
template <class F>
void forNeighbours(const FrontMesh& mesh, std::size_t face, const F& f) {
    for (auto he : mesh.fh_range(FrontMesh::FaceHandle(static_cast<int>(face)))) {
        const auto other = mesh.opposite_face_handle(he);
        if (other.is_valid()) f(static_cast<std::size_t>(other.idx()));
    }
}

} // namespace

// Faces that hold a neighbour down are visited by rising count, so that each is lowered to its final count at once: the
// work is in the faces beside a border alone.
void taperCounts(const FrontMesh& mesh, std::vector<std::uint8_t>& counts) {
    std::array<std::vector<std::uint32_t>, 256> byCount;
    const auto holds = [&](std::size_t f) {
        bool any = false;
        forNeighbours(mesh, f, [&](std::size_t other) { any = any || counts[other] > counts[f] + 1; });
        return any;
    };
    for (const std::uint32_t f : collect<std::uint32_t>(counts.size(), [&](std::size_t i, const auto& put) {
             if (holds(i)) put(static_cast<std::uint32_t>(i));
         }, chunk)) byCount[counts[f]].push_back(f);
    for (std::size_t count = 0; count + 1 < byCount.size(); ++count) {
        for (std::size_t i = 0; i < byCount[count].size(); ++i) {
            const std::uint32_t f = byCount[count][i];
            if (counts[f] != count) continue; // lowered since
            forNeighbours(mesh, f, [&](std::size_t other) {
                if (counts[other] <= count + 1) return;
                counts[other] = static_cast<std::uint8_t>(count + 1);
                byCount[count + 1].push_back(static_cast<std::uint32_t>(other));
            });
        }
    }
}

} // namespace i2b
