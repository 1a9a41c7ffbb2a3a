#include "i2b/layers/wall_normals.h"
#include "i2b/core/parallel.h"
#include <array>

namespace i2b {
namespace {

constexpr std::size_t mostFaces = 16;      // around a vertex that are looked at; lattice and cuts give fewer
constexpr double leastVisible = 0.05;      // cosine

// Off the wall, the length twice the area (m^2).
Vec3 wallArea(const Front& front, FrontMesh::FaceHandle face) {
    Vec3 area, first, before;
    int n = 0;
    for (auto v : front.mesh.fv_range(face)) {
        const Vec3 p = front.wall(static_cast<std::size_t>(v.idx()));
        if (n == 0) first = p;
        if (n >= 2) area += cross(p - first, before - first); // against the sense of the face, whose normal is into the wall
        before = p, ++n;
    }
    return area;
}

double worstSeen(std::span<const Vec3> normals, const Vec3& from) {
    double worst = 1;
    for (const Vec3& n : normals) worst = std::min(worst, dot(n, from));
    return worst;
}

// Of a direction: without its parts across the sides of the domain.
Vec3 alongSides(Vec3 d, std::uint8_t outside) {
    for (int axis = 0; axis < 3; ++axis) {
        if (outside >> (2 * axis) & 3) d[axis] = 0;
    }
    return d;
}

} // namespace

Vec3 mostNormal(std::span<const Vec3> normals) {
    if (normals.size() == 1) return normals[0];
    Vec3 best;
    double most = -2;
    const auto offer = [&](const Vec3& d) {
        const double seen = worstSeen(normals, d);
        if (seen > most) most = seen, best = d;
    };
    for (std::size_t a = 0; a < normals.size(); ++a) {
        for (std::size_t b = a + 1; b < normals.size(); ++b) {
            offer(normalized(normals[a] + normals[b]));
            for (std::size_t c = b + 1; c < normals.size(); ++c) {
                const Vec3 axis = normalized(cross(normals[b] - normals[a], normals[c] - normals[a]));
                offer(dot(axis, normals[a]) < 0 ? -axis : axis);
            }
        }
    }
    return best;
}

std::vector<Vec3> wallNormals(const Front& front) {
    std::vector<Vec3> faceNormal(front.ownerCell.size());
    parallelFor(faceNormal.size(), [&](std::size_t f) {
        faceNormal[f] = normalized(wallArea(front, FrontMesh::FaceHandle(static_cast<int>(f))));
    });
    std::vector<Vec3> normals(front.front.size());
    parallelFor(normals.size(), [&](std::size_t v) {
        std::array<Vec3, mostFaces> around;
        std::size_t n = 0;
        for (auto f : front.mesh.vf_range(FrontMesh::VertexHandle(static_cast<int>(v)))) {
            const Vec3& normal = faceNormal[static_cast<std::size_t>(f.idx())];
            if (n < mostFaces && !(normal == Vec3{})) around[n++] = normal;
        }
        const std::span<const Vec3> seen(around.data(), n);
        if (n == 0) return;
        const Vec3 d = normalized(alongSides(mostNormal(seen), front.outside[v]));
        if (worstSeen(seen, d) > leastVisible) normals[v] = d;
    });
    return normals;
}

} // namespace i2b
