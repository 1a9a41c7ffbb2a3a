#include "i2b/assemble/mesh_topology.h"
#include "i2b/core/parallel.h"
#include <algorithm>
#include <atomic>
#include <tbb/task_arena.h>

namespace i2b {
namespace {

using Index = std::size_t;

// Each task takes a stretch of the rows and reads all sources in order: rows come out in order without
// sorting and without atomics, and reading twice costs less than either. More than a few tasks would only
// read more. forEach(s, add) calls add(row) for each row that source s goes into; the passes follow each
// other within a row.
template <class... Passes>
Rows buildRows(std::size_t rows, const Passes&... passes) {
    Rows result;
    result.offsets.assign(rows + 1, 0);
    const auto tasks = static_cast<std::size_t>(std::clamp(tbb::this_task_arena::max_concurrency(), 1, 8));
    const auto forStretches = [&](const auto& body) {
        tbb::parallel_for(std::size_t(0), tasks, [&](std::size_t t) {
            const auto begin = static_cast<std::uint32_t>(rows * t / tasks);
            const auto size = static_cast<std::uint32_t>(rows * (t + 1) / tasks) - begin;
            const auto inside = [&](std::int32_t row) {
                return static_cast<std::uint32_t>(row) - begin < size;
            };
            (passes([&](std::int32_t row, std::size_t source) {
                 if (inside(row)) body(Index(row), source);
             }),
             ...);
        });
    };
    forStretches([&](Index row, std::size_t) { ++result.offsets[row]; });
    result.items.resize(exclusiveScan(result.offsets));
    std::vector<std::uint32_t> next(result.offsets.begin(), result.offsets.end() - 1);
    forStretches([&](Index row, std::size_t source) {
        result.items[next[row]++] = static_cast<std::int32_t>(source);
    });
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
    const auto each = [](std::span<const std::int32_t> cells) {
        return [cells](const auto& add) {
            for (Index f = 0; f < cells.size(); ++f) add(cells[f], f);
        };
    };
    return buildRows(static_cast<std::size_t>(mesh.cells), each(mesh.owner), each(mesh.neighbour));
}

Rows buildPointFaces(const PolyMesh& mesh) {
    return buildRows(mesh.points.size(), [&](const auto& add) {
        for (Index f = 0; f < mesh.owner.size(); ++f)
            for (Index i = mesh.faceOffsets[f]; i < mesh.faceOffsets[f + 1]; ++i)
                add(mesh.faceVertices[i], f);
    });
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
