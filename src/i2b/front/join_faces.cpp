#include "i2b/front/join_faces.h"
#include "i2b/core/error.h"
#include "i2b/core/rows.h"
#include "i2b/core/sums.h"
#include <algorithm>
#include <atomic>
#include <fmt/format.h>
#include <span>

namespace i2b {
namespace {

using Index = std::size_t;
using Vertex = FrontMesh::VertexHandle;
using Halfedge = FrontMesh::HalfedgeHandle;
using Face = FrontMesh::FaceHandle;

constexpr std::int32_t none = -1;

// One after the other: for polygons that the fast way does not see through, and to find what is wrong with them.
void addOneByOne(FrontMesh& mesh, const Polygons& polygons, const char* what) {
    std::vector<Vertex> polygon;
    for (Index f = 0; f < polygons.size(); ++f) {
        polygon.clear();
        for (Index s = polygons.start[f]; s < polygons.start[f + 1]; ++s) polygon.emplace_back(polygons.vertices[s]);
        if (polygon.size() > 2 && mesh.add_face(polygon).is_valid()) continue;
        auto p = FrontMesh::Point(0, 0, 0);
        if (!polygon.empty()) p = mesh.point(polygon[0]);
        throw Error(ErrorKind::internal, what, fmt::format("({:g} {:g} {:g})", p[0], p[1], p[2]), "please report the case");
    }
}

// The sides of all polygons, each the halfedge from its vertex to the next.
class Sides {
  public:
    Sides(Index vertices, const Polygons& polygons) : polygons_(polygons), face_(polygons.vertices.size()) {
        parallelFor(polygons.size(), [&](Index f) { std::fill(face_.begin() + at(f), face_.begin() + at(f + 1), static_cast<std::int32_t>(f)); }, 2048);
        turnIntoRows(vertices, 0, size(), [&](Index s, const auto& put) { put(Index(vertex(s))); }, start_, from_);
    }
    Index size() const { return face_.size(); }
    std::int32_t vertex(Index s) const { return polygons_.vertices[s]; }
    Index face(Index s) const { return Index(face_[s]); }
    Index next(Index s) const { return s + 1 == polygons_.start[face(s) + 1] ? polygons_.start[face(s)] : s + 1; }
    Index previous(Index s) const { return s == polygons_.start[face(s)] ? polygons_.start[face(s) + 1] - 1 : s - 1; }
    std::int32_t end(Index s) const { return vertex(next(s)); }
    // Those that leave a vertex, ascending.
    std::span<const std::int32_t> from(Index v) const { return {from_.data() + start_[v], from_.data() + start_[v + 1]}; }
    // The one from b to a, -1 without any, -2 with several.
    std::int32_t between(std::int32_t b, std::int32_t a) const {
        std::int32_t found = none;
        for (const std::int32_t s : from(Index(b)))
            if (end(Index(s)) == a) found = found == none ? s : -2;
        return found;
    }

  private:
    std::ptrdiff_t at(Index f) const { return static_cast<std::ptrdiff_t>(polygons_.start[f]); }
    const Polygons& polygons_;
    RawVector<std::int32_t> face_;
    RawVector<std::uint32_t> start_;
    RawVector<std::int32_t> from_;
};

class Joiner {
  public:
    Joiner(Index vertices, const Polygons& polygons) : vertices_(vertices), polygons_(polygons), sides_(vertices, polygons), opposite_(sides_.size()), halfedge_(sides_.size()) {}

