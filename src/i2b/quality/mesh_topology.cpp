#include "i2b/quality/mesh_topology.h"
#include "i2b/core/parallel.h"
#include <algorithm>
#include <atomic>

namespace i2b {
namespace {

using Index = std::size_t;

std::uint32_t take(std::uint32_t& counter) {
    return std::atomic_ref<std::uint32_t>(counter).fetch_add(1, std::memory_order_relaxed);
}

// The threads race for places within a row, so every row is sorted afterwards: rows are short and almost in
// order.
template <class ForEach, class Less>
Rows buildRows(std::size_t rows, std::size_t sources, const ForEach& forEach, const Less& less) {
    Rows result;
    result.offsets.assign(rows + 1, 0);
    parallelFor(
        sources, [&](Index s) { forEach(s, [&](std::int32_t row) { take(result.offsets[Index(row)]); }); },
        4096);
    result.items.resize(exclusiveScan(result.offsets));
    std::vector<std::uint32_t> next(result.offsets.begin(), result.offsets.end() - 1);
    parallelFor(
        sources,
        [&](Index s) {
            forEach(s, [&](std::int32_t row) {
                result.items[take(next[Index(row)])] = static_cast<std::int32_t>(s);
            });
        },
        4096);
    parallelFor(
        rows,
        [&](Index row) {
            const auto begin = result.items.begin() + result.offsets[row];
            const auto end = result.items.begin() + result.offsets[row + 1];
            const auto before = [&](std::int32_t a, std::int32_t b) { return less(row, a, b); };
            if (!std::is_sorted(begin, end, before)) std::sort(begin, end, before);
        },
        4096);
    return result;
}

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

} // namespace

Rows buildCellFaces(const PolyMesh& mesh) {
    const auto internal = static_cast<std::size_t>(mesh.internalFaces());
    return buildRows(
        static_cast<std::size_t>(mesh.cells), static_cast<std::size_t>(mesh.faces()),
        [&](std::size_t f, const auto& add) {
            add(mesh.owner[f]);
            if (f < internal) add(mesh.neighbour[f]);
        },
        [&](std::size_t cell, std::int32_t a, std::int32_t b) {
            const bool ownsA = mesh.owner[Index(a)] == std::int32_t(cell);
            const bool ownsB = mesh.owner[Index(b)] == std::int32_t(cell);
            return ownsA != ownsB ? ownsA : a < b;
        });
}

Rows buildPointFaces(const PolyMesh& mesh) {
    return buildRows(
        mesh.points.size(), static_cast<std::size_t>(mesh.faces()),
        [&](std::size_t f, const auto& add) {
            for (const std::int32_t v : mesh.face(static_cast<std::int32_t>(f))) add(v);
        },
        [](std::size_t, std::int32_t a, std::int32_t b) { return a < b; });
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
