#include "pipeline/random_case.h"
#include <algorithm>
#include <array>
#include <cstdlib>
#include <numbers>
#include <random>

namespace i2b::test {
namespace {

class Maker {
  public:
    explicit Maker(unsigned seed) : random_(seed) {}

    double real(double lo, double hi) { // the standard's distributions differ between libraries
        return lo + (hi - lo) * (static_cast<double>(random_()) / 4294967296.0);
    }
    int whole(int lo, int hi) {
        return lo + static_cast<int>(random_() % static_cast<unsigned>(hi - lo + 1));
    }
    bool chance(double p) { return real(0, 1) < p; }
    Vec3 point(double r) {
        const double x = real(-r, r), y = real(-r, r), z = real(-r, r);
        return {x, y, z};
    }
    Vec3 direction() {
        for (;;) {
            const Vec3 p = point(1);
            if (norm2(p) > 0.01 && norm2(p) <= 1) return normalized(p);
        }
    }

    int part(const std::string& name) {
        soup.parts.push_back({name, "", 0});
        return static_cast<int>(soup.parts.size()) - 1;
    }
    void triangle(int part, const Vec3& a, const Vec3& b, const Vec3& c) {
        const auto n = static_cast<std::uint32_t>(soup.points.size());
        soup.points.insert(soup.points.end(), {a, b, c});
        if (flip && chance(0.5)) {
            soup.triangles.push_back({n, n + 2, n + 1});
        } else {
            soup.triangles.push_back({n, n + 1, n + 2});
        }
        soup.partOf.push_back(part);
        ++soup.parts[static_cast<std::size_t>(part)].triangles;
    }
    void quad(int part, const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
        triangle(part, a, b, c);
        triangle(part, a, c, d);
    }
    // Corners o + any sum of the three edges.
    void block(int part, const Vec3& o, const Vec3& u, const Vec3& v, const Vec3& w) {
        quad(part, o, o + v, o + u + v, o + u);
        quad(part, o + w, o + u + w, o + u + v + w, o + v + w);
        quad(part, o, o + u, o + u + w, o + w);
        quad(part, o + v, o + v + w, o + u + v + w, o + u + v);
        quad(part, o, o + w, o + v + w, o + v);
        quad(part, o + u, o + u + v, o + u + v + w, o + u + w);
    }
    void frame(Vec3& u, Vec3& v, Vec3& w) {
        u = direction();
        v = normalized(cross(u, direction()));
        w = cross(u, v);
    }
    // Every triangle is moved by up to crack: the surface is torn open along all its edges. top: a part for z
    // > centre.
    void sphere(int part, int top, const Vec3& centre, double radius, double crack, int n = 10) {
        constexpr double pi = std::numbers::pi;
        const auto at = [&](int i, int j) {
            const double a = pi * i / n, b = pi * j / n;
            return centre + Vec3{std::sin(a) * std::cos(b), std::sin(a) * std::sin(b), std::cos(a)} * radius;
        };
        const auto put = [&](const Vec3& a, const Vec3& b, const Vec3& c) {
            const Vec3 shift = crack > 0 ? point(crack) : Vec3{};
            triangle((a.z + b.z + c.z) / 3 > centre.z ? top : part, a + shift, b + shift, c + shift);
        };
        for (int i = 0; i < n; ++i) {
            for (int j = 0; j < 2 * n; ++j) {
                if (i > 0) put(at(i, j), at(i + 1, j), at(i, j + 1));
                if (i + 1 < n) put(at(i, j + 1), at(i + 1, j), at(i + 1, j + 1));
            }
        }
    }

    Surface soup;
    bool flip = true;

