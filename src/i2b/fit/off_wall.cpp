#include "i2b/fit/off_wall.h"
#include "i2b/core/parallel.h"
#include "i2b/fit/corner.h"
#include <algorithm>

namespace i2b {
namespace {

constexpr double onTarget = 0.01;     // of h: nearer is there
constexpr double overSheet = 0.05;    // of h: what the fit lets a way pass through at its end
constexpr double passage = 2;         // of h: what is narrower is bridged
constexpr double looksBack = 0.35;    // cosine: half a cell behind an opening its rim is seen this far towards the flow
constexpr double besideReach = 1;     // of h: for features beside a node
const double folded = std::cos(35 * 3.14159265358979323846 / 180);

// All that a question about one node needs.
struct Node {
    const Band& band;
    const SurfaceIndex& index;
    const Positions& x;
    std::size_t n;
    double h;
    Vec3 f, b;      // front as seen from the flow, wall
    Vec3 target;
};

bool meets(const SurfaceIndex& index, const Vec3& from, const Vec3& to, double off) {
    const double length = norm(to - from);
    return length > off && index.firstHit(from, to, 1 - off / length);
}

bool sheetBetween(const Node& node) {
    const std::size_t i = static_cast<std::size_t>(node.band.frontNode[node.n]) - node.band.walls;
    if (node.band.behind[i] && node.index.firstHit(node.band.inside[i], node.x[node.band.walls + i])) return true;
    return meets(node.index, node.f, node.b, overSheet * node.h) || meets(node.index, node.f, node.target, overSheet * node.h);
}

// The least scaled Jacobian of the corners at the node, were it at b.
double worstCornerAt(const Node& node, const Vec3& b) {
    double worst = 1;
    node.band.corners.around(node.n, [&](const Corner& c) {
        std::array<Vec3, 4> p;
        for (std::size_t k = 0; k < 4; ++k) {
            const auto m = static_cast<std::size_t>(c.node[k]);
            p[k] = m == node.n ? b : node.x[m];
        }
        const Vec3 e1 = p[1] - p[0], e2 = p[2] - p[0], e3 = p[3] - p[0];
        const double lengths = norm(e1) * norm(e2) * norm(e3);
        worst = std::min(worst, lengths > 0 ? dot(cross(e1, e2), e3) / lengths : -1);
    });
    return worst;
}

// Would snapExactly() go the whole way?
bool wayIsFree(const Node& node, double floor) {
    const double after = worstCornerAt(node, node.b + withinSides(node.target - node.b, node.band.outside[node.n]));
    return after > 0 && after >= std::min(worstCornerAt(node, node.b), floor);
}

// The far side of the flow, seen from the target past the front node.
bool facesSheet(const Node& node) {
    const Vec3 out = node.f - node.target;
    const double length = norm(out), reach = passage * node.h;
    return length > 0 && length < reach && node.index.firstHit(node.f, node.target + out * (reach / length));
}

// Does geometry end the room that begins at the target, straight away from it and within the width of a passage? From
// the target outwards the distance to the geometry grows like the way, until the other side is as near. Along a wall that
// stands beside the way, as in a corner, it does not: then the middle is not clear.
bool hasOtherSide(const Node& node) {
    const Vec3 out = normalized(node.b - node.target);
    constexpr int steps = 8;
    for (int k = 1; k <= steps; ++k) {
        const double r = passage * node.h * k / steps;
        const ClosestPoint c = node.index.closest(node.target + out * r, 0.9 * r);
        if (!c) continue;
        const Vec3 across = c.point - node.target;
        const double width = dot(across, out);
        if (width <= 0 || width > passage * node.h || norm(across - out * width) > 0.3 * width) return false;
        return !node.index.closest(node.target + out * (0.5 * width), 0.3 * width);
    }
    return false;
}

// Between two lips: the bridged mouth of a slot, a groove or an opening.
OffCause betweenLips(const Node& node) {
    if (meets(node.index, node.f, node.b, 1e-3 * node.h) || !hasOtherSide(node)) return OffCause::none; // past the surface there are none
    const Vec3 down = normalized(node.b - node.f), behind = node.b + down * (0.5 * node.h);
    if (node.index.firstHit(node.b, behind)) return OffCause::gap;
    const ClosestPoint rim = node.index.closest(behind, passage * node.h);
    return rim && dot(behind - rim.point, down) < looksBack * rim.distance ? OffCause::gap : OffCause::bridged;
}

Vec3 normalAt(const Node& node, std::size_t wall) {
    const ClosestPoint c = node.index.closest(node.x[wall], 2 * node.band.reach[wall]);
    if (!c) return {};
    const Vec3 n = node.index.normal(c.triangle);
    return dot(n, node.x[static_cast<std::size_t>(node.band.frontNode[wall])] - c.point) < 0 ? -n : n;
}

bool besideFold(const Node& node, const FeatureIndex& features) {
    if (features.closestLine(node.b, besideReach * node.h).found) return true;
    const Vec3 own = normalAt(node, node.n);
    for (const BandEdge& e : node.band.edges[node.n]) {
        const auto m = static_cast<std::size_t>(e.b);
        if (m >= node.band.walls) continue;
        const Vec3 other = normalAt(node, m);
        if (own != Vec3{} && other != Vec3{} && dot(own, other) < folded) return true;
    }
    return false;
}

OffCause causeOf(const Node& node, const FeatureIndex& features, const Snap& snap, const EnergyOptions& options) {
    if (!node.index.closest(node.b, passage * node.h)) return OffCause::bridged;
    if (node.band.outside[node.n] != 0 && !node.index.closest(node.target, onTarget * node.h)) return OffCause::boxSide;
    const bool held = snap.kind != SnapKind::none;
    if (held && norm(node.target - node.b) <= onTarget * node.h) return OffCause::featureOff;
    if (sheetBetween(node)) return OffCause::sheetBetween;
    if (wayIsFree(node, held ? options.featureFloor : options.floor)) return OffCause::unfinished;
    if (held) return OffCause::feature;
    if (const OffCause cause = betweenLips(node); cause != OffCause::none) return cause;
    if (facesSheet(node)) return OffCause::gap;
    return besideFold(node, features) ? OffCause::besideEdge : OffCause::quality;
}

} // namespace

std::vector<OffCause> findOffCauses(const Band& band, const SurfaceIndex& index, const FeatureIndex& features,
                                    const std::vector<Snap>& snaps, const Positions& x, const EnergyOptions& options) {
    std::vector<OffCause> causes(band.walls, OffCause::none);
    parallelFor(band.walls, [&](std::size_t n) {
        const double h = band.h[n];
        if (index.closest(x[n], offInterest * h)) return;
        const Vec3& front = x[static_cast<std::size_t>(band.frontNode[n])];
        Node node{band, index, x, n, h, seenFront(index, band, n, front), x[n], x[n]};
        if (snaps[n].kind == SnapKind::none) {
            const WallTarget target = wallTarget(index, band, n, front, node.b);
            if (target.found) node.target = target.point;
        } else {
            node.target = snapLine(index, features, snaps[n], node.b, h).point;
        }
        causes[n] = causeOf(node, features, snaps[n], options);
    });
    return causes;
}

} // namespace i2b
