#include "i2b/geometry/surface_index.h"
#include "i2b/geometry/triangle_box.h"
#include "i2b/geometry/triangle_tree.h"
#include <algorithm>
#include <cmath>
#include <cstring>

namespace i2b {

namespace {

constexpr double eps = std::numeric_limits<double>::epsilon();
constexpr double infinity = std::numeric_limits<double>::infinity();

// ---- one triangle
// --------------------------------------------------------------------------------------------

Vec3 closestPointOnSegment(const Vec3& q, const Vec3& a, const Vec3& b) {
    const Vec3 d = b - a;
    const double t = dot(q - a, d), l = norm2(d);
    return t <= 0 || !(l > 0) ? a : t >= l ? b : a + d * (t / l);
}

// The nearest of the three edges and, where there is one, a point of the inside.
Vec3 closestPointOnThinTriangle(const Vec3& q, const Vec3& a, const Vec3& b, const Vec3& c,
                                const Vec3* inside) {
    Vec3 best = closestPointOnSegment(q, a, b);
    double d = norm2(q - best);
    const auto offer = [&](const Vec3& p) {
        if (const double e = norm2(q - p); e < d) best = p, d = e;
    };
    offer(closestPointOnSegment(q, a, c));
    offer(closestPointOnSegment(q, b, c));
    if (inside != nullptr) offer(*inside);
    return best;
}

} // namespace

Vec3 closestPointOnTriangle(const Vec3& q, const Vec3& a, const Vec3& b, const Vec3& c) {
    const Vec3 ab = b - a, ac = c - a, ap = q - a;
    const double d1 = dot(ab, ap), d2 = dot(ac, ap);
    if (d1 <= 0 && d2 <= 0) return a;
    const Vec3 bp = q - b;
    const double d3 = dot(ab, bp), d4 = dot(ac, bp);
    if (d3 >= 0 && d4 <= d3) return b;
    const Vec3 cp = q - c;
    const double d5 = dot(ab, cp), d6 = dot(ac, cp);
    if (d6 >= 0 && d5 <= d6) return c;
    const double vc = d1 * d4 - d3 * d2, vb = d5 * d2 - d1 * d6, va = d3 * d6 - d5 * d4;
    // The sum is the squared length of the normal, each term a difference of products of the size below:
    // where it is mostly cancellation (needles), their signs mean little.
    const double sum = va + vb + vc, l = std::max(norm2(ab), norm2(ac));
    const bool inside = va > 0 && vb > 0 && vc > 0;
    if (!(sum > 1e-8 * l * std::max(l, norm2(ap)))) {
        const Vec3 p = inside ? a + ab * (vb / sum) + ac * (vc / sum) : a;
        return closestPointOnThinTriangle(q, a, b, c, inside ? &p : nullptr);
    }
    if (inside) return a + ab * (vb / sum) + ac * (vc / sum);
    if (vc <= 0 && d1 >= 0 && d3 <= 0) return closestPointOnSegment(q, a, b);
    if (vb <= 0 && d2 >= 0 && d6 <= 0) return closestPointOnSegment(q, a, c);
    if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) return closestPointOnSegment(q, b, c);
    return closestPointOnThinTriangle(q, a, b, c, nullptr); // rounding put q beside every region
}