  private:
    std::mt19937 random_;
};

void scattered(Maker& m, double) { // triangles anywhere, through the domain's sides too
    const int p = m.part("scatter"), n = m.whole(1, 25);
    for (int i = 0; i < n; ++i) {
        const Vec3 c = m.point(1);
        const double r = m.real(0.05, 0.8);
        const Vec3 a = m.point(r), b = m.point(r), d = m.point(r);
        m.triangle(p, c + a, c + b, c + d);
    }
}

void tornSphere(Maker& m, double h) {
    const int p = m.part("ball");
    m.sphere(p, p, m.point(0.2), m.real(0.35, 0.65), 0.2 * h);
}

void rotatedBoxes(Maker& m, double) {
    for (int i = m.whole(2, 4); i > 0; --i) {
        Vec3 u, v, w;
        m.frame(u, v, w);
        const Vec3 o = m.point(0.4);
        const double a = m.real(0.2, 0.8), b = m.real(0.1, 0.6), c = m.real(0.05, 0.5);
        m.block(m.part("box" + std::to_string(i)), o - (u * a + v * b + w * c) * 0.5, u * a, v * b, w * c);
    }
}

void plates(Maker& m, double h) {
    const int p = m.part("plates");
    for (int i = m.whole(1, 4); i > 0; --i) {
        Vec3 u, v, w;
        m.frame(u, v, w);
        if (m.chance(0.4)) u = {1, 0, 0}, v = {0, 1, 0}, w = {0, 0, 1};
        const Vec3 o = m.point(0.5);
        const double a = m.real(0.1, 0.9), b = m.real(0.1, 0.9), gap = m.real(0, 2.5) * h;
        m.quad(p, o, o + u * a, o + u * a + v * b, o + v * b);
        if (m.chance(0.5))
            m.quad(p, o + w * gap, o + u * a + w * gap, o + u * a + v * b + w * gap, o + v * b + w * gap);
    }
}

void nested(Maker& m, double h) {
    const Vec3 c = m.point(0.1);
    const double crack = m.chance(0.5) ? 0.15 * h : 0;
    const int outer = m.part("outer"), inner = m.part("inner");
    m.sphere(outer, outer, c, 0.8, crack);
    m.sphere(inner, inner, c + m.point(0.1), m.real(0.3, 0.5), crack);
}

// A ball or a box with its centre on a side, an edge or a corner of the domain.
void throughSides(Maker& m, double h) {
    Vec3 c = m.point(0.3);
    const int sides = m.whole(1, 3);
    for (int i = 0; i < sides; ++i) c[i] = m.chance(0.5) ? 1 : -1;
    for (int i = m.whole(0, 2); i > 0; --i) c = {c.y, c.z, c.x};
    const int p = m.part("body");
    if (m.chance(0.5)) return m.sphere(p, p, c + m.point(0.1 * h), m.real(0.3, 0.7), 0);
    Vec3 u{1, 0, 0}, v{0, 1, 0}, w{0, 0, 1};
    if (m.chance(0.7)) m.frame(u, v, w);
    const double a = m.real(0.3, 1), b = m.real(0.3, 1), d = m.real(0.1, 0.6);
    m.block(p, c - (u * a + v * b + w * d) * 0.5, u * a, v * b, w * d);
}

// Axis-parallel blocks whose faces lie on planes of cells, some flush with a domain side.
void onLatticePlanes(Maker& m, double h) {
    const int p = m.part("blocks");
    for (int i = m.whole(1, 4); i > 0; --i) {
        Vec3 lo, e;
        for (int k = 0; k < 3; ++k) {
            lo[k] = -1 + 0.5 * h * m.whole(0, 20);
            e[k] = 0.5 * h * m.whole(1, 12);
        }
        m.block(p, lo, {e.x, 0, 0}, {0, e.y, 0}, {0, 0, e.z});
    }
}

void twoSizes(Maker& m, double) {
    const int coarse = m.part("coarse"), fine = m.part("fine");
    const Vec3 c = m.point(0.2);
    if (m.chance(0.5)) return m.sphere(coarse, fine, c, m.real(0.35, 0.6), 0);
    Vec3 u, v, w;
    m.frame(u, v, w);
    m.block(coarse, c - (u + v + w) * 0.3, u * 0.6, v * 0.6, w * 0.6);
    m.block(fine, c + u * 0.1 - (v + w) * 0.1, u * 0.6, v * 0.2, w * 0.2);
}

// A box of sheets with the fluid inside, sheets running on past its edges.
void closedRoom(Maker& m, double) {
    const int p = m.part("room");
    Vec3 u{1, 0, 0}, v{0, 1, 0}, w{0, 0, 1};
    if (m.chance(0.7)) m.frame(u, v, w);
    const std::array<Vec3, 3> axes{u, v, w};
    const double reach = m.chance(0.5) ? 1.2 : 1;
    const double half = m.real(0.35, 0.5);
    for (std::size_t i = 0; i < 3; ++i) {
        const Vec3 a = axes[(i + 1) % 3] * (half * reach), b = axes[(i + 2) % 3] * (half * reach);
        for (double s : {-half, half}) {
            const Vec3 c = axes[i] * s;
            m.quad(p, c - a - b, c + a - b, c + a + b, c - a + b);
        }
    }
}

// Thin slabs, needles and wedges below the cell size.
void thinThings(Maker& m, double h) {
    const int p = m.part("thin");
    for (int i = m.whole(1, 4); i > 0; --i) {
        Vec3 u, v, w;
        m.frame(u, v, w);
        const Vec3 o = m.point(0.5);
        const double a = m.real(0.3, 1), b = m.chance(0.5) ? m.real(0.3, 1) : m.real(0, 1) * h,
                     t = m.real(0, 1.5) * h;
        const Vec3 tip = m.chance(0.5) ? w * t : w * (0.01 * h); // a wedge, or a slab
        m.quad(p, o, o + u * a, o + u * a + v * b, o + v * b);
        m.quad(p, o + w * t, o + u * a + tip, o + u * a + v * b + tip, o + v * b + w * t);
        m.quad(p, o, o + v * b, o + v * b + w * t, o + w * t);
    }
}

} // namespace

RandomCase randomCase(unsigned seed) {
    Maker m(seed * 2654435761u + 12345u);
    RandomCase c;
    Options& o = c.options;
    const double h = m.chance(0.5) ? 0.125 : m.real(0.11, 0.2);
    o.size.surface = h;
    o.size.max = h * (m.chance(0.7) ? 2 : 4);
    o.size.bufferCells = m.whole(1, 3);
    o.domain.box = Box{{-1, -1, -1}, {1, 1, 1}};
    o.domain.flow = Flow::external;
    o.layers.count = m.whole(1, 4);
    o.layers.growth = m.real(1, 1.4);
    if (m.chance(0.3)) o.layers.first = m.real(0.02, 0.2) * h;
    m.flip = m.chance(0.5);
    switch (seed % caseKinds) {
    case 0:
        c.kind = "scattered triangles", scattered(m, h);
        break;
    case 1:
        c.kind = "torn sphere", tornSphere(m, h);
        break;
    case 2:
        c.kind = "rotated boxes", rotatedBoxes(m, h);
        break;
    case 3:
        c.kind = "plates", plates(m, h);
        break;
    case 4:
        c.kind = "nested spheres", nested(m, h);
        break;
    case 5:
        c.kind = "through sides", throughSides(m, h);
        break;
    case 6:
        c.kind = "on lattice planes", onLatticePlanes(m, h);
        break;
    case 7:
        c.kind = "two sizes", twoSizes(m, h);
        break;
    case 8:
        c.kind = "closed room", closedRoom(m, h);
        break;
    default:
        c.kind = "thin things", thinThings(m, h);
        break;
    }
    if (seed % caseKinds == 7) {
        o.size.parts.push_back({"fine", sameSize(h / (m.chance(0.8) ? 2 : 4))});
        o.size.max = h * 2;
    } else if (m.chance(0.25)) {
        o.size.boxes.push_back({{m.point(0.6), {}}, sameSize(h / 2)});
        o.size.boxes.back().box.hi = o.size.boxes.back().box.lo + Vec3{0.3, 0.2, 0.4};
    }
    if (seed % caseKinds == 8 || (seed % caseKinds == 1 && m.chance(0.4))) o.domain.flow = Flow::internal;
    if (seed % caseKinds == 4) {
        o.domain.flow = Flow::automatic;
        o.domain.seeds = {{"shell", {0, 0, 0.62}}};
        if (m.chance(0.7)) o.domain.seeds.push_back({"core", {0, 0, 0}});
        if (m.chance(0.5)) o.domain.seeds.push_back({"outside", {-0.9, -0.9, -0.9}});
    }
    c.soup = std::move(m.soup);
    return c;
}

unsigned firstRandomCase() {
    const char* text = std::getenv("I2B_FIRST_CASE");
    return text ? static_cast<unsigned>(std::max(0, std::atoi(text))) : 0;
}

} // namespace i2b::test
