#include "i2b/core/flags.h"
#include "i2b/core/give_up.h"
#include "i2b/quality/measure_steps.h"
#include <algorithm>
#include <array>
#include <atomic>
#include <functional>
#include <tbb/parallel_sort.h>

namespace i2b {
namespace {

using Index = std::size_t;

// Points that may have another one nearby: all whose cell of a coarse lattice, or one that they nearly reach, is that of
// another point, too, or so the cell's hash says. It errs to one side only: different cells may have one hash. Hashes are
// shared out by their high bits first, so that the table of bits that tells which comes twice is small and near.
class Crowded {
  public:
    Crowded(std::span<const Vec3> points, double reach) : points_(points), reach_(reach) {}

    std::vector<std::int32_t> find() const { // in no order, with repetitions
        const Index chunks = (points_.size() + chunk - 1) / chunk;
        std::vector<std::vector<Entry>> sorted(chunks); // of each chunk, share after share
        std::vector<std::array<std::uint32_t, shares + 1>> starts(chunks);
        parallelChunks(points_.size(), chunk, [&](Index begin, Index end, Index c) { shareOut(begin, end, sorted[c], starts[c]); });
        std::vector<std::vector<std::int32_t>> found(shares);
        parallelFor(shares, [&](Index share) { found[share] = findTwice(sorted, starts, share); }, 1);
        std::vector<std::int32_t> all;
        for (const auto& some : found) all.insert(all.end(), some.begin(), some.end());
        return all;
    }

  private:
    static constexpr double cellsPerReach = 1.0 / 61; // lattices of meshes have other spacings
    static constexpr Index chunk = Index(1) << 16, shares = 128;
    struct Entry {
        std::uint32_t hash;
        std::int32_t point;
    };

    void shareOut(Index begin, Index end, std::vector<Entry>& sorted, std::array<std::uint32_t, shares + 1>& starts) const {
        std::vector<Entry> entries;
        entries.reserve(end - begin);
        starts.fill(0);
        for (Index i = begin; i < end; ++i)
            forCells(points_[i], [&](std::uint32_t hash) {
                entries.push_back({hash, static_cast<std::int32_t>(i)});
                ++starts[shareOf(hash) + 1];
            });
        for (Index s = 0; s < shares; ++s) starts[s + 1] += starts[s];
        std::array<std::uint32_t, shares + 1> next = starts;
        sorted.resize(entries.size());
        for (const Entry& e : entries) sorted[next[shareOf(e.hash)]++] = e;
    }

    std::vector<std::int32_t> findTwice(const std::vector<std::vector<Entry>>& sorted,
                                        const std::vector<std::array<std::uint32_t, shares + 1>>& starts, Index share) const {
        Index bits = Index(1) << 12; // about 32 for each point
        while (bits < 32 * points_.size() / shares && bits < Index(1) << 25) bits *= 2;
        std::vector<std::uint64_t> once(bits / 64), twice(bits / 64);
        const auto forEntries = [&](const auto& body) {
            for (Index c = 0; c < sorted.size(); ++c)
                for (Index i = starts[c][share]; i < starts[c][share + 1]; ++i) body(sorted[c][i]);
        };
        const auto slotOf = [&](const Entry& e) { return Index(e.hash) & (bits - 1); };
        forEntries([&](const Entry& e) {
            const Index slot = slotOf(e);
            const std::uint64_t bit = std::uint64_t(1) << (slot % 64);
            twice[slot / 64] |= once[slot / 64] & bit;
            once[slot / 64] |= bit;
        });
        std::vector<std::int32_t> found;
        forEntries([&](const Entry& e) {
            const Index slot = slotOf(e);
            if ((twice[slot / 64] >> (slot % 64) & 1) != 0) found.push_back(e.point);
        });
        return found;
    }

    static Index shareOf(std::uint32_t hash) { return hash >> 25; }

    // All cells within reach of p, each once: mostly one.
    template <class Body>
    void forCells(const Vec3& p, const Body& body) const {
        const double scale = cellsPerReach / reach_;
        std::array<std::int64_t, 3> lo, hi;
        for (int k = 0; k < 3; ++k) {
            lo[Index(k)] = cellOf((p[k] - reach_) * scale);
            hi[Index(k)] = cellOf((p[k] + reach_) * scale);
        }
        for (std::int64_t x = lo[0]; x <= hi[0]; ++x)
            for (std::int64_t y = lo[1]; y <= hi[1]; ++y)
                for (std::int64_t z = lo[2]; z <= hi[2]; ++z) body(hashOf(x, y, z));
    }
    static std::int64_t cellOf(double x) {
        if (!(std::abs(x) < 1e18)) return 0; // no number, or out of all proportion
        const auto whole = static_cast<std::int64_t>(x);
        return static_cast<double>(whole) > x ? whole - 1 : whole;
    }
    static std::uint32_t hashOf(std::int64_t x, std::int64_t y, std::int64_t z) {
        std::uint64_t h = std::uint64_t(x) * 0x9e3779b97f4a7c15U;
        h = (h ^ (h >> 29) ^ std::uint64_t(y)) * 0xbf58476d1ce4e5b9U;
        h = (h ^ (h >> 31) ^ std::uint64_t(z)) * 0x94d049bb133111ebU;
        return static_cast<std::uint32_t>(h >> 32);
    }