namespace {

// Where along t d, 0 <= t <= 1, the segment comes closest to the edge p q, and how close (squared).
double closestAlong(const Vec3& d, const Vec3& p, const Vec3& q, double& distance2) {
    double best = 0;
    distance2 = infinity;
    const auto offer = [&](double t, const Vec3& onEdge) {
        const double e = norm2(d * t - onEdge);
        if (e < distance2 || (e == distance2 && t < best)) best = t, distance2 = e;
    };
    const double l = norm2(d);
    const auto along = [&](const Vec3& r) { return l > 0 ? std::clamp(dot(r, d) / l, 0.0, 1.0) : 0.0; };
    offer(0, closestPointOnSegment({}, p, q));
    offer(1, closestPointOnSegment(d, p, q));
    offer(along(p), p);
    offer(along(q), q);
    const Vec3 e = q - p, n = cross(d, e), m = cross(p, e);
    if (const double n2 = norm2(n); n2 > 0) { // the point where the lines cross, if both have it
        const double t = dot(m, n) / n2, s = dot(cross(p, d), n) / n2;
        if (t >= 0 && t <= 1 && s >= 0 && s <= 1) offer(t, p + e * s);
    }
    return best;
}

// The segment lies in the plane of the triangle, or the triangle has none: it touches where it begins inside,
// or where it first comes within rounding of an edge.
double touchInPlane(const Vec3& d, const Vec3& p, const Vec3& q, const Vec3& r, double tolerance2) {
    if (norm2(closestPointOnTriangle({}, p, q, r)) <= tolerance2) return 0;
    double best = 2;
    const Vec3 v[4] = {p, q, r, p};
    for (int i = 0; i < 3; ++i) {
        double distance2 = 0;
        const double t = closestAlong(d, v[i], v[i + 1], distance2);
        if (distance2 <= tolerance2) best = std::min(best, t);
    }
    return best;
}

constexpr double mostOff = 1e-13, mostOffNeedles = 1e-9; // of the sizes involved: a hit may lie so far off its triangle

// t of the first point of the closed segment a + t d on the closed triangle, 2 if there is none. Signs are
// judged with the error of their terms and taken as a hit where it leaves them open, so that no segment slips
// between two triangles that share an edge; the price is a hit that misses by some 1e-15 of the sizes
// involved, and more for needles.
double hitTriangle(const Vec3& a, const Vec3& d, const TreeTriangle& tri) {
    const Vec3 p = tri.a - a, q = tri.b - a, r = tri.c - a;
    const double lp = maxAbs(p), lq = maxAbs(q), lr = maxAbs(r), ld = maxAbs(d);
    constexpr double k = 32 * eps;
    // The line against the three edges: all on one side.
    const double u = dot(d, cross(q, r)), v = dot(d, cross(r, p)), w = dot(d, cross(p, q));
    const double eu = k * ld * lq * lr, ev = k * ld * lr * lp, ew = k * ld * lp * lq;
    if ((u < -eu || v < -ev || w < -ew) && (u > eu || v > ev || w > ew)) return 2;
    // The ends against the plane.
    const Vec3 e = q - p, f = r - p, n = cross(e, f);
    const double area = maxAbs(e) * maxAbs(f);
    const double sa = -dot(n, p), sb = dot(n, d - p);
    const double ea = k * area * lp, eb = k * area * (lp + ld);
    if ((sa > ea && sb > eb) || (sa < -ea && sb < -eb)) return 2;
    const double size = std::max(std::max(lp, lq), std::max(lr, ld));
    const double tolerance = mostOff * size, tolerance2 = tolerance * tolerance;
    if (std::abs(sa - sb) <= ea + eb) return touchInPlane(d, p, q, r, tolerance2);
    const double t = std::clamp(sa / (sa - sb), 0.0, 1.0);
    if ((u > eu && v > ev && w > ew) || (u < -eu && v < -ev && w < -ew)) return t;
    const double off2 = norm2(d * t - closestPointOnTriangle(d * t, p, q, r));
    if (off2 <= tolerance2) return t;
    const double touch = touchInPlane(d, p, q, r, tolerance2);
    if (touch <= 1) return touch;
    // Of a needle the plane is not known as well as the points are.
    const double ofPlane = std::min((ea + eb) / std::max(norm(n), 1e-300), mostOffNeedles * size);
    return off2 <= ofPlane * ofPlane ? t : 2;
}

} // namespace

// ---- walking
// -------------------------------------------------------------------------------------------------

// What queries ask of triangles, and of the children of nodes before.
struct AcceptAll {
    bool operator()(std::uint32_t) const { return true; }
    static unsigned children(std::uint32_t) { return 15; }
};
struct AcceptAsked {
    const std::function<bool(std::uint32_t)>& ask;
    bool operator()(std::uint32_t t) const { return ask(t); }
    static unsigned children(std::uint32_t) { return 15; }
};

