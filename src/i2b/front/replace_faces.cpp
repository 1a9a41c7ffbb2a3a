#include "i2b/front/replace_faces.h"
#include "i2b/core/error.h"
#include <fmt/format.h>

namespace i2b {
namespace {

// The faces of a front, collected one by one.
struct Collected {
    FrontMesh mesh;
    std::vector<std::int32_t> ownerCell, part;
    std::vector<std::uint8_t> level, pieces;
    std::vector<FrontMesh::VertexHandle> polygon;
    std::size_t group = 0; // the first face of the present lattice face

    void beginFace(const Front& front, std::size_t face) {
        if (front.pieces[face] > 0) group = ownerCell.size();
    }
    void add(const Front& front, std::size_t face) {
        if (!mesh.add_face(polygon).is_valid()) {
            const Vec3 p = front.front[static_cast<std::size_t>(polygon[0].idx())];
            throw Error(ErrorKind::internal, "the cut front is not manifold", fmt::format("({:g} {:g} {:g})", p.x, p.y, p.z), "please report the case");
        }
        ownerCell.push_back(front.ownerCell[face]);
        part.push_back(front.part[face]);
        level.push_back(front.level[face]);
        pieces.push_back(0);
        ++pieces[group];
    }
};

} // namespace

void replaceFaces(Front& front, const std::vector<FaceCut>& cuts) {
    if (cuts.empty()) return;
    const std::size_t faces = front.ownerCell.size();
    Collected out;
    out.mesh.reserve(front.mesh.n_vertices(), front.mesh.n_edges() + 2 * cuts.size(), faces + cuts.size());
    for (auto v : front.mesh.vertices()) out.mesh.add_vertex(front.mesh.point(v));
    auto cut = cuts.begin();
    for (std::size_t f = 0; f < faces; ++f) {
        out.beginFace(front, f);
        if (cut != cuts.end() && static_cast<std::size_t>(cut->face) == f) {
            for (const std::vector<std::int32_t>& vertices : cut->polygons) {
                out.polygon.clear();
                for (std::int32_t v : vertices) out.polygon.emplace_back(v);
                out.add(front, f);
            }
            ++cut;
            continue;
        }
        out.polygon.clear();
        for (auto v : front.mesh.fv_range(FrontMesh::FaceHandle(static_cast<int>(f)))) out.polygon.push_back(v);
        out.add(front, f);
    }
    front.mesh = std::move(out.mesh);
    front.ownerCell = std::move(out.ownerCell);
    front.part = std::move(out.part);
    front.level = std::move(out.level);
    front.pieces = std::move(out.pieces);
}

} // namespace i2b
