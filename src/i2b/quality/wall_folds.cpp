#include "i2b/quality/wall_folds.h"
#include "i2b/core/collect.h"
#include "i2b/quality/line_capture.h"
#include <algorithm>

namespace i2b {
namespace {

bool isSame(const WallEdge& e, const WallEdge& f) { return e.a == f.a && e.b == f.b; }

// Of the wall's edges, those where two of its faces fold: places in wall.edges.
RawVector<std::size_t> foldsOf(const Wall& wall) {
    const std::vector<WallEdge>& edges = wall.edges;
    return collect<std::size_t>(edges.size(), [&](std::size_t i, const auto& put) {
        if (i > 0 && isSame(edges[i - 1], edges[i])) return; // told with the first
        bool folds = false;
        for (std::size_t end = i; end < edges.size() && isSame(edges[i], edges[end]); ++end)
            for (std::size_t k = i; k < end; ++k)
                folds |= isCrease(wall.shapes[static_cast<std::size_t>(edges[k].face)].area, wall.shapes[static_cast<std::size_t>(edges[end].face)].area);
        if (folds) put(i);
    }, 1024);
}

} // namespace

bool isCrease(const Vec3& m, const Vec3& n) { return norm2(m) > 0 && norm2(n) > 0 && degreesBetween(m, n) > creaseAngle; }

RawVector<WallEnd> endsOf(const PolyMesh& mesh, const Wall& wall) {
    const std::vector<WallEdge>& edges = wall.edges;
    const RawVector<std::size_t> ends = collect<std::size_t>(edges.size(), [&](std::size_t i, const auto& put) {
        if ((i == 0 || !isSame(edges[i - 1], edges[i])) && (i + 1 == edges.size() || !isSame(edges[i], edges[i + 1]))) put(i);
    }, 1024);
    if (ends.empty()) return {};
    const auto boundary = static_cast<std::size_t>(mesh.faces() - mesh.internalFaces());
    return collect<WallEnd>(boundary, [&](std::size_t i, const auto& put) {
        const std::int32_t f = mesh.internalFaces() + static_cast<std::int32_t>(i);
        if (std::binary_search(wall.faces.begin(), wall.faces.end(), f)) return;
        const auto face = mesh.face(f);
        for (std::size_t k = 0; k < face.size(); ++k) {
            const auto [a, b] = std::minmax(face[k], face[(k + 1) % face.size()]);
            const auto at = std::lower_bound(ends.begin(), ends.end(), WallEdge{a, b, -1}, [&](std::size_t end, const WallEdge& e) { return edges[end] < e; });
            if (at != ends.end() && edges[*at].a == a && edges[*at].b == b) put({*at, f});
        }
    }, 1024);
}

Surface creaseSurface(const PolyMesh& mesh, const Wall& wall, const RawVector<WallEnd>& ends) {
    Surface s;
    const auto add = [&](const WallEdge& e) { addSegment(s, mesh.points[static_cast<std::size_t>(e.a)], mesh.points[static_cast<std::size_t>(e.b)]); };
    for (const std::size_t i : foldsOf(wall)) add(wall.edges[i]);
    for (const WallEnd& end : ends) {
        const WallEdge& e = wall.edges[end.edge];
        if (isCrease(wall.shapes[static_cast<std::size_t>(e.face)].area, measureFace(mesh, end.face).area)) add(e);
    }
    return s;
}

} // namespace i2b
