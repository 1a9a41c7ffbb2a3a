#include "i2b/sizing/curvature.h"
#include "i2b/core/parallel.h"
#include <limits>
#include <numbers>
#include <tbb/parallel_sort.h>
#include <tuple>

namespace i2b {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double steps = 1 << 20; // of the extent, in which points are told apart
constexpr std::uint32_t none = ~0u;

// An edge of a triangle, between numbers of places.
struct Side {
    std::uint32_t a, b, apex; // a < b
    std::uint32_t slot;       // 3 * triangle + corner of the apex
    friend auto operator<=>(const Side&, const Side&) = default;
};

struct KeyedPoint {
    std::uint64_t key;
    std::uint32_t point;
    friend auto operator<=>(const KeyedPoint&, const KeyedPoint&) = default;
};

double largestExtent(const Box& box) {
    const Vec3 e = box.extent();
    return std::max(e.x, std::max(e.y, e.z));
}

// Equal numbers for points that round to the same place.
std::vector<std::uint32_t> placeNumbers(const Surface& s) {
    Box bounds;
    for (const Vec3& p : s.points) bounds.add(p);
    const double extent = largestExtent(bounds), scale = extent > 0 ? steps / extent : 0;
    std::vector<KeyedPoint> sorted(s.points.size());
    parallelFor(sorted.size(), [&](std::size_t i) {
        std::uint64_t key = 0;
        for (int a = 0; a < 3; ++a) {
            key = key << 21 | static_cast<std::uint64_t>((s.points[i][a] - bounds.lo[a]) * scale + 0.5);
        }
        sorted[i] = {key, static_cast<std::uint32_t>(i)};
    });
    tbb::parallel_sort(sorted);
    std::vector<std::uint32_t> number(sorted.size());
    std::uint32_t n = 0;
    for (std::size_t i = 0; i < sorted.size(); ++i) {
        n += i > 0 && sorted[i].key != sorted[i - 1].key;
        number[sorted[i].point] = n;
    }
    return number;
}

// Collapsed triangles give sides that sort to the end.
std::vector<Side> sortedSides(const Surface& s) {
    const std::vector<std::uint32_t> place = placeNumbers(s);
    std::vector<Side> sides(3 * s.triangles.size());
    parallelFor(s.triangles.size(), [&](std::size_t t) {
        const std::uint32_t v[3] = {place[s.triangles[t][0]], place[s.triangles[t][1]], place[s.triangles[t][2]]};
        const bool collapsed = v[0] == v[1] || v[1] == v[2] || v[2] == v[0];
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t a = v[(k + 1) % 3], b = v[(k + 2) % 3];
            const auto slot = static_cast<std::uint32_t>(3 * t + k);
            sides[3 * t + k] = collapsed ? Side{none, none, none, slot} : Side{std::min(a, b), std::max(a, b), v[k], slot};
        }
    });
    tbb::parallel_sort(sides);
    return sides;
}

// A triangle seen from one of its edges.
struct Wing {
    Vec3 edge, up;     // up: unit, in its plane, away from the edge
    double height = 0; // m
    double cotangent = 0; // of the angle at the apex
};

Wing wingOf(const Surface& s, std::uint32_t slot) {
    const auto& t = s.triangles[slot / 3];
    const std::size_t k = slot % 3;
    const Vec3& apex = s.points[t[k]];
    Vec3 a = s.points[t[(k + 1) % 3]], b = s.points[t[(k + 2) % 3]];
    if (std::tie(b.x, b.y, b.z) < std::tie(a.x, a.y, a.z)) std::swap(a, b); // rounding must not tell the orientation
    Wing w;
    w.edge = b - a;
    const Vec3 d = apex - a, across = d - w.edge * (dot(d, w.edge) / norm2(w.edge));
    w.height = norm(across);
    w.up = normalized(across);
    const double twiceArea = w.height * norm(w.edge);
    w.cotangent = twiceArea > 0 ? dot(a - apex, b - apex) / twiceArea : 0;
    return w;
}

class Bend {
  public:
    Bend(const Surface& s, double cellsPerCircle, double featureAngle)
        : surface_(s), cells_(cellsPerCircle), sharp_(featureAngle * std::numbers::pi / 180),
          blur_(largestExtent(s.bounds()) / steps) {}

    double sizeAt(std::uint32_t slotA, std::uint32_t slotB) const {
        const Wing a = wingOf(surface_, slotA), b = wingOf(surface_, slotB);
        if (!(a.height > 0) || !(b.height > 0)) return infinity;
        const double angle = std::atan2(norm(cross(a.up, b.up)), -dot(a.up, b.up));
        // What rounding of the points can turn a triangle of this height by is no curvature: slivers have any normal.
        if (angle >= sharp_ || angle <= 2 * blur_ * (1 / a.height + 1 / b.height)) return infinity;
        // Between the centres of the circles around the two triangles the wall turns by the angle; where these do not
        // tell (obtuse triangles, slivers), between half and all of the mean height.
        const double mean = 0.5 * (a.height + b.height);
        const double arc = std::clamp(0.5 * (a.cotangent + b.cotangent) * norm(a.edge), 0.5 * mean, mean);
        return 2 * std::numbers::pi * arc / (angle * cells_);
    }

  private:
    const Surface& surface_;
    double cells_, sharp_;
    double blur_; // m, how well places are known
};

} // namespace

std::vector<double> curvatureSizes(const Surface& surface, double cellsPerCircle, double featureAngle) {
    const Bend bend(surface, cellsPerCircle, featureAngle);
    const std::vector<Side> sides = sortedSides(surface);
    std::vector<double> bySlot(sides.size(), infinity);
    parallelFor(sides.size(), [&](std::size_t first) {
        const Side& side = sides[first];
        if (side.a == none || (first > 0 && sides[first - 1].a == side.a && sides[first - 1].b == side.b)) return;
        std::size_t end = first, other = first; // the first side with another apex
        int apexes = 0;
        for (; end < sides.size() && sides[end].a == side.a && sides[end].b == side.b; ++end) {
            if (end > first && sides[end].apex == sides[end - 1].apex) continue; // a triangle repeated
            if (++apexes == 2) other = end;
        }
        if (apexes != 2) return;
        const double size = bend.sizeAt(side.slot, sides[other].slot);
        for (std::size_t i = first; i < end; ++i) bySlot[sides[i].slot] = size;
    });
    std::vector<double> sizes(surface.triangles.size());
    parallelFor(sizes.size(), [&](std::size_t t) {
        sizes[t] = std::min(bySlot[3 * t], std::min(bySlot[3 * t + 1], bySlot[3 * t + 2]));
    });
    return sizes;
}

} // namespace i2b
