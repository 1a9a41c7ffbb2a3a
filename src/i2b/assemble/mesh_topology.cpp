#include "i2b/assemble/mesh_topology.h"
#include "i2b/core/rows.h"
#include <algorithm>
#include <atomic>
#include <numeric>

namespace i2b {
namespace {

using Index = std::size_t;

// Root of the tree that cell c hangs in. Halves the path on the way; a stale parent is still an ancestor.
std::int32_t findRoot(std::vector<std::int32_t>& parent, std::int32_t c) {
    for (;;) {
        std::atomic_ref<std::int32_t> mine(parent[Index(c)]);
        const std::int32_t p = mine.load(std::memory_order_relaxed);
        if (p == c) return c;
        const std::int32_t grand =
            std::atomic_ref<std::int32_t>(parent[Index(p)]).load(std::memory_order_relaxed);
        if (grand == p) return p;
        mine.store(grand, std::memory_order_relaxed);
        c = grand;
    }
}

// Always hangs the higher root below the lower one, so that the last root standing is the lowest cell.
void unite(std::vector<std::int32_t>& parent, std::int32_t a, std::int32_t b) {
    for (;;) {
        a = findRoot(parent, a);
        b = findRoot(parent, b);
        if (a == b) return;
        if (a < b) std::swap(a, b);
        std::int32_t expected = a;
        if (std::atomic_ref<std::int32_t>(parent[Index(a)])
                .compare_exchange_strong(expected, b, std::memory_order_relaxed))
            return;
    }
}

// Per cell the first of the internal faces that it or a later one owns, and their end; empty where these faces do not follow each
// other owner by owner, as they do in OpenFOAM's order.
RawVector<std::uint32_t> ownedRuns(const PolyMesh& mesh) {
    const Index internal = mesh.neighbour.size(), cells = Index(mesh.cells);
    const bool inOrder = orderedReduce(
        internal, true,
        [&](Index begin, Index end) { return std::is_sorted(mesh.owner.begin() + std::ptrdiff_t(begin), mesh.owner.begin() + std::ptrdiff_t(std::min(end + 1, internal))); },
        [](bool a, bool b) { return a && b; });
    RawVector<std::uint32_t> first;
    if (!inOrder) return first;
    first.resize(cells + 1);
    parallelFor(internal + 1, [&](Index f) { // the cells from the face before's owner to its own
        const Index from = f == 0 ? 0 : Index(mesh.owner[f - 1]) + 1, to = f == internal ? cells + 1 : Index(mesh.owner[f]) + 1;
        for (Index c = from; c < to; ++c) first[c] = static_cast<std::uint32_t>(f);
    }, 4096);
    return first;
}

} // namespace

Rows buildCellFaces(const PolyMesh& mesh) {
    const Index internal = mesh.neighbour.size(), cells = Index(mesh.cells);
    const RawVector<std::uint32_t> own = ownedRuns(mesh);
    const auto cellsOf = [&](Index f, const auto& put) { // but for the runs
        if (own.empty() || f >= internal) put(Index(mesh.owner[f]));
        if (f < internal) put(Index(mesh.neighbour[f]));
    };
    const auto ownedFirst = [&](Index cell, std::int32_t a, std::int32_t b) {
        const bool owns = Index(mesh.owner[Index(a)]) == cell, other = Index(mesh.owner[Index(b)]) == cell;
        return owns != other ? owns : a < b;
    };
    Rows others;
    turnIntoRows(cells, 0, mesh.owner.size(), cellsOf, ownedFirst, others.offsets, others.items);
    if (own.empty()) return others;
    Rows rows;
    rows.offsets.resize(cells + 1);
    rows.items.resize(others.items.size() + internal);
    parallelFor(cells + 1, [&](Index c) {
        rows.offsets[c] = own[c] + others.offsets[c];
        if (c == cells) return;
        std::int32_t* const row = rows.items.data() + rows.offsets[c];
        const std::uint32_t owned = own[c + 1] - own[c];
        std::iota(row, row + owned, static_cast<std::int32_t>(own[c]));
        std::copy(others.items.data() + others.offsets[c], others.items.data() + others.offsets[c + 1], row + owned);
    }, 4096);
    return rows;
}

Rows buildPointFaces(const PolyMesh& mesh) {
    Rows rows;
    const auto pointsOf = [&](Index f, const auto& put) {
        for (const std::int32_t p : mesh.face(static_cast<std::int32_t>(f))) put(Index(p));
    };
    turnIntoRows(mesh.points.size(), 0, mesh.owner.size(), pointsOf, rows.offsets, rows.items);
    return rows;
}

std::vector<std::int32_t> regionRoots(const PolyMesh& mesh) {
    std::vector<std::int32_t> parent(static_cast<std::size_t>(mesh.cells));
    parallelFor(
        parent.size(), [&](std::size_t c) { parent[c] = static_cast<std::int32_t>(c); }, 4096);
    parallelFor(
        mesh.neighbour.size(), [&](std::size_t f) { unite(parent, mesh.owner[f], mesh.neighbour[f]); }, 4096);
    std::vector<std::int32_t> root(parent.size());
    parallelFor(
        root.size(), [&](std::size_t c) { root[c] = findRoot(parent, static_cast<std::int32_t>(c)); }, 4096);
    return root;
}

} // namespace i2b
