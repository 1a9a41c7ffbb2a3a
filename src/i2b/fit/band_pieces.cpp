#include "i2b/fit/band_pieces.h"
#include <algorithm>

namespace i2b {
namespace {

std::size_t vertexOf(std::vector<CellVertex>& list, std::int32_t node) {
    for (std::size_t i = 0; i < list.size(); ++i) {
        if (list[i].node == node) return i;
    }
    list.push_back({node, {-1, -1, -1, -1, -1, -1}});
    return list.size() - 1;
}

int directionOf(const Vec3& d) {
    const double ax = std::abs(d.x), ay = std::abs(d.y), az = std::abs(d.z);
    const int axis = ax >= ay && ax >= az ? 0 : ay >= az ? 1 : 2;
    return 2 * axis + (d[axis] > 0 ? 1 : 0);
}

// Edge of a cell along the normal over its smaller edge across.
double stretch(const Vec3& size, const Vec3& normal) {
    const int axis = directionOf(normal) / 2;
    return size[axis] / std::min(size[(axis + 1) % 3], size[(axis + 2) % 3]);
}

void addBox(int level, const Index3& c, const std::array<std::int32_t, 8>& nodes, CoreCellRoom& room, BandPieces& out) {
    const Index3 low{c[0] & 7, c[1] & 7, c[2] & 7};
    const auto end = [&](std::size_t k) { return Index3{low[0] + int(k & 1), low[1] + int(k >> 1 & 1), low[2] + int(k >> 2)}; };
    for (std::size_t k = 0; k < 8; ++k) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const std::int32_t n = nodes[k ^ std::size_t(1) << axis];
            if (n <= nodes[k]) continue;
            const std::uint64_t key = edgeKey(nodes[k], n);
            if (room.isNew(end(k & ~(std::size_t(1) << axis)), axis, key)) out.edges.push_back(key);
        }
    }
    out.cells.push_back({nodes, level});
}

} // namespace

void addCoreCell(const Band& band, LatticeMesh::Reader& reader, int level, const Index3& c,
                 const RawVector<std::int32_t>& nodeOf, CoreCellRoom& room, BandPieces& out) {
    if (std::array<std::int32_t, 8> nodes; reader.corners(level, c, nodes)) {
        for (std::int32_t& n : nodes) n = nodeOf[static_cast<std::size_t>(n)];
        addBox(level, c, nodes, room, out);
        return;
    }
    std::vector<CellVertex>& vertices = room.vertices;
    vertices.clear();
    reader.faces(level, c, [&](const CellFace& face) {
        for (std::size_t i = 0; i < face.vertices; ++i) {
            const std::int32_t a = nodeOf[static_cast<std::size_t>(face.points[i])];
            const std::int32_t b = nodeOf[static_cast<std::size_t>(face.points[(i + 1) % face.vertices])];
            const int d = directionOf(band.start[static_cast<std::size_t>(b)] - band.start[static_cast<std::size_t>(a)]);
            vertices[vertexOf(vertices, a)].next[static_cast<std::size_t>(d)] = b;
            vertices[vertexOf(vertices, b)].next[static_cast<std::size_t>(d ^ 1)] = a;
        }
    });
    const auto first = static_cast<std::int32_t>(out.corners.size());
    for (const CellVertex& v : vertices) {
        const Vec3& x = band.start[static_cast<std::size_t>(v.node)];
        const auto lengthTo = [&](std::int32_t n) { return norm(band.start[static_cast<std::size_t>(n)] - x); };
        std::array<std::int32_t, 4> parents{-1, -1, -1, -1};
        std::size_t count = 0;
        Corner corner{{v.node, -1, -1, -1}, {}, 1};
        int sign = 1;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const std::int32_t down = v.next[2 * axis], up = v.next[2 * axis + 1];
            if (down >= 0 && up >= 0) {
                if (count < 3) parents[count++] = down, parents[count++] = up;
            } else if (const std::int32_t n = down >= 0 ? down : up; n >= 0) {
                corner.node[axis + 1] = n;
                corner.inverseLength[axis] = static_cast<float>(1 / lengthTo(n));
                sign *= up >= 0 ? 1 : -1;
            }
            for (std::int32_t n : {down, up}) {
                if (n > v.node) out.edges.push_back(edgeKey(v.node, n)); // n has it too
            }
        }
        if (count > 0) {
            out.hanging.push_back({v.node, parents});
        } else if (corner.node[1] >= 0 && corner.node[2] >= 0 && corner.node[3] >= 0) {
            if (sign < 0) std::swap(corner.node[1], corner.node[2]), std::swap(corner.inverseLength[0], corner.inverseLength[1]);
            out.corners.push_back(corner);
        }
    }
    out.cells.push_back({{first, static_cast<std::int32_t>(out.corners.size())}, CornerCell::hasCorners});
}

std::size_t addPrism(const Band& band, const Front& front, std::size_t f, const PrismPieces& out) {
    std::array<std::int32_t, 8> wall{};
    int n = 0;
    for (auto v : front.mesh.fv_range(FrontMesh::FaceHandle(static_cast<int>(f)))) wall[static_cast<std::size_t>(n++)] = v.idx();
    std::size_t corners = 0;
    for (int i = 0; i < n; ++i) {
        const std::int32_t b = wall[static_cast<std::size_t>(i)], next = wall[static_cast<std::size_t>((i + 1) % n)], previous = wall[static_cast<std::size_t>((i + n - 1) % n)];
        const auto frontOf = [&](std::int32_t w) { return band.frontNode[static_cast<std::size_t>(w)]; };
        const auto at = [&](std::int32_t node) { return band.start[static_cast<std::size_t>(node)]; };
        const Vec3 x = at(frontOf(b)), e1 = at(frontOf(next)) - x, e2 = at(frontOf(previous)) - x;
        if (out.edges) out.edges->push_back(edgeKey(std::min(b, next), std::max(b, next)));
        if (norm2(cross(e1, e2)) < 0.25 * norm2(e1) * norm2(e2)) continue; // hangs on this polygon's edge
        corners += 2;
        if (!out.corners) continue;
        const double l1 = norm(e1), l2 = norm(e2);
        const double height = band.prismHeight(static_cast<std::size_t>(b)) * std::min(l1, l2) * stretch(front.size[static_cast<std::size_t>(b)], cross(e1, e2));
        const auto il1 = static_cast<float>(1 / l1), il2 = static_cast<float>(1 / l2), ih = static_cast<float>(1 / height);
        out.corners[corners - 2] = {{frontOf(b), frontOf(next), frontOf(previous), b}, {il1, il2, ih}, 4};
        out.corners[corners - 1] = {{b, previous, next, frontOf(b)}, {il2, il1, ih}, 4};
    }
    return corners;
}

} // namespace i2b
