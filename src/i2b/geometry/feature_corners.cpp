#include "i2b/geometry/feature_corners.h"
#include "i2b/core/collect.h"
#include "i2b/core/parallel_sort_unique.h"
#include "i2b/core/rows.h"
#include "i2b/geometry/feature_edges.h"
#include <algorithm>

namespace i2b {
namespace {

// What meets at a point, seen from it.
struct Meeting {
    std::uint32_t lines = 0; // edges of lineKinds
    bool named = false;      // one of them by the user
    bool rim = false;        // one of them a rim
    Vec3 first, second;      // directions of two of them
    // One edge only, but a milder fold goes straight on, or behind a rim a crack: a line that fades, no corner.
    bool continued = false;
};

bool isFree(const FeatureEdge& e) { return (e.kinds & bitOf(EdgeKind::free)) != 0; }

// The points where lines meet, and what meets there.
class Meetings {
  public:
    Meetings(std::span<const Vec3> points, const RawVector<FeatureEdge>& lines) : points_(points), places_(2 * lines.size()) {
        parallelFor(lines.size(), [&](std::size_t i) { places_[2 * i] = lines[i].a, places_[2 * i + 1] = lines[i].b; }, 4096);
        parallelSortUnique(places_);
        RawVector<std::uint32_t> start;
        RawVector<std::int32_t> ends; // two for each line
        const auto pointOf = [&](std::size_t end) { return end % 2 == 0 ? lines[end / 2].a : lines[end / 2].b; };
        turnIntoRows(places_.size(), 0, 2 * lines.size(), [&](std::size_t end, const auto& put) { put(find(pointOf(end))); }, start, ends);
        meetings_.resize(places_.size());
        parallelFor(places_.size(), [&](std::size_t p) {
            Meeting& m = meetings_[p];
            for (std::uint32_t i = start[p]; i < start[p + 1]; ++i) {
                const auto end = static_cast<std::size_t>(ends[i]);
                const FeatureEdge& e = lines[end / 2];
                (m.lines++ == 0 ? m.first : m.second) = away(e, end % 2 == 0);
                m.rim = m.rim || (e.kinds & bitOf(EdgeKind::rim));
                m.named = m.named || (e.kinds & bitOf(EdgeKind::named));
            }
        }, 512);
    }
    // The ends of milder folds and free edges, of which a single line may go on in some. A tessellated radius folds by a little more
    // here, a little less there than the limit: its line is cut in pieces then, whose ends would make most of the corners of a
    // curved body.
    void continueIn(const RawVector<FeatureEdge>& milder, double limit) {
        parallelFor(milder.size(), [&](std::size_t i) {
            const FeatureEdge& e = milder[i];
            for (const bool fromA : {true, false}) {
                const std::uint32_t point = fromA ? e.a : e.b;
                const std::size_t at = find(point);
                if (at == places_.size() || places_[at] != point) continue;
                Meeting& m = meetings_[at];
                if (m.lines == 1 && !m.named && m.rim == isFree(e) && fold(m.first, away(e, fromA)) <= limit)
                    std::atomic_ref(m.continued).store(true, std::memory_order_relaxed);
            }
        }, 1024);
    }
    std::vector<std::uint32_t> corners(double limit) const {
        std::vector<std::uint32_t> corners;
        for (std::size_t i = 0; i < meetings_.size(); ++i) {
            const Meeting& m = meetings_[i];
            if (!m.continued && (m.lines != 2 || fold(m.first, m.second) > limit)) corners.push_back(places_[i]);
        }
        return corners;
    }

  private:
    std::size_t find(std::uint32_t point) const { return static_cast<std::size_t>(std::lower_bound(places_.begin(), places_.end(), point) - places_.begin()); }
    Vec3 away(const FeatureEdge& e, bool fromA) const {
        const Vec3 d = normalized(points_[e.b] - points_[e.a]);
        return fromA ? d : -d;
    }

    std::span<const Vec3> points_;
    RawVector<std::uint32_t> places_; // ascending
    std::vector<Meeting> meetings_;
};

} // namespace

std::vector<std::uint32_t> findCorners(std::span<const Vec3> points, std::span<const FeatureEdge> all, double limit) {
    const auto pick = [&](const auto& isOne) {
        return collect<FeatureEdge>(all.size(), [&](std::size_t i, const auto& put) {
            if (isOne(all[i])) put(all[i]);
        });
    };
    Meetings meetings(points, pick([](const FeatureEdge& e) { return (e.kinds & lineKinds) != 0; }));
    meetings.continueIn(pick([&](const FeatureEdge& e) { return !(e.kinds & lineKinds) && (e.angle >= limit / 2 || isFree(e)); }), limit);
    return meetings.corners(limit);
}

} // namespace i2b
