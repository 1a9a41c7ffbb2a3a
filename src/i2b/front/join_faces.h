// Connects polygons to a mesh all at once, in parallel, where OpenMesh's add_face() takes them one by one.
#pragma once
#include "i2b/core/raw_vector.h"
#include "i2b/front/front_mesh.h"
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

namespace i2b {

// Vertices of polygons one after another; start: per polygon, where they begin, and one more at the end.
struct Polygons {
    RawVector<std::int32_t> vertices;
    RawVector<std::size_t> start{0};
    std::size_t size() const { return start.size() - 1; }
};

// A mesh of so many vertices, at place(v), whose faces are the polygons: edges, halfedges and their order around vertices are those that
// add_face() would give. Throws (internal: `what`, with the place) where the polygons are not manifold.
FrontMesh joinFaces(std::size_t vertices, const std::function<FrontMesh::Point(std::size_t)>& place, const Polygons& polygons, const char* what);

} // namespace i2b
