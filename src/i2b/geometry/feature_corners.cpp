#include "i2b/geometry/feature_corners.h"
#include "i2b/geometry/feature_edges.h"

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

// A tessellated radius folds by a little more here, a little less there than the limit. Its line is cut in
// pieces then, whose ends would make most of the corners of a curved body.
void markContinued(const std::vector<Vec3>& points, const std::vector<FeatureEdge>& all, double limit,
                   std::vector<Meeting>& meetings) {
    for (const FeatureEdge& e : all) {
        const bool isFree = e.kinds & bitOf(EdgeKind::free);
        if ((e.kinds & lineKinds) || (e.angle < limit / 2 && !isFree)) continue;
        const Vec3 d = normalized(points[e.b] - points[e.a]);
        for (const auto& [point, away] : {std::pair{e.a, d}, std::pair{e.b, -d}}) {
            Meeting& m = meetings[point];
            if (m.lines == 1 && !m.named && m.rim == isFree && fold(m.first, away) <= limit) m.continued = true;
        }
    }
}

} // namespace

std::vector<std::uint32_t> findCorners(const std::vector<Vec3>& points, const std::vector<FeatureEdge>& all,
                                       double limit) {
    std::vector<Meeting> meetings(points.size());
    for (const FeatureEdge& e : all) {
        if (!(e.kinds & lineKinds)) continue;
        const Vec3 d = normalized(points[e.b] - points[e.a]);
        for (const auto& [point, away] : {std::pair{e.a, d}, std::pair{e.b, -d}}) {
            Meeting& m = meetings[point];
            (m.lines++ == 0 ? m.first : m.second) = away;
            m.rim = m.rim || (e.kinds & bitOf(EdgeKind::rim));
            m.named = m.named || (e.kinds & bitOf(EdgeKind::named));
        }
    }
    markContinued(points, all, limit, meetings);
    std::vector<std::uint32_t> corners;
    for (std::uint32_t i = 0; i < meetings.size(); ++i) {
        const Meeting& m = meetings[i];
        if (m.lines == 0 || m.continued) continue;
        if (m.lines != 2 || fold(m.first, m.second) > limit) corners.push_back(i);
    }
    return corners;
}

} // namespace i2b