struct SurfaceIndex::Impl {
    const Surface* surface = nullptr;
    TriangleTree tree;

    template <class Accept>
    ClosestPoint closest(const Vec3& q, double radius, const Accept& accept, double enough = -1) const;
    template <class V, class Accept>
    void walkClosest(const Vec3& q, const Accept& accept, double enough2, ClosestPoint& best, double& best2) const;
    template <class Visit>
    bool walkBox(const Box& box, const Visit& visit) const;
};

// V: the lanes boxes are measured in; single precision unless q lies so far out that its rounding would blur
// them.
template <class V, class Accept>
void SurfaceIndex::Impl::walkClosest(const Vec3& q, const Accept& accept, double enough2, ClosestPoint& best,
                                     double& best2) const {
    using Real = std::remove_cvref_t<decltype(V{}[0])>;
    const Vec3 about = q - tree.centre;
    const Real x = static_cast<Real>(about.x), y = static_cast<Real>(about.y), z = static_cast<Real>(about.z);
    // What rounding q, the differences and the squares can add to a box's distance, and to that of an answer.
    const double size = maxAbs(about) + tree.reach;
    const double slack = 4 * static_cast<double>(std::numeric_limits<Real>::epsilon()) * size +
                         16 * eps * (tree.magnitude + maxAbs(q));
    const auto limitOf = [&](double d2) {
        const double d =
            (std::sqrt(d2) + slack) * (1 + 8 * static_cast<double>(std::numeric_limits<Real>::epsilon()));
        return static_cast<Real>(std::min(d * d, static_cast<double>(std::numeric_limits<Real>::max())));
    };
    Real limit = limitOf(best2);
    TreeStack<Real> stack;
    typename TreeStack<Real>::Item item{0, 0, 0};
    while (true) {
        if (item.count > 0) {
            for (std::uint32_t i = 0; i < item.count; ++i) {
                const TreeTriangle& t = tree.triangles[item.child + i];
                const Vec3 p = closestPointOnTriangle(q, t.a, t.b, t.c);
                const double d2 = norm2(q - p);
                if (d2 > best2 || (d2 == best2 && t.id > best.triangle) || !accept(t.id)) continue;
                best.point = p;
                best.triangle = t.id;
                if (d2 < best2) limit = limitOf(d2);
                best2 = d2;
                if (d2 <= enough2) return;
            }
            if (!stack.pop(limit, item)) return;
            continue;
        }
        const TreeNode& node = tree.nodes[item.child];
        V sum{};
        const Real at[3] = {x, y, z};
        for (int k = 0; k < 3; ++k) {
            FloatLanes l, h;
            std::memcpy(&l, node.lo[k], sizeof l);
            std::memcpy(&h, node.hi[k], sizeof h);
            const V a = __builtin_convertvector(l, V) - at[k], b = at[k] - __builtin_convertvector(h, V);
            V d = a > b ? a : b;
            d = d > Real(0) ? d : V{};
            sum += d * d;
        }
        Real key[4];
        std::memcpy(key, &sum, sizeof key);
        if (!stack.enter(tree, node, key, bitsOf(sum <= limit) & accept.children(item.child), item) && !stack.pop(limit, item)) return;
    }
}

template <class Accept>
ClosestPoint SurfaceIndex::Impl::closest(const Vec3& q, double radius, const Accept& accept, double enough) const {
    ClosestPoint best;
    if (tree.nodes.empty() || !(radius >= 0)) return best;
    // Rounding must not lose an answer at the radius itself: look a trifle farther, then compare the
    // distance.
    double best2 = radius * radius * (1 + 8 * eps);
    const double enough2 = enough >= 0 ? enough * enough : -1;
    if (maxAbs(q - tree.centre) < 4 * tree.reach)
        walkClosest<FloatLanes>(q, accept, enough2, best, best2);
    else
        walkClosest<Lanes>(q, accept, enough2, best, best2);
    if (!best) return best;
    best.distance = std::sqrt(best2);
    return best.distance <= radius ? best : ClosestPoint{};
}

