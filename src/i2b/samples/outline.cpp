#include "i2b/samples/outline.h"

namespace i2b::samples {
namespace {

constexpr double pi = 3.14159265358979323846;

// (cos, sin) for angles in [0, pi/4]; Taylor series, error below 1e-16.
Vec2 smallAngle(double a) {
    const double q = a * a;
    double c = 1, s = 1;
    for (int k = 9; k > 0; --k) {
        c = 1 - q / ((2.0 * k) * (2.0 * k - 1)) * c;
        s = 1 - q / ((2.0 * k) * (2.0 * k + 1)) * s;
    }
    return {c, a * s};
}

Vec2 unit(Vec2 a) { return a * (1 / std::sqrt(dot(a, a))); }

// Directions from a to b (unit vectors less than half a turn apart) in n equal steps, end points included.
std::vector<Vec2> fan(Vec2 a, Vec2 b, int n) {
    std::vector<Vec2> out{a};
    // Half-angle bisection gives equal steps for powers of two; others are read off the next power by chord.
    int m = 1;
    while (m < n) m *= 2;
    std::vector<Vec2> fine{a, b};
    for (int count = 1; count < m; count *= 2) {
        std::vector<Vec2> next;
        for (std::size_t i = 0; i + 1 < fine.size(); ++i) {
            next.push_back(fine[i]);
            next.push_back(unit(fine[i] + fine[i + 1]));
        }
        next.push_back(fine.back());
        fine = std::move(next);
    }
    for (int i = 1; i < n; ++i) {
        const double t = double(i) * m / n;
        const auto k = std::size_t(t);
        out.push_back(unit(fine[k] * (double(k) + 1 - t) + fine[k + 1] * (t - double(k))));
    }
    out.push_back(b);
    return out;
}

} // namespace

Vec2 unitCircle(int i, int n) {
    i = ((i % n) + n) % n;
    const int quarter = 4 * i / n, rest = 4 * i % n;
    const Vec2 e = 2 * rest <= n ? smallAngle(pi / 2 * rest / n) : [&] {
        const Vec2 f = smallAngle(pi / 2 * (n - rest) / n);
        return Vec2{f.y, f.x};
    }();
    switch (quarter) {
    case 0:
        return e;
    case 1:
        return {-e.y, e.x};
    case 2:
        return {-e.x, -e.y};
    default:
        return {e.y, -e.x};
    }
}

Loop2 circle(Vec2 centre, double radius, int n) {
    Loop2 loop;
    for (int i = 0; i < n; ++i) loop.push_back(centre + unitCircle(i, n) * radius);
    return loop;
}

Loop2 roundedRectangle(Vec2 lo, Vec2 hi, double radius, int n) {
    const Vec2 a{lo.x + radius, lo.y + radius}, b{hi.x - radius, hi.y - radius};
    const std::array<Vec2, 4> centres{b, Vec2{a.x, b.y}, a, Vec2{b.x, a.y}};
    Loop2 loop;
    for (int k = 0; k < 4; ++k)
        for (int i = 0; i <= n; ++i)
            loop.push_back(centres[std::size_t(k)] + unitCircle(k * n + i, 4 * n) * radius);
    return loop;
}

Loop2 filletedPolygon(const std::vector<Vec2>& corners, const std::vector<double>& radii, int n) {
    Loop2 loop;
    const std::size_t count = corners.size();
    for (std::size_t k = 0; k < count; ++k) {
        const Vec2 p = corners[k], d0 = unit(p - corners[(k + count - 1) % count]),
                   d1 = unit(corners[(k + 1) % count] - p);
        if (radii[k] <= 0) {
            loop.push_back(p);
            continue;
        }
        const double turn = cross(d0, d1), side = turn > 0 ? 1 : -1;
        const double trim = radii[k] * std::abs(turn) / (1 + dot(d0, d1)); // r tan(half the turn)
        const Vec2 centre = p - d0 * trim + Vec2{-d0.y, d0.x} * (side * radii[k]);
        for (const Vec2& d : fan(d0, d1, n)) loop.push_back(centre + Vec2{d.y, -d.x} * (side * radii[k]));
    }
    return loop;
}

Loop2 offset(const Loop2& loop, double d) {
    const std::size_t n = loop.size();
    Loop2 out;
    for (std::size_t i = 0; i < n; ++i) {
        const Vec2 a = unit(loop[i] - loop[(i + n - 1) % n]), b = unit(loop[(i + 1) % n] - loop[i]);
        const Vec2 na{a.y, -a.x}, nb{b.y, -b.x};
        out.push_back(loop[i] + (na + nb) * (d / (1 + dot(na, nb))));
    }
    return out;
}

Loop2 subdivided(const Loop2& loop, double length) {
    Loop2 out;
    for (std::size_t i = 0; i < loop.size(); ++i) {
        const Vec2 a = loop[i], b = loop[(i + 1) % loop.size()];
        const int n = std::max(1, int(std::ceil(std::sqrt(dot(b - a, b - a)) / length - 1e-9)));
        for (int k = 0; k < n; ++k) out.push_back(a + (b - a) * (double(k) / n));
    }
    return out;
}

Loop2 gear(Vec2 centre, double inner, double outer, int teeth) {
    Loop2 loop;
    for (int i = 0; i < 4 * teeth; ++i)
        loop.push_back(centre + unitCircle(i, 4 * teeth) * (i % 4 < 2 ? outer : inner));
    return loop;
}

std::uint32_t nearest(const Loop2& loop, Vec2 p) {
    const auto far = [&](Vec2 a) { return dot(a - p, a - p); };
    const auto it =
        std::min_element(loop.begin(), loop.end(), [&](Vec2 a, Vec2 b) { return far(a) < far(b); });
    return std::uint32_t(it - loop.begin());
}

std::vector<double> levels(double from, double to, int n) {
    std::vector<double> values;
    for (int i = 0; i <= n; ++i) values.push_back(from + (to - from) * i / n);
    return values;
}

Loop2 convexHull(std::vector<Vec2> points) {
    std::sort(points.begin(), points.end(),
              [](Vec2 a, Vec2 b) { return a.x != b.x ? a.x < b.x : a.y < b.y; });
    Loop2 hull;
    for (int pass = 0; pass < 2; ++pass) {
        const std::size_t base = hull.size();
        for (const Vec2& p : points) {
            while (hull.size() >= base + 2 &&
                   cross(hull[hull.size() - 1] - hull[hull.size() - 2], p - hull[hull.size() - 1]) <= 0)
                hull.pop_back();
            hull.push_back(p);
        }
        hull.pop_back();
        std::reverse(points.begin(), points.end());
    }
    return hull;
}

} // namespace i2b::samples