    // False: not manifold, or open more than once at a vertex.
    bool pair() {
        return allOf(polygons_.size(), [&](Index f) { return polygons_.start[f + 1] - polygons_.start[f] >= 3; }) && //
               allOf(sides_.size(), [&](Index s) {
                   opposite_[s] = sides_.between(sides_.end(s), sides_.vertex(s));
                   return opposite_[s] != -2 && sides_.between(sides_.vertex(s), sides_.end(s)) >= 0;
               }) &&
               allOf(vertices_, [&](Index v) { return isOneFan(v); });
    }
    // Edges are numbered as their first sides come, and lead along these.
    void number() {
        const auto isFirst = [&](Index s) { return opposite_[s] == none || Index(opposite_[s]) > s; };
        const RawVector<std::int32_t> before = sumsBefore<std::int32_t>(sides_.size(), isFirst);
        edges_ = Index(before.back());
        parallelFor(sides_.size(), [&](Index s) { halfedge_[s] = isFirst(s) ? 2 * before[s] : 2 * before[Index(opposite_[s])] + 1; }, 4096);
    }
    void fill(FrontMesh& mesh) const {
        mesh.resize(vertices_, edges_, polygons_.size());
        const auto outside = [&](Index s) { return Halfedge(halfedge_[s] + 1); }; // of an open side: back along it
        parallelFor(sides_.size(), [&](Index s) {
            const Halfedge he(halfedge_[s]);
            mesh.set_vertex_handle(he, Vertex(sides_.end(s)));
            mesh.set_face_handle(he, Face(static_cast<int>(sides_.face(s))));
            mesh.set_next_halfedge_handle(he, Halfedge(halfedge_[sides_.next(s)]));
            if (opposite_[s] != none) return;
            mesh.set_vertex_handle(outside(s), Vertex(sides_.vertex(s)));
            mesh.set_face_handle(outside(s), Face());
            mesh.set_next_halfedge_handle(outside(s), outside(openInto(Index(sides_.vertex(s)))));
        }, 2048);
        parallelFor(polygons_.size(), [&](Index f) { mesh.set_halfedge_handle(Face(static_cast<int>(f)), Halfedge(halfedge_[polygons_.start[f + 1] - 1])); }, 4096);
        parallelFor(vertices_, [&](Index v) {
            const auto own = sides_.from(v);
            if (own.empty()) return; // isolated
            const Index open = openInto(v);
            mesh.set_halfedge_handle(Vertex(static_cast<int>(v)), open < sides_.size() ? outside(open) : Halfedge(halfedge_[Index(own.back())]));
        }, 4096);
    }

  private:
    template <class Holds>
    static bool allOf(Index n, const Holds& holds) {
        std::atomic<bool> all{true};
        parallelFor(n, [&](Index i) {
            if (!holds(i)) all.store(false, std::memory_order_relaxed);
        }, 2048);
        return all;
    }
    // The open side that ends at v; sides_.size() without any.
    Index openInto(Index v) const {
        for (const std::int32_t s : sides_.from(v))
            if (const Index into = sides_.previous(Index(s)); opposite_[into] == none) return into;
        return sides_.size();
    }
    // Turning from side to side around v passes all of them, and one gap at most.
    bool isOneFan(Index v) const {
        const auto own = sides_.from(v);
        if (own.empty()) return true;
        std::int32_t s = own[0];
        Index open = 0, turns = 0;
        for (const std::int32_t o : own) {
            if (opposite_[Index(o)] != none) continue;
            ++open, s = o; // the first of the fan, seen so that the next is across its face
        }
        if (open > 1) return false;
        const std::int32_t first = s;
        do {
            if (++turns > own.size()) return false;
            s = opposite_[sides_.previous(Index(s))];
        } while (s != none && s != first);
        return turns == own.size();
    }

    Index vertices_;
    const Polygons& polygons_;
    Sides sides_;
    RawVector<std::int32_t> opposite_, halfedge_; // per side: the side back along its edge, or none; its number
    Index edges_ = 0;
};

} // namespace

FrontMesh joinFaces(std::size_t vertices, const std::function<FrontMesh::Point(std::size_t)>& place, const Polygons& polygons, const char* what) {
    FrontMesh mesh;
    Joiner joiner(vertices, polygons);
    const bool isManifold = joiner.pair();
    if (isManifold) {
        joiner.number();
        joiner.fill(mesh);
    } else {
        mesh.resize(vertices, 0, 0);
    }
    parallelFor(vertices, [&](std::size_t v) { mesh.set_point(Vertex(static_cast<int>(v)), place(v)); }, 4096);
    if (!isManifold) addOneByOne(mesh, polygons, what);
    return mesh;
}

} // namespace i2b