template <class Visit>
bool SurfaceIndex::Impl::walkBox(const Box& box, const Visit& visit) const {
    if (tree.nodes.empty() || box.empty()) return false;
    // Differences from the centre round once; the boxes of the tree reach one float beyond.
    const double pad = 4 * eps * (tree.magnitude + std::max(maxAbs(box.lo), maxAbs(box.hi)));
    const Vec3 reach{pad, pad, pad};
    const Box about{box.lo - tree.centre - reach, box.hi - tree.centre + reach};
    TreeStack<int> stack;
    TreeStack<int>::Item item{0, 0, 0};
    constexpr std::array<int, 4> keys{};
    while (true) {
        if (item.count > 0) {
            for (std::uint32_t i = 0; i < item.count; ++i)
                if (visit(tree.triangles[item.child + i])) return true;
            if (!stack.pop(0, item)) return false;
            continue;
        }
        const TreeNode& node = tree.nodes[item.child];
        unsigned bits = childrenOf(node);
        for (unsigned i = 0; i < 4; ++i)
            if (!about.overlaps(treeBox(node, i))) bits &= ~(1u << i);
        if (!stack.enter(tree, node, keys.data(), bits, item) && !stack.pop(0, item)) return false;
    }
}

SurfaceIndex::SurfaceIndex(const Surface& surface) : impl_(std::make_unique<Impl>()) {
    impl_->surface = &surface;
    impl_->tree = buildTriangleTree(surface);
}
SurfaceIndex::~SurfaceIndex() = default;
SurfaceIndex::SurfaceIndex(SurfaceIndex&&) noexcept = default;
SurfaceIndex& SurfaceIndex::operator=(SurfaceIndex&&) noexcept = default;

const Surface& SurfaceIndex::surface() const { return *impl_->surface; }

ClosestPoint SurfaceIndex::closest(const Vec3& q, double radius) const {
    return impl_->closest(q, radius, AcceptAll());
}

ClosestPoint SurfaceIndex::closeEnough(const Vec3& q, double radius, double enough) const {
    return impl_->closest(q, radius, AcceptAll(), enough);
}

ClosestPoint SurfaceIndex::closeEnough(const Vec3& q, double radius, double enough, const TriangleSubset& of) const {
    struct Some {
        const TriangleSubset& of;
        bool operator()(std::uint32_t t) const { return of.taken_[t]; }
        unsigned children(std::uint32_t node) const { return of.children_[node]; }
    };
    return impl_->closest(q, radius, Some{of}, enough);
}

// Nodes come after those above them.
TriangleSubset SurfaceIndex::subset(const std::function<bool(std::uint32_t)>& accept) const {
    const TriangleTree& tree = impl_->tree;
    TriangleSubset out;
    out.taken_.resize(tree.triangles.size());
    for (std::uint32_t t = 0; t < out.taken_.size(); ++t) out.taken_[t] = accept(t);
    out.children_.assign(tree.nodes.size(), 0);
    for (std::size_t n = tree.nodes.size(); n-- > 0;) {
        const TreeNode& node = tree.nodes[n];
        for (unsigned i = 0; i < 4; ++i) {
            if (node.child[i] == TreeNode::none) continue;
            bool any = node.count[i] == 0 && out.children_[node.child[i]] != 0;
            for (std::uint32_t k = 0; k < node.count[i]; ++k) any = any || out.taken_[tree.triangles[node.child[i] + k].id];
            if (any) out.children_[n] = static_cast<std::uint8_t>(out.children_[n] | 1u << i);
        }
    }
    return out;
}

ClosestPoint SurfaceIndex::closest(const Vec3& q, double radius,
                                   const std::function<bool(std::uint32_t)>& accept) const {
    return impl_->closest(q, radius, AcceptAsked{accept});
}

