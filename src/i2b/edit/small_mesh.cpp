#include "i2b/edit/small_mesh.h"
#include "i2b/core/numbering.h"
#include <algorithm>

namespace i2b {

using Index = std::size_t;

void SmallMesh::addCell(std::int32_t cell, bool isInner) {
    cells_.push_back(cell);
    if (isInner) inner_.push_back(cell);
}

void SmallMesh::addFace(const std::vector<std::int32_t>& loop, std::int32_t own, std::int32_t next) {
    faces_.push_back({own, next, loops_.size(), loops_.size() + loop.size()});
    loops_.insert(loops_.end(), loop.begin(), loop.end());
}

LocalEdits::Surroundings SmallMesh::build(const std::function<Vec3(std::int32_t)>& placeOf, std::vector<std::int32_t>* ids) {
    Numbering cells, points;
    for (const std::int32_t c : cells_) cells.add(c);
    for (const std::int32_t p : loops_) points.add(p);
    cells.close(), points.close();
    if (ids) *ids = points.items();
    LocalEdits::Surroundings result;
    PolyMesh& mesh = result.mesh;
    mesh.cells = static_cast<std::int32_t>(cells.items().size());
    result.outerCells.assign(cells.items().size(), 1);
    for (const std::int32_t c : inner_) result.outerCells[Index(cells.placeOf(c))] = 0;
    for (const std::int32_t p : points.items()) mesh.points.push_back(placeOf(p));
    mesh.faceOffsets.push_back(0);
    const auto isOuter = [&](std::int32_t cell) { return cell < 0 || result.outerCells[Index(cell)] != 0; };
    for (const bool internal : {true, false}) {
        for (const Face& face : faces_) {
            const std::int32_t own = cells.placeOf(face.own), next = face.next < 0 ? -1 : cells.placeOf(face.next);
            if ((own >= 0 && next >= 0) != internal) continue;
            const auto begin = loops_.begin() + static_cast<std::ptrdiff_t>(face.begin), end = loops_.begin() + static_cast<std::ptrdiff_t>(face.end);
            if (own < 0 || (internal && own > next)) std::reverse(begin + 1, end);
            for (auto p = begin; p != end; ++p) mesh.faceVertices.push_back(points.placeOf(*p));
            mesh.faceOffsets.push_back(static_cast<std::uint32_t>(mesh.faceVertices.size()));
            mesh.owner.push_back(internal ? std::min(own, next) : std::max(own, next));
            if (internal) mesh.neighbour.push_back(std::max(own, next));
            result.outerFaces.push_back(isOuter(own) && isOuter(next));
        }
    }
    mesh.patches = {{"rest", "patch", mesh.internalFaces(), mesh.faces() - mesh.internalFaces()}};
    return result;
}

} // namespace i2b
