#include "i2b/sizing/shapes.h"
#include "i2b/core/parallel.h"
#include <numbers>

namespace i2b {
namespace {

constexpr double bandGrain = 1.0 / 16; // of its distance

double maxAbs(const Vec3& v) { return std::max(std::abs(v.x), std::max(std::abs(v.y), std::abs(v.z))); }

// A bound on the rounding of everything below.
double padOf(const Vec3& from, const Vec3& to, const Box& box) {
    return 1e-13 * (maxAbs(from) + maxAbs(to) + maxAbs(box.lo) + maxAbs(box.hi));
}

Vec3 cornerOf(const Box& box, int i) {
    return {i & 1 ? box.hi.x : box.lo.x, i & 2 ? box.hi.y : box.lo.y, i & 4 ? box.hi.z : box.lo.z};
}

double segmentDistance2(const Vec3& q, const Vec3& from, const Vec3& to) {
    const Vec3 d = to - from;
    const double l = norm2(d);
    const double t = l > 0 ? std::clamp(dot(q - from, d) / l, 0.0, 1.0) : 0;
    return norm2(q - (from + d * t));
}

Cover coverOf(const Capsule& c, const Box& box) {
    const double reach = c.radius + padOf(c.from, c.to, box);
    if (segmentBoxDistance2(c.from, c.to, box) > reach * reach) return Cover::none;
    if (c.radius == 0) return Cover::some;
    for (int i = 0; i < 8; ++i) { // convex: all of the box is inside where its corners are
        if (segmentDistance2(cornerOf(box, i), c.from, c.to) > c.radius * c.radius) return Cover::some;
    }
    return Cover::all;
}

// A point seen along the axis of a cylinder: how far along, and where across.
struct Axial {
    double along, u, v;
};

struct AxialFrame {
    explicit AxialFrame(const Cylinder& c) : origin(c.from), length(norm(c.to - c.from)), axis(normalized(c.to - c.from)) {
        const Vec3 a = axis;
        const Vec3 least = std::abs(a.x) <= std::abs(a.y) && std::abs(a.x) <= std::abs(a.z) ? Vec3{1, 0, 0}
                           : std::abs(a.y) <= std::abs(a.z)                                ? Vec3{0, 1, 0}
                                                                                            : Vec3{0, 0, 1};
        across = normalized(cross(a, least));
        up = cross(a, across);
    }
    Axial operator()(const Vec3& p) const {
        const Vec3 d = p - origin;
        return {dot(d, axis), dot(d, across), dot(d, up)};
    }
    Vec3 origin;
    double length;
    Vec3 axis, across, up;
};

struct Plane2 {
    double u, v;
};

// The corners of what two parallel planes leave of a box, seen along their normal.
std::vector<Plane2> slabOfBox(const std::array<Axial, 8>& corner, double length) {
    std::vector<Plane2> points;
    for (const Axial& p : corner) {
        if (p.along >= 0 && p.along <= length) points.push_back({p.u, p.v});
    }
    for (std::size_t i = 0; i < 8; ++i) {
        for (std::size_t bit : {1u, 2u, 4u}) {
            if (i & bit) continue;
            const Axial &p = corner[i], &q = corner[i | bit];
            for (const double end : {0.0, length}) {
                if ((p.along < end) == (q.along < end)) continue;
                const double t = (end - p.along) / (q.along - p.along);
                points.push_back({p.u + t * (q.u - p.u), p.v + t * (q.v - p.v)});
            }
        }
    }
    return points;
}

// Inside the convex hull no line through the origin and a point has all others on one side.
bool hullHoldsOrigin(const std::vector<Plane2>& points) {
    for (const Plane2& p : points) {
        bool left = false, right = false;
        for (const Plane2& q : points) {
            const double side = p.u * q.v - p.v * q.u;
            left = left || side > 0, right = right || side < 0;
        }
        if (!left || !right) return false;
    }
    return !points.empty();
}

// The squared distance from the origin to the convex hull. Its sides are among the chords, and from outside no chord is
// nearer than the hull.
double hullDistance2(const std::vector<Plane2>& points) {
    if (hullHoldsOrigin(points)) return 0;
    double best = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < points.size(); ++i) {
        for (std::size_t j = i; j < points.size(); ++j) {
            const Plane2 &p = points[i], &q = points[j];
            const double du = q.u - p.u, dv = q.v - p.v, l = du * du + dv * dv;
            const double t = l > 0 ? std::clamp(-(p.u * du + p.v * dv) / l, 0.0, 1.0) : 0;
            const double u = p.u + t * du, v = p.v + t * dv;
            best = std::min(best, u * u + v * v);
        }
    }
    return best;
}

Cover coverOf(const Cylinder& c, const Box& box) {
    const Capsule round{c.from, c.to, c.radius};
    if (coverOf(round, box) == Cover::none) return Cover::none;
    const AxialFrame frame(c);
    const double pad = padOf(c.from, c.to, box);
    std::array<Axial, 8> corner{};
    bool all = true, any = false;
    for (int i = 0; i < 8; ++i) {
        Axial& p = corner[static_cast<std::size_t>(i)] = frame(cornerOf(box, i));
        const bool inside = p.along >= 0 && p.along <= frame.length && p.u * p.u + p.v * p.v <= c.radius * c.radius;
        all = all && inside, any = any || inside;
        p.along += pad; // the slab, a trifle wider
    }
    if (any) return all ? Cover::all : Cover::some;
    const std::vector<Plane2> slice = slabOfBox(corner, frame.length + 2 * pad);
    const double reach = c.radius + pad;
    return !slice.empty() && hullDistance2(slice) <= reach * reach ? Cover::some : Cover::none;
}

Cover coverOf(const PartsBand& b, const Box& box) {
    const double half = 0.5 * norm(box.extent()) * (1 + 1e-12);
    // From what is near enough to the middle every corner is.
    const ClosestPoint near = b.parts->closeEnough(box.centre(), b.distance + half, b.distance - half);
    if (!near) return Cover::none;
    const Vec3 far = cwiseMax(box.hi - near.point, near.point - box.lo); // from one point of the parts to the farthest corner
    return norm2(far) <= b.distance * b.distance ? Cover::all : Cover::some;
}

Box around(const Vec3& a, const Vec3& b, double radius) {
    Box box;
    box.add(a);
    box.add(b);
    const Vec3 r{radius, radius, radius};
    return {box.lo - r, box.hi + r};
}

} // namespace

