#include "i2b/core/parallel.h"
#include "i2b/core/give_up.h"
#include "i2b/core/raw_fill.h"
#include "i2b/fit/corner.h"
#include "i2b/fit/fit.h"
#include <algorithm>

namespace i2b {
namespace {

// Of h: nearer to the geometry the way to it says little. At an edge of a sheet it would hold the node to that edge,
// where the triangle lets it glide away.
constexpr double settled = 0.1;
constexpr double onIt = 0.02; // of h: a node so near is on the geometry

// Closest point within the plane(s) of the domain sides that the node lies in: again and again to where the plane through
// the closest point, across the way to it, meets the side.
ClosestPoint closestWithinSides(const SurfaceIndex& index, const Vec3& q, std::uint8_t outside, double radius) {
    ClosestPoint c = index.closest(q, radius);
    if (!c) c = index.closest(q);
    if (outside == 0 || !c) return c;
    Vec3 p = q;
    const double enough = 1e-9 * norm(q - c.point);
    for (int i = 0; i < 12 && norm(p - c.point) > enough; ++i) {
        const Vec3 way = c.point - p, within = withinSides(way, outside);
        const double s = norm2(within) / norm2(way);
        p += s > 0.03 ? within / s : within; // a wall along the side is not chased
        c = index.closest(p);
    }
    c.point = p;
    return c;
}

Vec3 weightedMean(std::span<const BandEdge> edges, const Positions& x) {
    Vec3 sum;
    double weight = 0;
    for (const BandEdge& e : edges) {
        sum += x[static_cast<std::size_t>(e.b)] * double(e.weight);
        weight += double(e.weight);
    }
    return weight > 0 ? sum / weight : sum;
}

// Mean of the neighbours' moves: a lattice stays a lattice, whatever its levels.
Vec3 meanMove(const Band& band, std::span<const BandEdge> edges, const Positions& x) {
    Vec3 sum;
    double weight = 0;
    for (const BandEdge& e : edges) {
        const auto b = static_cast<std::size_t>(e.b);
        sum += (x[b] - band.start[b]) * double(e.weight);
        weight += double(e.weight);
    }
    return weight > 0 ? sum / weight : sum;
}

// A front node that would pass through geometry stops halfway to it.
Vec3 stoppedByGeometry(const SurfaceIndex& index, const Vec3& from, const Vec3& to) {
    const SegmentHit hit = index.firstHit(from, to);
    return hit ? from + (to - from) * (0.5 * std::max(0.0, hit.t)) : to;
}

bool isFront(const Band& band, std::size_t n) { return n >= band.walls && n < band.walls + band.fronts; }

void smoothSurface(const Band& band, const SurfaceIndex& index, const Positions& start, Positions& x, Positions& copy) {
    copyTo(copy, x);
    const Positions& old = copy;
    parallelFor(band.fronts, [&](std::size_t i) {
        const std::size_t n = band.walls + i;
        Vec3 sum;
        double weight = 0;
        for (const BandEdge& e : band.edges[n]) {
            if (!isFront(band, static_cast<std::size_t>(e.b))) continue;
            sum += old[static_cast<std::size_t>(e.b)] * double(e.weight);
            weight += double(e.weight);
        }
        if (weight == 0) return;
        const Vec3 move = withinSides((sum / weight - old[n]) * 0.7, band.outside[n]);
        x[n] = stoppedByGeometry(index, start[n], old[n] + move);
    });
}

void projectWalls(const Band& band, const SurfaceIndex& index, Positions& x, Positions& copy, bool first) {
    copyTo(copy, x);
    const Positions& old = copy;
    parallelFor(band.walls, [&](std::size_t b) {
        const Vec3& f = old[static_cast<std::size_t>(band.frontNode[b])];
        Vec3 q = f;
        if (!first) {
            Vec3 sum;
            double weight = 0;
            for (const BandEdge& e : band.edges[b]) {
                if (static_cast<std::size_t>(e.b) >= band.walls) continue;
                sum += old[static_cast<std::size_t>(e.b)] * double(e.weight);
                weight += double(e.weight);
            }
            const Vec3 mean = weight > 0 ? sum / weight : old[b];
            q = old[b] * 0.5 + (mean + f) * 0.25;
            q += withinSides(q - old[b], band.outside[b]) - (q - old[b]);
        }
        // Seen from the fluid side: what the way from the front meets first hides what lies behind.
        const SegmentHit hit = index.firstHit(f, q);
        if (hit && band.outside[b] == 0) q = f + (q - f) * hit.t;
        // From the second time on the node stands on the geometry, which bounds the search.
        const double reach = first ? 4 * band.reach[b] : std::min(4 * band.reach[b], 1.0001 * norm(q - old[b]));
        const ClosestPoint c = closestWithinSides(index, q, band.outside[b], reach);
        if (c) x[b] = c.point;
    });
}

void relaxVolume(const Band& band, const SurfaceIndex& index, const Positions& start, Positions& x, Positions& copy) {
    copyTo(copy, x);
    const Positions& old = copy;
    parallelFor(band.movable - band.walls, [&](std::size_t i) {
        const std::size_t n = band.walls + i;
        const Vec3 to = isFront(band, n) ? weightedMean(band.edges[n], old) : band.start[n] + meanMove(band, band.edges[n], old);
        const Vec3 moved = old[n] + withinSides(to - old[n], band.outside[n]);
        x[n] = isFront(band, n) ? stoppedByGeometry(index, start[n], moved) : moved;
    });
    settleHanging(band, band.walls, x);
}

} // namespace

// Parents never hang themselves on the same level.
void settleHanging(const Band& band, std::size_t first, Positions& x) {
    Positions relaxed;
    copyTo(relaxed, x);
    parallelFor(band.movable - first, [&](std::size_t i) {
        const std::size_t n = first + i;
        const std::span<const std::int32_t> parents = band.parents[n];
        if (parents.empty()) return;
        Vec3 sum;
        for (std::int32_t p : parents) sum += relaxed[static_cast<std::size_t>(p)];
        x[n] = sum / static_cast<double>(parents.size());
    });
}

WallTarget wallTarget(const SurfaceIndex& index, const Band& band, std::size_t wall, const Vec3& front, const Vec3& b) {
    return targetSeen(index, seenFront(index, band, wall, front), b, band.h[wall], band.reach[wall], band.outside[wall]);
}

WallTarget targetSeen(const SurfaceIndex& index, const Vec3& f, const Vec3& b, double h, double reach, std::uint8_t outside) {
    WallTarget target;
    const double length = norm(f - b);
    ClosestPoint c;
    const double off = 1e-3 * h; // what lies nearer to b is its closest point's business
    const SegmentHit hit = length > off && outside == 0 ? index.firstHit(f, b, 1 - off / length + 1e-9) : SegmentHit{};
    if (hit && (1 - hit.t) * length > off) {
        c = {f + (b - f) * hit.t, 0, hit.triangle};
    } else {
        // A node on the geometry stays where it is: asked from beside it, its place would wander.
        if (outside == 0) c = index.closest(b, onIt * h);
        const Vec3 q = length > 0 ? b + withinSides(f - b, outside) * std::min(1.0, 0.1 * h / length) : b;
        if (!c) c = closestWithinSides(index, q, outside, 2 * reach);
    }
    if (!c) return target;
    target.found = true;
    target.point = c.point;
    const Vec3 away = b - c.point;
    const double d = norm(away);
    target.normal = d > settled * h ? away / d : index.normal(c.triangle);
    if (target.normal == Vec3{}) target.normal = normalized(f - b);
    target.normal = normalized(withinSides(target.normal, outside));
    return target;
}

Positions startPositions(Band& band, const SurfaceIndex& index) {
    Positions goal, x;
    copyTo(goal, band.start);
    parallelFor(band.fronts, [&](std::size_t i) {
        const std::size_t n = band.walls + i;
        SegmentHit hit = index.firstHit(band.inside[i], band.start[n]);
        if (!hit && !(band.away[i] == band.inside[i]) && index.firstHit(band.away[i], band.inside[i])) { // both are behind
            band.inside[i] = band.away[i];
            hit = index.firstHit(band.inside[i], band.start[n]);
        }
        if (!hit || hit.t <= 0) return;
        band.behind[i] = 1;
        goal[n] = band.inside[i] + (band.start[n] - band.inside[i]) * (0.5 * hit.t);
        for (std::int32_t b : band.fansOf[i]) goal[static_cast<std::size_t>(b)] += goal[n] - band.start[n];
    });
    giveUp(band.away);
    if (std::find(band.behind.begin(), band.behind.end(), 1) == band.behind.end()) return goal;
    blend(band, band.start, goal, x);
    return x;
}

Vec3 seenFront(const SurfaceIndex& index, const Band& band, std::size_t wall, const Vec3& f) {
    const std::size_t i = static_cast<std::size_t>(band.frontNode[wall]) - band.walls;
    if (!band.behind[i]) return f;
    const SegmentHit hit = index.firstHit(band.inside[i], f);
    return hit ? band.inside[i] + (f - band.inside[i]) * (0.5 * hit.t) : f;
}

Positions goalPositions(const Band& band, const SurfaceIndex& index, const Positions& start, int sweeps) {
    Positions x, copy;
    copyTo(x, start);
    smoothSurface(band, index, start, x, copy);
    projectWalls(band, index, x, copy, true);
    for (int i = 0; i < sweeps; ++i) {
        relaxVolume(band, index, start, x, copy);
        projectWalls(band, index, x, copy, false);
    }
    return x;
}

} // namespace i2b
