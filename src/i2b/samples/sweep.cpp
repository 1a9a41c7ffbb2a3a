// Paths, sweeps and pipes grown out of walls.
#include "i2b/samples/builder.h"

namespace i2b::samples {
namespace {

// Reflection in the plane square to d.
Vec3 mirrored(const Vec3& a, const Vec3& d) { return a - d * (2 * dot(a, d) / norm2(d)); }

// Unit tangents: mean of the neighbouring sides inside, the side itself at the ends.
std::vector<Vec3> tangents(const Path& path) {
    std::vector<Vec3> t(path.size());
    for (std::size_t i = 0; i < path.size(); ++i) {
        const Vec3 in = i > 0 ? normalized(path[i] - path[i - 1]) : Vec3{};
        const Vec3 out = i + 1 < path.size() ? normalized(path[i + 1] - path[i]) : Vec3{};
        t[i] = normalized(in + out);
    }
    return t;
}

} // namespace

Path bentPath(const Path& corners, double radius, int segments) {
    Path path{corners.front()};
    for (std::size_t k = 1; k + 1 < corners.size(); ++k) {
        const Vec3 p = corners[k], d0 = normalized(p - corners[k - 1]), d1 = normalized(corners[k + 1] - p);
        const double c = dot(d0, d1);
        const double trim = radius * std::sqrt(std::max(0.0, (1 - c) / (1 + c)));
        const Vec3 centre = p - d0 * trim + normalized(d1 - d0 * c) * radius;
        std::vector<Vec3> spokes{normalized(p - d0 * trim - centre), normalized(p + d1 * trim - centre)};
        for (int n = 1; n < segments; n *= 2) {
            std::vector<Vec3> next;
            for (std::size_t i = 0; i + 1 < spokes.size(); ++i) {
                next.push_back(spokes[i]);
                next.push_back(normalized(spokes[i] + spokes[i + 1]));
            }
            next.push_back(spokes.back());
            spokes = std::move(next);
        }
        for (const Vec3& s : spokes) path.push_back(centre + s * radius);
    }
    path.push_back(corners.back());
    return path;
}

// Double reflection (Wang, Juttler, Zheng and Liu 2008, "Computation of rotation minimizing frames").
std::vector<Ring> sweepRings(const Path& path, const Loop2& outline, const Vec3& up,
                             const std::vector<double>& scale) {
    const std::vector<Vec3> t = tangents(path);
    Vec3 v = normalized(up - t[0] * dot(up, t[0]));
    if (norm2(v) < 0.5) v = along({}, t[0]).v;
    std::vector<Ring> rings;
    for (std::size_t i = 0; i < path.size(); ++i) {
        if (i > 0) {
            const Vec3 d = path[i] - path[i - 1];
            const Vec3 vl = mirrored(v, d), tl = mirrored(t[i - 1], d);
            const Vec3 e = t[i] - tl;
            v = norm2(e) > 1e-30 ? mirrored(vl, e) : vl;
        }
        const Vec3 u = cross(v, t[i]);
        const double s = scale.empty() ? 1 : scale[i];
        Ring& ring = rings.emplace_back();
        for (const Vec2& p : outline) ring.push_back(path[i] + u * (s * p.x) + v * (s * p.y));
    }
    return rings;
}

Mesh sweep(const Path& path, const Loop2& outline, const Vec3& up, Caps caps) {
    return loft(sweepRings(path, outline, up), caps);
}

Mesh pipe(const Path& path, double radius, int n, Caps caps) {
    return sweep(path, circle({}, radius, n), {0, 0, 1}, caps);
}

std::vector<std::uint32_t> perforate(Mesh& mesh, std::size_t n, std::size_t l0, std::size_t l1,
                                     std::size_t i0, std::size_t i1) {
    const auto inside = [&](std::size_t point) {
        const std::size_t l = point / n, i = point % n;
        return l >= l0 && l <= l1 && ((i >= i0 && i <= i1) || (i + n >= i0 && i + n <= i1));
    };
    std::erase_if(mesh.triangles,
                  [&](const Triangle& t) { return inside(t[0]) && inside(t[1]) && inside(t[2]); });
    std::vector<std::uint32_t> rim;
    const auto add = [&](std::size_t l, std::size_t i) { rim.push_back(std::uint32_t(l * n + i % n)); };
    for (std::size_t i = i0; i < i1; ++i) add(l0, i);
    for (std::size_t l = l0; l < l1; ++l) add(l, i1);
    for (std::size_t i = i1; i > i0; --i) add(l1, i);
    for (std::size_t l = l1; l > l0; --l) add(l, i0);
    return rim;
}

void growPipe(Mesh& mesh, const std::vector<std::uint32_t>& rim, const Path& path, double radius,
              bool capped) {
    const int n = int(rim.size());
    // The circle starts where the rim does, so that the blend does not twist.
    const Vec3 start = mesh.points[rim[0]] - path[0];
    std::vector<Ring> rings = sweepRings(path, circle({}, radius, n), cross(path[1] - path[0], start));
    Mesh grown = loft(rings, {false, capped});
    const auto base = std::uint32_t(mesh.points.size());
    append(mesh, grown);
    for (std::uint32_t i = 0; i < std::uint32_t(n); ++i) {
        const std::uint32_t j = (i + 1) % std::uint32_t(n);
        mesh.triangles.push_back({rim[i], rim[j], base + j});
        mesh.triangles.push_back({rim[i], base + j, base + i});
    }
}

} // namespace i2b::samples
