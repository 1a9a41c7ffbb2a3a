#include "samples/flood.h"

namespace i2b::test {
namespace {

// Separating axes of a triangle (relative to the box's centre) and a cube of half size h (Akenine-Moller
// 2001).
bool meets(const std::array<Vec3, 3>& v, double h) {
    const auto apart = [&](const Vec3& axis) {
        const double a = dot(axis, v[0]), b = dot(axis, v[1]), c = dot(axis, v[2]);
        const double r = h * (std::abs(axis.x) + std::abs(axis.y) + std::abs(axis.z)) * (1 + 1e-12);
        return std::min({a, b, c}) > r || std::max({a, b, c}) < -r;
    };
    const std::array<Vec3, 3> unit{Vec3{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    for (std::size_t i = 0; i < 3; ++i) {
        if (apart(unit[i])) return false;
        for (std::size_t k = 0; k < 3; ++k)
            if (apart(cross(unit[i], v[(k + 1) % 3] - v[k]))) return false;
    }
    return !apart(cross(v[1] - v[0], v[2] - v[0]));
}

} // namespace

std::size_t Voxels::at(const Vec3& p) const {
    const auto index = [&](double a, double lo, int n) {
        return std::size_t(std::clamp(int((a - lo) / size), 0, n - 1));
    };
    return (index(p.z, box.lo.z, nz) * std::size_t(ny) + index(p.y, box.lo.y, ny)) * std::size_t(nx) +
           index(p.x, box.lo.x, nx);
}

Voxels voxelise(const Surface& surface, double size, double margin, double shift) {
    Voxels out;
    for (const auto& t : surface.triangles)
        for (const auto i : t) out.box.add(surface.points[i]);
    const Vec3 more{margin, margin, margin}, off{shift * size, shift * size, shift * size};
    out.box.lo -= more + off;
    out.box.hi += more;
    out.size = size;
    const Vec3 e = out.box.extent() / size;
    out.nx = int(e.x) + 1, out.ny = int(e.y) + 1, out.nz = int(e.z) + 1;
    out.state.assign(std::size_t(out.nx) * std::size_t(out.ny) * std::size_t(out.nz), 0);
    for (const auto& t : surface.triangles) {
        std::array<Vec3, 3> v;
        Box b;
        for (std::size_t k = 0; k < 3; ++k) b.add(v[k] = (surface.points[t[k]] - out.box.lo) / size);
        const auto from = [](double a) { return int(std::floor(a - 1e-9)); };
        const auto to = [](double a) { return int(std::floor(a + 1e-9)); };
        for (int z = from(b.lo.z); z <= to(b.hi.z); ++z)
            for (int y = from(b.lo.y); y <= to(b.hi.y); ++y)
                for (int x = from(b.lo.x); x <= to(b.hi.x); ++x) {
                    const Vec3 centre{x + 0.5, y + 0.5, z + 0.5};
                    if (meets({v[0] - centre, v[1] - centre, v[2] - centre}, 0.5))
                        out.state[(std::size_t(z) * std::size_t(out.ny) + std::size_t(y)) *
                                      std::size_t(out.nx) +
                                  std::size_t(x)] = 1;
                }
    }
    return out;
}

void flood(Voxels& v, const Vec3& p) {
    std::vector<std::size_t> todo;
    const auto visit = [&](std::size_t i) {
        if (v.state[i] == 0) v.state[i] = 2, todo.push_back(i);
    };
    const std::size_t nx = std::size_t(v.nx), nxy = nx * std::size_t(v.ny);
    visit(v.at(p));
    while (!todo.empty()) {
        const std::size_t i = todo.back(), x = i % nx, y = i % nxy / nx, z = i / nxy;
        todo.pop_back();
        if (x > 0) visit(i - 1);
        if (x + 1 < nx) visit(i + 1);
        if (y > 0) visit(i - nx);
        if (y + 1 < std::size_t(v.ny)) visit(i + nx);
        if (z > 0) visit(i - nxy);
        if (z + 1 < std::size_t(v.nz)) visit(i + nxy);
    }
}

} // namespace i2b::test