    std::span<const Vec3> points_;
    double reach_;
};

struct Near {
    double key;
    std::int32_t point;
};
// Marks the ends of all pairs closer than the distance. Sorted along an odd direction, near points are near
// in the list, and regular meshes do not put whole planes of points at one key. checkMesh names a pair only
// if the squared distances of its points from the origin differ by less than near2 too; hence the last test.
void markNear(std::span<const Vec3> points, double near2, std::vector<std::uint8_t>& marks) {
    const Vec3 direction = normalized({0.5377, 0.6180339887, 0.5731});
    if (!(near2 > 0)) return; // nothing is nearer
    const double reach = std::sqrt(near2) * 1.001;
    const std::vector<std::int32_t> crowded = Crowded(points, reach).find();
    std::vector<Near> list(crowded.size());
    parallelFor(
        crowded.size(), [&](Index i) { list[i] = {dot(direction, points[Index(crowded[i])]), crowded[i]}; }, 4096);
    tbb::parallel_sort(list.begin(), list.end(), [](const Near& a, const Near& b) {
        return a.key < b.key || (a.key == b.key && a.point < b.point);
    });
    parallelFor(
        list.size(),
        [&](Index i) {
            const Vec3& p = points[Index(list[i].point)];
            const double size2 = norm2(p);
            for (Index j = i + 1; j < list.size() && list[j].key - list[i].key <= reach; ++j) {
                if (list[j].point == list[i].point) continue; // of two cells
                const Vec3& q = points[Index(list[j].point)];
                if (!(norm2(p - q) < near2)) continue;
                const double other2 = norm2(q);
                if (!(std::min(size2, other2) > std::max(size2, other2) - near2)) continue;
                for (const std::int32_t k : {list[i].point, list[j].point})
                    setFlag(marks[Index(k)]);
            }
        },
        4096);
}

struct EdgeCounts {
    std::int64_t all = 0, internal = 0, onePoint = 0, twoPoints = 0;
    void join(const EdgeCounts& o) {
        all += o.all, internal += o.internal, onePoint += o.onePoint, twoPoints += o.twoPoints;
    }
};

enum Use : std::uint8_t { none, inner, atBoundary };

// Per point: has it no face, internal ones only, or others as well?
std::vector<std::uint8_t> usesOf(const PolyMesh& mesh) {
    std::vector<std::uint8_t> uses(mesh.points.size(), none);
    const auto mark = [&](Index begin, Index end, Use use) {
        parallelFor(end - begin, [&](Index i) {
            for (const std::int32_t p : mesh.face(static_cast<std::int32_t>(begin + i))) {
                std::atomic_ref own(uses[Index(p)]);
                if (own.load(std::memory_order_relaxed) != use) own.store(use, std::memory_order_relaxed);
            }
        }, 4096);
    };
    mark(0, mesh.neighbour.size(), inner);
    mark(mesh.neighbour.size(), mesh.owner.size(), atBoundary);
    return uses;
}

// The edges, which checkMesh counts only if the internal points come first.
void countEdges(Measurement& m, const std::vector<std::uint8_t>& uses) {
    const PolyMesh& mesh = m.mesh;
    const std::int32_t internalFaces = mesh.internalFaces();
    const auto internal = std::ranges::count_if(uses, [](std::uint8_t use) { return use != atBoundary; });
    if (std::find(uses.begin() + internal, uses.end(), inner) != uses.end()) return;
    const Rows pointFaces = buildPointFaces(mesh);
    const auto isOnBoundary = [&](Index p) { return uses[p] == atBoundary ? 1 : 0; };
    EdgeCounts total;
    orderedLoop(mesh.points.size(), total, [&](Index begin, Index end, EdgeCounts& part) {
        std::vector<std::pair<std::int32_t, bool>> ends; // higher end; not on this boundary face
        for (Index p = begin; p < end; ++p) {
            const auto point = static_cast<std::int32_t>(p);
            ends.clear();
            for (const std::int32_t f : pointFaces[point]) {
                const std::span<const std::int32_t> v = mesh.face(f);
                for (Index i = 0; i < v.size(); ++i) {
                    if (v[i] != point) continue;
                    for (const std::int32_t q :
                         {v[i + 1 == v.size() ? 0 : i + 1], v[i == 0 ? v.size() - 1 : i - 1]})
                        if (q > point) ends.emplace_back(q, f < internalFaces);
                }
            }
            std::sort(ends.begin(), ends.end());
            for (Index i = 0; i < ends.size(); ++i) {
                if (i > 0 && ends[i].first == ends[i - 1].first) continue;
                ++part.all;
                if (!ends[i].second) continue; // the boundary faces of an edge sort first
                const int boundaryPoints = isOnBoundary(p) + isOnBoundary(Index(ends[i].first));
                ++part.internal;
                part.onePoint += boundaryPoints == 1 ? 1 : 0;
                part.twoPoints += boundaryPoints == 2 ? 1 : 0;
            }
        }
    });
    MeshStatistics& s = m.report.statistics;
    s.internalPoints = internal;
    s.edges = total.all, s.internalEdges = total.internal;
    s.internalEdgesOnePoint = total.onePoint, s.internalEdgesTwoPoints = total.twoPoints;
}

} // namespace

void measurePoints(Measurement& m) {
    const std::vector<std::uint8_t> uses = usesOf(m.mesh);
    orderedLoop(uses.size(), m.tallies.unusedPoints, [&](Index begin, Index end, Tally& part) {
        for (Index p = begin; p < end; ++p)
            if (uses[p] == none) part.hit(static_cast<std::int32_t>(p));
    });
    m.report.unusedPoints = m.tallies.unusedPoints.count;
    countEdges(m, uses);
}

void measureNearPoints(Measurement& m) {
    const PolyMesh& mesh = m.mesh;
    markNear(mesh.points, nearDistanceSquared(m.report.box), m.shortPoints);
    Tally near = tallyMarks(m.shortPoints);
    if (near.count > m.report.shortEdgePoints) m.tallies.nearPoints = std::move(near);
    giveUp(m.shortPoints);
}

} // namespace i2b
