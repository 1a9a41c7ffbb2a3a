#include "i2b/quality/border_lines.h"
#include "i2b/core/parallel.h"
#include "i2b/quality/line_capture.h"
#include <algorithm>
#include <optional>

namespace i2b {
namespace {

using Corners = std::array<Vec3, 3>;
using Segment = std::array<Vec3, 2>;

Corners cornersOf(const Surface& s, std::uint32_t t) {
    const auto& v = s.triangles[t];
    return {s.points[v[0]], s.points[v[1]], s.points[v[2]]};
}

// Where a triangle passes from one side of a plane to the other; none if it only touches it.
std::optional<Segment> throughPlane(const Corners& t, const Vec3& origin, const Vec3& normal) {
    std::array<double, 3> side{};
    for (std::size_t i = 0; i < 3; ++i) side[i] = dot(normal, t[i] - origin);
    if (std::min({side[0], side[1], side[2]}) >= 0 || std::max({side[0], side[1], side[2]}) <= 0) return {};
    Segment s;
    std::size_t n = 0;
    for (std::size_t i = 0; i < 3 && n < 2; ++i) {
        const std::size_t j = (i + 1) % 3;
        if ((side[i] < 0) == (side[j] < 0)) continue;
        s[n++] = t[i] + (t[j] - t[i]) * (side[i] / (side[i] - side[j]));
    }
    return s;
}

// The segment in which two triangles cut each other.
std::optional<Segment> cutOf(const Corners& a, const Corners& b) {
    const Vec3 normal = cross(b[1] - b[0], b[2] - b[0]);
    const std::optional<Segment> s = throughPlane(a, b[0], normal);
    if (!s || !throughPlane(b, a[0], cross(a[1] - a[0], a[2] - a[0]))) return {};
    double from = 0, to = 1; // shares of s within b
    const Vec3 way = (*s)[1] - (*s)[0];
    for (std::size_t i = 0; i < 3; ++i) {
        const Vec3 inward = cross(normal, b[(i + 1) % 3] - b[i]);
        const double start = dot(inward, (*s)[0] - b[i]), slope = dot(inward, way);
        if (slope > 0) from = std::max(from, -start / slope);
        else if (slope < 0) to = std::min(to, -start / slope);
        else if (start < 0) return {};
    }
    if (from >= to) return {};
    return Segment{(*s)[0] + way * from, (*s)[0] + way * to};
}

struct Border {
    Segment segment;
    std::array<std::int32_t, 2> parts;
};

class BorderFinder {
  public:
    BorderFinder(const SurfaceIndex& index, const std::vector<std::uint8_t>& marked, double tolerance)
        : index_(index), surface_(index.surface()), marked_(marked), tolerance_(tolerance) {}
    void find(std::uint32_t t, std::vector<Border>& out) const;

  private:
    void findFoot(std::uint32_t t, std::int32_t other, const Corners& corners, std::vector<Border>& out) const;

    const SurfaceIndex& index_;
    const Surface& surface_;
    const std::vector<std::uint8_t>& marked_;
    double tolerance_;
};

// Edges of a triangle that lie upon another part, while the triangle itself does not.
void BorderFinder::findFoot(std::uint32_t t, std::int32_t other, const Corners& corners, std::vector<Border>& out) const {
    const auto lies = [&](const Vec3& p) { return bool(index_.closest(p, tolerance_, [&](std::uint32_t n) { return surface_.partOf[n] == other; })); };
    if (lies((corners[0] + corners[1] + corners[2]) * (1.0 / 3))) return;
    const std::int32_t own = surface_.partOf[t];
    for (std::size_t i = 0; i < 3; ++i) {
        const Vec3 &a = corners[i], &b = corners[(i + 1) % 3];
        if (lies((a + b) * 0.5) && lies(a) && lies(b)) out.push_back({{a, b}, {std::min(own, other), std::max(own, other)}});
    }
}

void BorderFinder::find(std::uint32_t t, std::vector<Border>& out) const {
    const Corners corners = cornersOf(surface_, t);
    const Vec3 room{tolerance_, tolerance_, tolerance_};
    const Box box{cwiseMin(cwiseMin(corners[0], corners[1]), corners[2]) - room, cwiseMax(cwiseMax(corners[0], corners[1]), corners[2]) + room};
    const std::int32_t own = surface_.partOf[t];
    std::vector<std::int32_t> others;
    for (const std::uint32_t c : index_.candidates(box)) {
        const std::int32_t part = surface_.partOf[c];
        if (part == own || !marked_[c]) continue;
        others.push_back(part);
        if (part < own) continue; // each pair once
        if (const std::optional<Segment> cut = cutOf(corners, cornersOf(surface_, c))) out.push_back({*cut, {own, part}});
    }
    std::sort(others.begin(), others.end());
    others.erase(std::unique(others.begin(), others.end()), others.end());
    for (const std::int32_t other : others) findFoot(t, other, corners, out);
}

} // namespace

BorderLines borderLines(const SurfaceIndex& index, const std::vector<std::uint8_t>& marked, double tolerance) {
    constexpr std::size_t chunk = 256;
    const BorderFinder finder(index, marked, tolerance);
    std::vector<std::vector<Border>> found((marked.size() + chunk - 1) / chunk);
    parallelChunks(marked.size(), chunk, [&](std::size_t begin, std::size_t end, std::size_t c) {
        for (std::size_t t = begin; t < end; ++t) {
            if (marked[t]) finder.find(static_cast<std::uint32_t>(t), found[c]);
        }
    });
    BorderLines all;
    all.lines.parts = {Part{"borders", "", 0}};
    for (const std::vector<Border>& part : found) {
        for (const Border& b : part) {
            addSegment(all.lines, b.segment[0], b.segment[1]);
            all.parts.push_back(b.parts);
        }
    }
    return all;
}

} // namespace i2b
