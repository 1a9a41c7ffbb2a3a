#include "i2b/samples/builder.h"
#include "i2b/core/error.h"

namespace i2b::samples {
namespace {

Vec3 anySquareTo(const Vec3& w) {
    const Vec3 axis = std::abs(w.x) <= std::abs(w.y) && std::abs(w.x) <= std::abs(w.z) ? Vec3{1, 0, 0}
                      : std::abs(w.y) <= std::abs(w.z)                                 ? Vec3{0, 1, 0}
                                                                                       : Vec3{0, 0, 1};
    return normalized(cross(axis, w));
}

// Plane coordinates of a flat ring, counterclockwise.
Loop2 flattened(const Ring& ring) {
    Vec3 normal;
    for (std::size_t i = 0; i < ring.size(); ++i)
        normal += cross(ring[i] - ring[0], ring[(i + 1) % ring.size()] - ring[0]);
    const Vec3 w = normalized(normal), u = anySquareTo(w), v = cross(w, u);
    Loop2 loop;
    for (const Vec3& p : ring) loop.push_back({dot(p - ring[0], u), dot(p - ring[0], v)});
    return loop;
}

void addTriangle(Mesh& mesh, std::size_t a, std::size_t b, std::size_t c) {
    mesh.triangles.push_back({std::uint32_t(a), std::uint32_t(b), std::uint32_t(c)});
}

void addCap(Mesh& mesh, const Ring& ring, std::size_t first, bool reversed) {
    if (ring.size() < 3) return;
    for (const Triangle& t : triangulate({flattened(ring)}))
        if (reversed)
            addTriangle(mesh, first + t[0], first + t[2], first + t[1]);
        else
            addTriangle(mesh, first + t[0], first + t[1], first + t[2]);
}

// Between two rings that start at points a and b.
void addBand(Mesh& mesh, std::size_t a, std::size_t na, std::size_t b, std::size_t nb) {
    const std::size_t n = std::max(na, nb);
    for (std::size_t i = 0; i < n; ++i) {
        const std::size_t j = (i + 1) % n;
        if (na == 1)
            addTriangle(mesh, a, b + j, b + i);
        else if (nb == 1)
            addTriangle(mesh, a + i, a + j, b);
        else
            addTriangle(mesh, a + i, a + j, b + j), addTriangle(mesh, a + i, b + j, b + i);
    }
}

} // namespace

Frame upright(const Vec3& origin) { return {origin, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}; }
Frame lengthwise(double x) { return {{x, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 0}}; }
Frame along(const Vec3& origin, const Vec3& direction) {
    const Vec3 w = normalized(direction), u = anySquareTo(w);
    return {origin, u, cross(w, u), w};
}

void append(Mesh& to, const Mesh& more) {
    const auto base = std::uint32_t(to.points.size());
    to.points.insert(to.points.end(), more.points.begin(), more.points.end());
    for (const Triangle& t : more.triangles) to.triangles.push_back({t[0] + base, t[1] + base, t[2] + base});
}

Mesh moved(Mesh mesh, const Vec3& by) {
    for (Vec3& p : mesh.points) p += by;
    return mesh;
}

Mesh loft(const std::vector<Ring>& rings, Caps caps) {
    Mesh mesh;
    std::vector<std::size_t> first;
    for (const Ring& ring : rings) {
        first.push_back(mesh.points.size());
        mesh.points.insert(mesh.points.end(), ring.begin(), ring.end());
    }
    for (std::size_t k = 0; k + 1 < rings.size(); ++k)
        addBand(mesh, first[k], rings[k].size(), first[k + 1], rings[k + 1].size());
    if (caps.start) addCap(mesh, rings.front(), first.front(), true);
    if (caps.end) addCap(mesh, rings.back(), first.back(), false);
    return mesh;
}

Mesh extrude(const Frame& frame, const Loop2& outline, const std::vector<Loop2>& holes,
             const std::vector<double>& levels, Caps caps) {
    Mesh mesh;
    std::vector<Loop2> loops{outline};
    loops.insert(loops.end(), holes.begin(), holes.end());
    std::vector<std::uint32_t> bottom, top; // cap vertex of every loop point
    for (std::size_t l = 0; l < loops.size(); ++l) {
        const std::size_t n = loops[l].size(), base = mesh.points.size();
        const std::vector<double> heights =
            l == 0 ? levels : std::vector<double>{levels.front(), levels.back()};
        for (const double h : heights)
            for (const Vec2& p : loops[l]) mesh.points.push_back(frame.at(p.x, p.y, h));
        const std::size_t before = mesh.triangles.size();
        for (std::size_t k = 0; k + 1 < heights.size(); ++k)
            addBand(mesh, base + k * n, n, base + (k + 1) * n, n);
        for (std::size_t t = before; l > 0 && t < mesh.triangles.size(); ++t)
            std::swap(mesh.triangles[t][1], mesh.triangles[t][2]); // a hole's wall looks into the hole
        for (std::size_t i = 0; i < n; ++i) {
            bottom.push_back(std::uint32_t(base + i));
            top.push_back(std::uint32_t(base + (heights.size() - 1) * n + i));
        }
    }
    if (caps.start || caps.end)
        for (const Triangle& t : triangulate(loops)) {
            if (caps.start) addTriangle(mesh, bottom[t[0]], bottom[t[2]], bottom[t[1]]);
            if (caps.end) addTriangle(mesh, top[t[0]], top[t[1]], top[t[2]]);
        }
    return mesh;
}

Mesh stack(const Frame& frame, const std::vector<Section>& sections, Caps caps) {
    std::vector<Ring> rings;
    for (const Section& s : sections) {
        Ring& ring = rings.emplace_back();
        for (const Vec2& p : s.outline) ring.push_back(frame.at(p.x, p.y, s.height));
    }
    return loft(rings, caps);
}

Mesh lathe(const Frame& frame, const Profile& profile, int n, bool closed) {
    std::vector<Ring> rings;
    for (const Vec2& p : profile) {
        Ring& ring = rings.emplace_back();
        for (int i = 0; i < (p.x > 0 ? n : 1); ++i) {
            const Vec2 e = unitCircle(i, n) * p.x;
            ring.push_back(frame.at(e.x, e.y, p.y));
        }
    }
    Mesh mesh = loft(rings, {!closed, !closed});
    if (closed)
        addBand(mesh, mesh.points.size() - rings.back().size(), rings.back().size(), 0, rings[0].size());
    return mesh;
}

Mesh box(const Vec3& lo, const Vec3& hi) {
    return extrude(upright({}), {{lo.x, lo.y}, {hi.x, lo.y}, {hi.x, hi.y}, {lo.x, hi.y}}, {}, {lo.z, hi.z});
}

std::vector<Section> sectionsOf(const RoundedBox& s) {
    std::vector<Section> sections;
    const auto add = [&](double inset, double height) {
        const Vec2 d{inset, inset};
        const double r = std::max(s.corner - inset, 0.02 * s.corner);
        sections.push_back({roundedRectangle(s.lo + d, s.hi - d, r, s.segments), height});
    };
    add(0, s.bottom);
    if (s.fillet <= 0) {
        add(s.draft * (s.top - s.bottom), s.top);
        return sections;
    }
    const double shoulder = s.draft * (s.top - s.fillet - s.bottom);
    for (int i = 0; i <= s.segments; ++i) {
        const Vec2 e = unitCircle(i, 4 * s.segments);
        add(shoulder + s.fillet * (1 - e.x), s.top - s.fillet * (1 - e.y));
    }
    return sections;
}

Mesh roundedBox(const Frame& frame, const RoundedBox& shape, Caps caps) {
    return stack(frame, sectionsOf(shape), caps);
}

Mesh boltHead(const Vec3& origin, const Vec3& direction, double size) {
    return lathe(along(origin, direction),
                 {{0, -0.2 * size},
                  {0.5 * size, -0.2 * size},
                  {0.5 * size, 0.5 * size},
                  {0.42 * size, 0.6 * size},
                  {0, 0.6 * size}},
                 6);
}

void drop(Mesh& mesh, const std::function<bool(const Vec3&, const Vec3&)>& condition) {
    std::erase_if(mesh.triangles, [&](const Triangle& t) {
        const Vec3 a = mesh.points[t[0]], b = mesh.points[t[1]], c = mesh.points[t[2]];
        return condition((a + b + c) / 3, normalized(cross(b - a, c - a)));
    });
}

} // namespace i2b::samples