PartsIndex::PartsIndex(Surface triangles) : surface_(std::move(triangles)), own_(std::make_unique<SurfaceIndex>(surface_)) {
    measure(surface_, [](std::uint32_t) { return true; });
}

PartsIndex::PartsIndex(const SurfaceIndex& whole, const std::vector<bool>& chosen) : whole_(&whole) {
    const auto isChosen = [&](std::uint32_t t) { return bool(chosen[static_cast<std::size_t>(whole.surface().partOf[t])]); };
    chosen_ = whole.subset(isChosen);
    measure(whole.surface(), isChosen);
}

template <class Chosen>
void PartsIndex::measure(const Surface& s, const Chosen& isChosen) {
    struct Sums {
        std::size_t triangles = 0;
        Box bounds;
        double area = 0;
    };
    const Sums all = orderedReduce(
        s.triangles.size(), Sums(),
        [&](std::size_t begin, std::size_t end) {
            Sums sum;
            for (std::size_t t = begin; t < end; ++t) {
                if (!isChosen(static_cast<std::uint32_t>(t))) continue;
                const Vec3 &a = s.points[s.triangles[t][0]], &b = s.points[s.triangles[t][1]], &c = s.points[s.triangles[t][2]];
                ++sum.triangles;
                sum.bounds.add(a), sum.bounds.add(b), sum.bounds.add(c);
                sum.area += 0.5 * norm(cross(b - a, c - a));
            }
            return sum;
        },
        [](Sums a, const Sums& b) {
            a.triangles += b.triangles, a.area += b.area;
            if (b.triangles > 0) a.bounds.add(b.bounds.lo), a.bounds.add(b.bounds.hi);
            return a;
        });
    triangles_ = all.triangles, bounds_ = all.bounds, area_ = all.area;
}

ClosestPoint PartsIndex::closeEnough(const Vec3& q, double radius, double enough) const {
    if (own_) return own_->closeEnough(q, radius, enough);
    return whole_->closeEnough(q, radius, enough, chosen_);
}

// The squared distance of a + t d to the box is convex in t, and its slope is straight between the places where a
// coordinate enters or leaves the box's range.
double segmentBoxDistance2(const Vec3& from, const Vec3& to, const Box& box) {
    const Vec3 d = to - from;
    std::array<double, 8> knots{0, 1}; // ascending
    std::size_t n = 2;
    for (int i = 0; i < 3; ++i) {
        for (const double plane : {box.lo[i], box.hi[i]}) {
            const double t = d[i] != 0 ? (plane - from[i]) / d[i] : -1;
            if (!(t > 0 && t < 1)) continue;
            std::size_t k = n++;
            for (; knots[k - 1] > t; --k) knots[k] = knots[k - 1];
            knots[k] = t;
        }
    }
    const auto offset = [&](double t) {
        const Vec3 p = from + d * t;
        return p - cwiseMin(cwiseMax(p, box.lo), box.hi);
    };
    double before = 0, slopeBefore = 0;
    for (std::size_t k = 0; k < n; ++k) {
        const double t = knots[k], slope = dot(offset(t), d);
        if (slope >= 0) {
            const double rise = slope - slopeBefore;
            return norm2(offset(k == 0 || !(rise > 0) ? t : before - slopeBefore * (t - before) / rise));
        }
        before = t, slopeBefore = slope;
    }
    return norm2(offset(1));
}

Cover coverOf(const Shape& shape, const Box& box) {
    return std::visit([&](const auto& s) { return coverOf(s, box); }, shape);
}

bool meets(const Shape& shape, const Box& box) {
    const PartsBand* const band = std::get_if<PartsBand>(&shape);
    if (!band) return coverOf(shape, box) != Cover::none;
    const double reach = band->distance + 0.5 * norm(box.extent()) * (1 + 1e-12);
    return bool(band->parts->closeEnough(box.centre(), reach, reach));
}

Box boundsOf(const Shape& shape) {
    if (const auto* const band = std::get_if<PartsBand>(&shape)) {
        const Box& b = band->parts->bounds();
        return around(b.lo, b.hi, band->distance);
    }
    if (const auto* const c = std::get_if<Cylinder>(&shape)) return around(c->from, c->to, c->radius);
    const auto& c = std::get<Capsule>(shape);
    return around(c.from, c.to, c.radius);
}

double volumeOf(const Shape& shape) {
    using std::numbers::pi;
    if (const auto* const band = std::get_if<PartsBand>(&shape)) return 2 * band->distance * band->parts->area();
    if (const auto* const c = std::get_if<Cylinder>(&shape)) return pi * c->radius * c->radius * norm(c->to - c->from);
    const auto& c = std::get<Capsule>(shape);
    return pi * c.radius * c.radius * (norm(c.to - c.from) + 4.0 / 3 * c.radius);
}

double grainOf(const Shape& shape) {
    const auto* const band = std::get_if<PartsBand>(&shape);
    return band ? band->distance * bandGrain : 0;
}

} // namespace i2b