SegmentHit SurfaceIndex::firstHit(const Vec3& a, const Vec3& b, double before) const {
    const TriangleTree& tree = impl_->tree;
    if (tree.nodes.empty()) return {};
    SegmentHit best{before, ~0u};
    const Vec3 d = b - a, from = a - tree.centre;
    // Boxes are judged in single precision. Twice the farthest that hitTriangle() lets a hit lie off its triangle, and so
    // off the boxes, and what rounding of places and differences adds; `wide` is for the rounding of quotients.
    constexpr double single = std::numeric_limits<float>::epsilon();
    const double pad = 2 * mostOffNeedles * (2 * (tree.reach + maxAbs(from)) + maxAbs(d)) +
                       4 * eps * (tree.magnitude + maxAbs(a) + maxAbs(b)) + 4 * single * (tree.reach + maxAbs(from));
    constexpr auto wide = static_cast<float>(1 + 16 * single);
    float inverse[3], low[3], high[3];
    for (int k = 0; k < 3; ++k) { // a component of zero must not give 0 * inf
        const double s = std::abs(d[k]) < 1e-25 ? std::copysign(1e-25, d[k]) : d[k];
        inverse[k] = static_cast<float>(1 / s);
        low[k] = static_cast<float>(from[k] + (s > 0 ? pad : -pad)); // the side where the segment enters, moved against it
        high[k] = static_cast<float>(from[k] - (s > 0 ? pad : -pad));
    }
    const auto limitOf = [&](double t) { return static_cast<float>(t) * wide; };
    float limit = limitOf(best.t);
    TreeStack<float> stack;
    TreeStack<float>::Item item{0, 0, 0};
    while (true) {
        if (item.count > 0) {
            for (std::uint32_t i = 0; i < item.count; ++i) {
                const TreeTriangle& tri = tree.triangles[item.child + i];
                const double t = hitTriangle(a, d, tri);
                if (t < best.t || (t == best.t && t <= 1 && tri.id < best.triangle)) best = {t, tri.id};
            }
            limit = limitOf(best.t);
            if (!stack.pop(limit, item)) break;
            continue;
        }
        const TreeNode& node = tree.nodes[item.child];
        FloatLanes enter{}, leave = FloatLanes{} + limit;
        for (std::size_t k = 0; k < 3; ++k) {
            FloatLanes l, h;
            const bool up = inverse[k] > 0;
            std::memcpy(&l, up ? node.lo[k] : node.hi[k], sizeof l);
            std::memcpy(&h, up ? node.hi[k] : node.lo[k], sizeof h);
            const FloatLanes s = (l - low[k]) * inverse[k], e = (h - high[k]) * inverse[k];
            enter = s > enter ? s : enter;
            leave = e < leave ? e : leave;
        }
        leave *= wide;
        float key[4];
        std::memcpy(key, &enter, sizeof key);
        if (!stack.enter(tree, node, key, bitsOf(enter <= leave) & childrenOf(node), item) && !stack.pop(limit, item)) break;
    }
    return best ? best : SegmentHit{};
}

bool SurfaceIndex::overlaps(const Box& box) const {
    return impl_->walkBox(box, [&](const TreeTriangle& t) { return triangleMeetsBox(t.a, t.b, t.c, box); });
}

bool SurfaceIndex::any(const Box& box, const std::function<bool(std::uint32_t)>& accept) const {
    return impl_->walkBox(box, [&](const TreeTriangle& t) {
        return box.overlaps({cwiseMin(t.a, cwiseMin(t.b, t.c)), cwiseMax(t.a, cwiseMax(t.b, t.c))}) && accept(t.id);
    });
}

std::vector<std::uint32_t> SurfaceIndex::candidates(const Box& box) const {
    std::vector<std::uint32_t> found;
    any(box, [&](std::uint32_t t) {
        found.push_back(t);
        return false;
    });
    std::sort(found.begin(), found.end());
    return found;
}

// Most often asked of a triangle that a query has just found: the tree's copy of it is at hand, the surface's points are not.
Vec3 SurfaceIndex::normal(std::uint32_t triangle) const {
    const TreeTriangle& t = impl_->tree.triangles[impl_->tree.placeOf[triangle]];
    return normalized(cross(t.b - t.a, t.c - t.a));
}

} // namespace i2b
