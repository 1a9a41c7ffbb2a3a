#include "i2b/layers/side_angles.h"
#include "i2b/core/parallel.h"

namespace i2b {
namespace {

using Index = std::size_t;
constexpr double mostSkew = 3.3;     // of boundary faces; checkMesh takes 4, and repair may turn nodes a little
constexpr double leastExtent = 0.4;  // of the distance to a cell's centre, by which skewness is divided: checkMesh's
constexpr double step = 0.1;         // of the way from wall to front
constexpr int mostSteps = 8;

// The skewness, as checkMesh has it, of an endless thin strip along the edge from a to b on a side across an axis, of a cell
// over the wall face with that centre.
double stripSkewness(const Vec3& a, const Vec3& b, const Vec3& centre, int axis) {
    Vec3 miss = centre - (a + b) * 0.5;
    const double away = std::abs(miss[axis]);
    miss[axis] = 0;
    const double size = norm(miss);
    if (size == 0) return 0;
    return size / std::max(leastExtent * away, std::abs(dot(miss, b - a)) / (2 * size));
}

bool isTooSharp(const Front& front, FrontMesh::FaceHandle face) {
    Vec3 centre;
    int n = 0;
    for (auto v : front.mesh.fv_range(face)) centre += front.wall(Index(v.idx())), ++n;
    centre *= 1.0 / n;
    for (auto he : front.mesh.fh_range(face)) {
        if (front.mesh.opposite_face_handle(he).is_valid()) continue;
        const auto u = Index(front.mesh.from_vertex_handle(he).idx()), w = Index(front.mesh.to_vertex_handle(he).idx());
        for (int axis = 0; axis < 3; ++axis) {
            if (((front.outside[u] & front.outside[w]) >> (2 * axis) & 3) == 0) continue;
            if (stripSkewness(front.wall(u), front.wall(w), centre, axis) > mostSkew) return true;
        }
    }
    return false;
}

} // namespace

std::vector<std::uint8_t> steepenAtSides(Front& front) {
    std::vector<std::uint8_t> steps(front.front.size(), 0);
    std::vector<std::uint8_t> sharp(front.ownerCell.size(), 0);
    std::vector<Vec3> from(front.front.size());
    for (Index v = 0; v < from.size(); ++v) from[v] = front.wall(v);
    for (int round = 0; round < 2 * mostSteps; ++round) {
        parallelFor(sharp.size(), [&](Index f) {
            const FrontMesh::FaceHandle face(static_cast<int>(f));
            sharp[f] = front.mesh.is_boundary(face) && isTooSharp(front, face);
        });
        bool moves = false;
        for (Index v = 0; v < from.size(); ++v) {
            if (front.outside[v] == 0 || steps[v] == mostSteps) continue;
            const FrontMesh::VertexHandle vertex(static_cast<int>(v));
            bool wanted = false;
            for (auto f : front.mesh.vf_range(vertex)) wanted = wanted || sharp[Index(f.idx())];
            if (!wanted) continue;
            moves = true;
            const Vec3 b = from[v] + (front.front[v] - from[v]) * (step * ++steps[v]);
            front.mesh.set_point(vertex, {b.x, b.y, b.z});
        }
        if (!moves) break;
    }
    return steps;
}

} // namespace i2b
