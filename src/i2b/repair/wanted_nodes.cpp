#include "i2b/repair/wanted_nodes.h"
#include "i2b/core/parallel.h"
#include <algorithm>

namespace i2b {
namespace {

using Index = std::size_t;
constexpr double lineReach = 0.75; // of h: no free node is brought farther to a line,
constexpr double alongReach = 1;   // none on it farther along,
constexpr double cornerReach = 2;  // and none farther to a corner
constexpr double aside = 0.5;      // of h: so far from a sample, along its line, a node may come to it
constexpr double bent = 0.2;       // of h: so far the line may have bent there
constexpr double onLine = 0.1;     // of h: so near to the line of a sample a node stands on it
constexpr double atCorner = 0.1;   // of h: so near to its corner the node of one stands there
constexpr int rings = 1;           // of faces around a sample's whose nodes are asked

} // namespace

// The node around a sample with the shortest way. place: fills in where one is to go, and says whether it may.
template <class Place>
WantedNode WantedNodes::nearest(const LostSample& sample, const Place& place) const {
    WantedNode best;
    for (const std::int32_t face : samples_.grown({sample.at.face}, rings)) {
        const std::int32_t f = samples_.meshFace(face);
        for (const std::int32_t p : mesh_.face(f)) {
            if (p < nodes_.corePoints()) continue;
            const Index v = nodes_.vertexOf(p);
            if (v >= guide_.snaps.size() || front_.outside[v] != 0) continue;
            WantedNode w;
            w.vertex = static_cast<std::int32_t>(v), w.face = face, w.cell = mesh_.owner[Index(f)];
            if (!place(w, guide_.snaps[v].kind, front_.wall(v), front_.h[v])) continue;
            if ((best.vertex < 0 || w.length < best.length) && !tried_.contains(w.key())) best = w;
        }
    }
    return best;
}

WantedNode WantedNodes::toCorner(const LostSample& sample) const {
    const ClosestPoint corner = guide_.features.closestCorner(sample.point, cornerReach * sample.at.h);
    if (!corner || guide_.features.isCrowded(corner, sample.at.h) || taken_.contains(corner.triangle)) return {};
    return nearest(sample, [&](WantedNode& w, SnapKind held, const Vec3& x, double h) {
        w.way = WantedNode::toCorner, w.at = corner.triangle, w.length = norm(corner.point - x) / h, w.snap = {SnapKind::corner, corner.point, {}};
        return held != SnapKind::corner && w.length <= cornerReach;
    });
}

Vec3 WantedNodes::tangentAt(const LostSample& sample) const {
    const auto& t = samples_.edges().triangles[sample.line];
    return normalized(samples_.edges().points[t[1]] - samples_.edges().points[t[0]]);
}

WantedNode WantedNodes::toLine(const LostSample& sample) const {
    const Vec3 tangent = tangentAt(sample);
    return nearest(sample, [&](WantedNode& w, SnapKind held, const Vec3& x, double h) {
        if (held != SnapKind::none) return false;
        const Vec3 place = sample.point + tangent * std::clamp(dot(x - sample.point, tangent), -aside * h, aside * h);
        const FeatureIndex::Line line = guide_.features.closestLine(place, bent * h);
        w.way = WantedNode::toLine, w.length = norm(line.point - x) / h, w.snap = {SnapKind::line, line.point, line.tangent};
        return line.found && w.length <= lineReach;
    });
}

WantedNode WantedNodes::alongLine(std::uint32_t number) const {
    const LostSample& sample = samples_.samples()[number];
    const FeatureIndex::Line line = guide_.features.closestLine(sample.point, onLine * sample.at.h);
    if (!line.found) return {};
    const Vec3 tangent = tangentAt(sample);
    return nearest(sample, [&](WantedNode& w, SnapKind held, const Vec3& x, double h) {
        const Vec3 way = line.point - x;
        w.way = WantedNode::alongLine, w.at = number, w.length = norm(way) / h, w.snap = {SnapKind::line, line.point, line.tangent};
        return held == SnapKind::line && w.length <= alongReach && norm(way - tangent * dot(way, tangent)) <= onLine * h;
    });
}

void WantedNodes::findTaken() {
    taken_.clear();
    for (Index v = 0; v < guide_.snaps.size(); ++v) {
        if (guide_.snaps[v].kind != SnapKind::corner) continue;
        if (const ClosestPoint c = guide_.features.closestCorner(front_.wall(v), atCorner * front_.h[v])) taken_.insert(c.triangle);
    }
}

std::vector<WantedNode> WantedNodes::find() {
    findTaken();
    std::vector<std::uint32_t> lost;
    for (std::uint32_t s = 0; s < samples_.samples().size(); ++s)
        if (!samples_.isCaptured(s)) lost.push_back(s);
    std::vector<WantedNode> found(3 * lost.size());
    parallelFor(lost.size(), [&](Index i) {
        const LostSample& sample = samples_.samples()[lost[i]];
        found[3 * i] = toCorner(sample), found[3 * i + 1] = toLine(sample), found[3 * i + 2] = alongLine(lost[i]);
    }, 16);
    std::erase_if(found, [](const WantedNode& w) { return w.vertex < 0; });
    std::ranges::stable_sort(found, {}, [](const WantedNode& w) { return std::pair(w.way, w.way == WantedNode::alongLine ? -w.length : w.length); });
    return found;
}

} // namespace i2b
