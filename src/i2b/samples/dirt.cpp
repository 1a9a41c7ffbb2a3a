#include "i2b/samples/dirt.h"

namespace i2b::samples {

void duplicateSome(Mesh& mesh, std::size_t stride) {
    const std::size_t n = mesh.triangles.size();
    for (std::size_t i = 0, copy = 0; i < n; i += stride, ++copy) {
        Triangle t = mesh.triangles[i];
        if (copy % 2 == 1) std::swap(t[1], t[2]);
        mesh.triangles.push_back(t);
    }
}

void flipSome(Mesh& mesh, std::size_t stride) {
    for (std::size_t i = 0; i < mesh.triangles.size(); i += stride)
        std::swap(mesh.triangles[i][1], mesh.triangles[i][2]);
}

void addZeroArea(Mesh& mesh, std::size_t count) {
    const std::size_t n = mesh.triangles.size();
    for (std::size_t k = 0; k < count; ++k) {
        const Triangle t = mesh.triangles[k * n / count];
        if (k % 2 == 0) { // the middle of an edge against that edge
            mesh.points.push_back((mesh.points[t[0]] + mesh.points[t[1]]) * 0.5);
            mesh.triangles.push_back({t[0], std::uint32_t(mesh.points.size() - 1), t[1]});
        } else {
            mesh.triangles.push_back({t[0], t[0], t[0]});
        }
    }
}

void addRib(Mesh& mesh, const std::vector<std::uint32_t>& chain, const Vec3& off) {
    const auto base = std::uint32_t(mesh.points.size());
    for (const std::uint32_t i : chain) mesh.points.push_back(mesh.points[i] + off);
    for (std::uint32_t k = 0; k + 1 < chain.size(); ++k) {
        mesh.triangles.push_back({chain[k], chain[k + 1], base + k + 1});
        mesh.triangles.push_back({chain[k], base + k + 1, base + k});
    }
}

Mesh sheet(const Frame& frame, double width, double height, double sag, int nu, int nv) {
    Mesh mesh;
    for (int j = 0; j <= nv; ++j)
        for (int i = 0; i <= nu; ++i) {
            const double a = double(i) / nu, b = double(j) / nv;
            mesh.points.push_back(frame.at(a * width, b * height, sag * (4 * a * (1 - a) + 4 * b * (1 - b))));
        }
    const auto row = std::uint32_t(nu + 1);
    for (std::uint32_t j = 0; j < std::uint32_t(nv); ++j)
        for (std::uint32_t i = 0; i < std::uint32_t(nu); ++i) {
            const std::uint32_t a = j * row + i;
            mesh.triangles.push_back({a, a + 1, a + row + 1});
            mesh.triangles.push_back({a, a + row + 1, a + row});
        }
    return mesh;
}

} // namespace i2b::samples
