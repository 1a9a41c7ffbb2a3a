// Ear clipping with holes: each hole is joined to the outline by its shortest clear bridge, then the
// best-shaped ear is cut until nothing is left. A few hundred points per face; quadratic cost is of no
// concern.
#include "i2b/core/error.h"
#include "i2b/samples/outline.h"

namespace i2b::samples {
namespace {

double area2(Vec2 a, Vec2 b, Vec2 c) { return cross(b - a, c - a); }

bool crosses(Vec2 a, Vec2 b, Vec2 p, Vec2 q) {
    if (a == p || a == q || b == p || b == q) return false;
    return area2(a, b, p) * area2(a, b, q) <= 0 && area2(p, q, a) * area2(p, q, b) <= 0;
}

struct Clipper {
    std::vector<Vec2> points;
    std::vector<std::uint32_t> ring; // merged outline as indices; bridge ends occur twice

    const Vec2& at(std::size_t i) const { return points[ring[i % ring.size()]]; }

    // Does the wedge at ring position i open towards p? A bridge end occurs twice; only one of the two faces
    // p.
    bool facing(std::size_t i, Vec2 p) const {
        const Vec2 a = at(i + ring.size() - 1), b = at(i), c = at(i + 1);
        if (area2(a, b, c) >= 0) return area2(a, b, p) > 0 && area2(b, c, p) > 0;
        return area2(a, b, p) > 0 || area2(b, c, p) > 0;
    }

    void mergeHole(const std::vector<std::vector<std::uint32_t>>& holes, std::vector<char>& done);
    double earQuality(std::size_t i) const;
};

// Joins the hole that is nearest to the outline.
void Clipper::mergeHole(const std::vector<std::vector<std::uint32_t>>& holes, std::vector<char>& done) {
    const auto clear = [&](Vec2 a, Vec2 b) {
        for (std::size_t i = 0; i < ring.size(); ++i)
            if (crosses(a, b, at(i), at(i + 1))) return false;
        for (std::size_t h = 0; h < holes.size(); ++h)
            for (std::size_t i = 0; !done[h] && i < holes[h].size(); ++i)
                if (crosses(a, b, points[holes[h][i]], points[holes[h][(i + 1) % holes[h].size()]]))
                    return false;
        return true;
    };
    double best = std::numeric_limits<double>::infinity();
    std::size_t bestHole = 0, bestStart = 0, bestAt = 0;
    for (std::size_t h = 0; h < holes.size(); ++h)
        for (std::size_t j = 0; !done[h] && j < holes[h].size(); ++j)
            for (std::size_t i = 0; i < ring.size(); ++i) {
                const Vec2 p = points[holes[h][j]], d = p - at(i);
                if (dot(d, d) < best && facing(i, p) && clear(at(i), p))
                    best = dot(d, d), bestHole = h, bestStart = j, bestAt = i;
            }
    const auto& hole = holes[bestHole];
    std::vector<std::uint32_t> bridge; // round the hole and back
    for (std::size_t k = 0; k <= hole.size(); ++k) bridge.push_back(hole[(bestStart + k) % hole.size()]);
    bridge.push_back(ring[bestAt]);
    ring.insert(ring.begin() + std::ptrdiff_t(bestAt) + 1, bridge.begin(), bridge.end());
    done[bestHole] = 1;
}

// 0: not an ear; else area over squared lengths.
double Clipper::earQuality(std::size_t i) const {
    const std::size_t n = ring.size();
    const Vec2 a = at(i + n - 1), b = at(i), c = at(i + 1);
    const double area = area2(a, b, c), lengths = dot(b - a, b - a) + dot(c - b, c - b) + dot(a - c, a - c);
    if (area <= 1e-9 * lengths) return 0;
    const double tolerance = -1e-12 * lengths; // a point on the diagonal spoils the ear too
    for (std::size_t k = 0; k < n; ++k) {
        const Vec2 p = at(k);
        if (p == a || p == b || p == c) continue;
        if (area2(a, b, p) >= tolerance && area2(b, c, p) >= tolerance && area2(c, a, p) >= tolerance)
            return 0;
    }
    return area / lengths;
}

} // namespace

std::vector<Triangle> triangulate(const std::vector<Loop2>& loops) {
    Clipper clip;
    std::vector<std::vector<std::uint32_t>> holes;
    for (std::size_t l = 0; l < loops.size(); ++l) {
        std::vector<std::uint32_t> ids;
        for (const Vec2& p : loops[l]) {
            ids.push_back(std::uint32_t(clip.points.size()));
            clip.points.push_back(p);
        }
        if (l > 0) std::reverse(ids.begin(), ids.end());
        (l == 0 ? clip.ring : holes.emplace_back()) = std::move(ids);
    }
    std::vector<char> done(holes.size(), 0);
    for (std::size_t h = 0; h < holes.size(); ++h) clip.mergeHole(holes, done);

    std::vector<Triangle> out;
    std::vector<double> quality(clip.ring.size());
    const auto rate = [&](std::size_t i) { quality[i] = clip.earQuality(i); };
    for (std::size_t i = 0; i < quality.size(); ++i) rate(i);
    while (clip.ring.size() > 3) {
        auto best = std::max_element(quality.begin(), quality.end());
        if (*best <= 0) { // ears that others have set free
            for (std::size_t i = 0; i < quality.size(); ++i) rate(i);
            best = std::max_element(quality.begin(), quality.end());
        }
        if (*best <= 0)
            throw Error(ErrorKind::internal, "an outline of a sample cannot be triangulated",
                        "samples/triangulate", "report this as a bug");
        const std::size_t n = clip.ring.size(), i = std::size_t(best - quality.begin());
        out.push_back({clip.ring[(i + n - 1) % n], clip.ring[i], clip.ring[(i + 1) % n]});
        clip.ring.erase(clip.ring.begin() + std::ptrdiff_t(i));
        quality.erase(best);
        rate((i + n - 2) % (n - 1));
        rate(i % (n - 1));
    }
    out.push_back({clip.ring[0], clip.ring[1], clip.ring[2]});
    return out;
}

} // namespace i2b::samples
