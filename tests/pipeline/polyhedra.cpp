#include "pipeline/polyhedra.h"
#include <algorithm>

namespace i2b::test {
namespace {

constexpr double tolerance = 1e-9; // of bodies about as large as 1

bool holds(const std::vector<Vec3>& points, const Vec3& p) {
    return std::ranges::any_of(points, [&](const Vec3& q) { return norm(q - p) < tolerance; });
}

std::vector<Vec3> cornersOf(const std::vector<Vec3>& normals) {
    std::vector<Vec3> corners;
    for (std::size_t i = 0; i < normals.size(); ++i)
        for (std::size_t j = i + 1; j < normals.size(); ++j)
            for (std::size_t k = j + 1; k < normals.size(); ++k) {
                const Vec3 &a = normals[i], &b = normals[j], &c = normals[k];
                const double det = dot(a, cross(b, c));
                if (std::abs(det) < tolerance) continue;
                const Vec3 x = (cross(b, c) + cross(c, a) + cross(a, b)) / det; // on all three planes
                const auto isBeyond = [&](const Vec3& n) { return dot(n, x) > 1 + tolerance; };
                if (std::ranges::none_of(normals, isBeyond) && !holds(corners, x)) corners.push_back(x);
            }
    return corners;
}

// The corners on the plane n . x = 1, counterclockwise seen from outside.
std::vector<std::uint32_t> faceOf(const std::vector<Vec3>& corners, const Vec3& n) {
    std::vector<std::uint32_t> face;
    for (std::uint32_t i = 0; i < corners.size(); ++i)
        if (std::abs(dot(n, corners[i]) - 1) < tolerance) face.push_back(i);
    const Vec3 middle = n / norm2(n), u = normalized(corners[face.front()] - middle);
    const Vec3 v = cross(normalized(n), u);
    const auto angle = [&](std::uint32_t i) {
        const Vec3 d = corners[i] - middle;
        return std::atan2(dot(d, v), dot(d, u));
    };
    std::ranges::sort(face, [&](std::uint32_t a, std::uint32_t b) { return angle(a) < angle(b); });
    return face;
}

} // namespace

std::vector<Vec3> signedPermutations(const Vec3& p, bool evenSigns) {
    std::vector<Vec3> all;
    std::array<double, 3> c{p.x, p.y, p.z};
    std::ranges::sort(c);
    do {
        for (unsigned signs = 0; signs < 8; ++signs) {
            if (evenSigns && __builtin_popcount(signs) % 2 != 0) continue;
            const Vec3 q{signs & 1 ? -c[0] : c[0], signs & 2 ? -c[1] : c[1], signs & 4 ? -c[2] : c[2]};
            if (!holds(all, q)) all.push_back(q);
        }
    } while (std::ranges::next_permutation(c).found);
    return all;
}

std::vector<Vec3> icosahedronVertices() {
    const double g = (1 + std::sqrt(5.0)) / 2;
    std::vector<Vec3> all;
    for (const double a : {-1.0, 1.0})
        for (const double b : {-g, g})
            for (const Vec3& p : {Vec3{0, a, b}, {a, b, 0}, {b, 0, a}}) all.push_back(normalized(p));
    return all;
}

samples::Mesh polyhedron(const std::vector<Vec3>& normals) {
    samples::Mesh mesh{cornersOf(normals), {}};
    for (const Vec3& n : normals) {
        const std::vector<std::uint32_t> face = faceOf(mesh.points, n);
        for (std::size_t k = 1; k + 1 < face.size(); ++k)
            mesh.triangles.push_back({face[0], face[k], face[k + 1]});
    }
    return mesh;
}

samples::Mesh stellated(const std::vector<Vec3>& normals) {
    const std::vector<Vec3> corners = cornersOf(normals);
    samples::Mesh mesh{corners, {}};
    for (const Vec3& n : normals) {
        double next = 0; // n . m for the normals m of the faces beside this one: the largest but its own
        for (const Vec3& m : normals)
            if (norm(m - n) > tolerance) next = std::max(next, dot(n, m));
        const auto apex = static_cast<std::uint32_t>(mesh.points.size());
        mesh.points.push_back(n / next);
        const std::vector<std::uint32_t> face = faceOf(corners, n);
        for (std::size_t k = 0; k < face.size(); ++k)
            mesh.triangles.push_back({face[k], face[(k + 1) % face.size()], apex});
    }
    return mesh;
}

samples::Mesh fitted(samples::Mesh mesh, double radius) {
    double farthest = 0;
    for (const Vec3& p : mesh.points) farthest = std::max(farthest, norm(p));
    for (Vec3& p : mesh.points) p *= radius / farthest;
    return mesh;
}

} // namespace i2b::test
