#include "i2b/assemble/poly_mesh.h"
#include "i2b/core/checksum.h"
#include "i2b/core/flags.h"
#include <algorithm>
#include <atomic>
#include <fmt/format.h>

namespace i2b {
namespace {

using Index = std::size_t;

// Lowest index in [0, n) for which fault(i), or n. The same on any number of threads.
template <class Fault>
Index firstFault(Index n, const Fault& fault) {
    return orderedReduce(
        n, n,
        [&](Index begin, Index end) {
            for (Index i = begin; i < end; ++i)
                if (fault(i)) return i;
            return n;
        },
        [](Index a, Index b) { return std::min(a, b); });
}

std::string sizeFault(const PolyMesh& m) {
    const Index faces = m.owner.size(), cells = static_cast<Index>(std::max(m.cells, 0));
    if (m.cells < 0) return fmt::format("the number of cells is {}", m.cells);
    if (m.faceOffsets.size() != faces + 1)
        return fmt::format("{} face offsets for {} faces (one more than faces needed)", m.faceOffsets.size(),
                           faces);
    if (m.faceOffsets.front() != 0 || m.faceOffsets.back() != m.faceVertices.size())
        return fmt::format("face offsets run from {} to {}, but there are {} face vertices",
                           m.faceOffsets.front(), m.faceOffsets.back(), m.faceVertices.size());
    if (m.neighbour.size() > faces)
        return fmt::format("{} neighbours for {} faces", m.neighbour.size(), faces);
    for (const auto& [name, size] :
         {std::pair("level", m.cellLevel.size()), std::pair("layer", m.cellLayer.size()),
          std::pair("region", m.cellRegion.size())})
        if (size != 0 && size != cells)
            return fmt::format("{} values of cell {} for {} cells", size, name, cells);
    return {};
}

std::string rangeFault(const PolyMesh& m) {
    const Index faces = m.owner.size();
    Index at = firstFault(faces, [&](Index f) { return m.faceOffsets[f + 1] < m.faceOffsets[f] + 3; });
    if (at < faces) return fmt::format("face {} has fewer than 3 vertices", at);
    at = firstFault(m.faceVertices.size(), [&](Index i) {
        return m.faceVertices[i] < 0 || static_cast<Index>(m.faceVertices[i]) >= m.points.size();
    });
    if (at < m.faceVertices.size())
        return fmt::format("face vertex {} is point {}, of {} points", at, m.faceVertices[at],
                           m.points.size());
    at = firstFault(faces, [&](Index f) { return m.owner[f] < 0 || m.owner[f] >= m.cells; });
    if (at < faces) return fmt::format("face {} is owned by cell {}, of {} cells", at, m.owner[at], m.cells);
    at = firstFault(m.neighbour.size(),
                    [&](Index f) { return m.neighbour[f] < 0 || m.neighbour[f] >= m.cells; });
    if (at < m.neighbour.size())
        return fmt::format("face {} has the neighbour {}, of {} cells", at, m.neighbour[at], m.cells);
    at = firstFault(m.points.size(), [&](Index p) { return !isFinite(m.points[p]); });
    if (at < m.points.size()) return fmt::format("point {} is not finite", at);
    return {};
}

std::string orderFault(const PolyMesh& m) {
    const Index internal = m.neighbour.size();
    Index at = firstFault(internal, [&](Index f) { return m.owner[f] >= m.neighbour[f]; });
    if (at < internal)
        return fmt::format("face {} has the owner {}, not lower than its neighbour {}", at, m.owner[at],
                           m.neighbour[at]);
    at = firstFault(internal, [&](Index f) {
        return f > 0 && std::pair(m.owner[f - 1], m.neighbour[f - 1]) > std::pair(m.owner[f], m.neighbour[f]);
    });
    if (at < internal) return fmt::format("face {} is not in upper triangular order", at);
    auto next = static_cast<std::int64_t>(internal);
    for (const Patch& patch : m.patches) {
        if (patch.start != next || patch.count < 0)
            return fmt::format("patch {} has {} faces from {}, but starts at {}", patch.name, patch.count,
                               patch.start, next);
        next += patch.count;
    }
    if (next != m.faces()) return fmt::format("the patches end at face {}, the mesh at {}", next, m.faces());
    for (const CellZone& zone : m.zones)
        for (Index i = 0; i < zone.cells.size(); ++i)
            if (zone.cells[i] < 0 || zone.cells[i] >= m.cells ||
                (i > 0 && zone.cells[i] <= zone.cells[i - 1]))
                return fmt::format("zone {}: cell {} is out of range or order", zone.name, zone.cells[i]);
    return {};
}

std::string pointFault(const PolyMesh& m) {
    const Index faces = m.owner.size();
    Index at = firstFault(faces, [&](Index f) {
        const auto v = m.face(static_cast<std::int32_t>(f));
        for (Index i = 1; i < v.size(); ++i)
            if (std::find(v.begin(), v.begin() + static_cast<std::ptrdiff_t>(i), v[i]) !=
                v.begin() + static_cast<std::ptrdiff_t>(i))
                return true;
        return false;
    });
    if (at < faces) return fmt::format("face {} uses a point twice", at);
    std::vector<std::uint8_t> used(m.points.size(), 0);
    parallelFor(
        m.faceVertices.size(), [&](Index i) { setFlag(used[Index(m.faceVertices[i])]); }, 4096);
    at = firstFault(used.size(), [&](Index p) { return used[p] == 0; });
    if (at < used.size()) return fmt::format("point {} is used by no face", at);
    return {};
}

// A closed cell passes every edge as often one way as the other. Each directed edge adds a mixed number of
// its ends, negative the other way; the sums of all cells being zero says so but for a chance of 1 in 2^64.
// Sums of integers do not depend on the order of threads.
std::uint64_t edgeNumber(std::int32_t a, std::int32_t b) {
    std::uint64_t x = (std::uint64_t(std::uint32_t(std::min(a, b))) << 32) | std::uint32_t(std::max(a, b));
    x = (x ^ (x >> 31)) * 0x9E3779B97F4A7C15ULL;
    x = (x ^ (x >> 29)) * 0xBF58476D1CE4E5B9ULL;
    x ^= x >> 32;
    return a < b ? x : 0 - x;
}

std::string closedFault(const PolyMesh& m) {
    std::vector<std::uint64_t> sums(static_cast<Index>(m.cells), 0);
    std::vector<std::uint8_t> sides(static_cast<Index>(m.cells), 0); // faces, at most 4 counted
    const auto add = [&](std::int32_t cell, std::uint64_t value) {
        std::atomic_ref<std::uint64_t>(sums[Index(cell)]).fetch_add(value, std::memory_order_relaxed);
        std::atomic_ref<std::uint8_t> count(sides[Index(cell)]);
        if (count.load(std::memory_order_relaxed) < 4) count.fetch_add(1, std::memory_order_relaxed);
    };
    parallelFor(m.owner.size(), [&](Index f) {
        const auto v = m.face(static_cast<std::int32_t>(f));
        std::uint64_t sum = 0;
        for (Index i = 0; i < v.size(); ++i) sum += edgeNumber(v[i], v[i + 1 == v.size() ? 0 : i + 1]);
        add(m.owner[f], sum);
        if (f < m.neighbour.size()) add(m.neighbour[f], 0 - sum);
    });
    Index at = firstFault(sides.size(), [&](Index c) { return sides[c] < 4; });
    if (at < sides.size()) return fmt::format("cell {} has fewer than 4 faces", at);
    at = firstFault(sums.size(), [&](Index c) { return sums[c] != 0; });
    if (at < sums.size())
        return fmt::format("cell {} is not closed: its faces do not share all edges in pairs", at);
    return {};
}

} // namespace

std::string PolyMesh::validate() const {
    for (const auto check : {sizeFault, rangeFault, orderFault, pointFault, closedFault})
        if (std::string fault = check(*this); !fault.empty()) return fault;
    return {};
}

std::uint64_t PolyMesh::checksum() const {
    Checksum sum;
    sum.add(std::span<const Vec3>(points));
    sum.add(std::span<const std::uint32_t>(faceOffsets));
    sum.add(std::span<const std::int32_t>(faceVertices));
    sum.add(std::span<const std::int32_t>(owner));
    sum.add(std::span<const std::int32_t>(neighbour));
    sum.add(cells);
    for (const Patch& patch : patches) {
        sum.add(std::string_view(patch.name));
        sum.add(std::string_view(patch.type));
        sum.add(patch.start);
        sum.add(patch.count);
    }
    for (const CellZone& zone : zones) {
        sum.add(std::string_view(zone.name));
        sum.add(std::span<const std::int32_t>(zone.cells));
    }
    return sum.value();
}

} // namespace i2b
