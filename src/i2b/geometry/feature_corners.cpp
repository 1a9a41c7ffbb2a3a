#include "i2b/geometry/feature_corners.h"
#include "i2b/core/collect.h"
#include "i2b/core/sort_unique.h"
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

// The points where lines meet, and what meets there.
class Meetings {
  public:
    Meetings(std::span<const Vec3> points, const RawVector<FeatureEdge>& lines) {
        places_.reserve(2 * lines.size());
        for (const FeatureEdge& e : lines) places_.push_back(e.a), places_.push_back(e.b);
        sortUnique(places_);
        meetings_.resize(places_.size());
        for (const FeatureEdge& e : lines) {
            forEnds(points, e, [&](Meeting& m, const Vec3& away) {
                (m.lines++ == 0 ? m.first : m.second) = away;
                m.rim = m.rim || (e.kinds & bitOf(EdgeKind::rim));
                m.named = m.named || (e.kinds & bitOf(EdgeKind::named));
            });
        }
    }
    // f(meeting, direction away from it) for the ends of an edge where lines meet.
    template <class F>
    void forEnds(std::span<const Vec3> points, const FeatureEdge& e, const F& f) {
        const Vec3 d = normalized(points[e.b] - points[e.a]);
        for (const auto& [point, away] : {std::pair{e.a, d}, std::pair{e.b, -d}}) {
            const auto found = std::lower_bound(places_.begin(), places_.end(), point);
            if (found != places_.end() && *found == point) f(meetings_[static_cast<std::size_t>(found - places_.begin())], away);
        }
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
    std::vector<std::uint32_t> places_; // ascending
    std::vector<Meeting> meetings_;
};

} // namespace

std::vector<std::uint32_t> findCorners(std::span<const Vec3> points, std::span<const FeatureEdge> all, double limit) {
    const auto isFree = [](const FeatureEdge& e) { return (e.kinds & bitOf(EdgeKind::free)) != 0; };
    const auto pick = [&](const auto& isOne) {
        return collect<FeatureEdge>(all.size(), [&](std::size_t i, const auto& put) {
            if (isOne(all[i])) put(all[i]);
        });
    };
    Meetings meetings(points, pick([](const FeatureEdge& e) { return (e.kinds & lineKinds) != 0; }));
    // A tessellated radius folds by a little more here, a little less there than the limit. Its line is cut in
    // pieces then, whose ends would make most of the corners of a curved body.
    for (const FeatureEdge& e : pick([&](const FeatureEdge& e) { return !(e.kinds & lineKinds) && (e.angle >= limit / 2 || isFree(e)); })) {
        meetings.forEnds(points, e, [&](Meeting& m, const Vec3& away) {
            if (m.lines == 1 && !m.named && m.rim == isFree(e) && fold(m.first, away) <= limit) m.continued = true;
        });
    }
    return meetings.corners(limit);
}

} // namespace i2b
