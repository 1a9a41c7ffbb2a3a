// The front: the faces between kept and removed cells, as an OpenMesh polygon mesh. Each of its vertices stands for
// two points: one on the front (a corner of kept cells) and one on the wall; each face is the footprint of a prism
// between the two.
//
//      kept cells   | f0 ---- f1 |      front positions, Front::front
//                   |  |      |  |      one prism a face, later subdivided into layers
//      geometry  ~~~~ b0 ---- b1 ~~~~   wall positions, the mesh's points
#pragma once
#include "i2b/core/vec.h"
#include "i2b/front/lattice_mesh.h"
#include "i2b/geometry/surface_index.h"
#include "i2b/front/front_mesh.h"
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace i2b {

struct Front {
    FrontMesh mesh;                                // vertices in fan order, face normals out of the kept cells
    // Per vertex:
    std::vector<Vec3> front;                       // m, position on the front
    std::vector<std::int32_t> corePoint;           // number of that point in the LatticeMesh; two fans may share it
    std::vector<double> h;                         // m, smallest edge of the cells around
    std::vector<Vec3> size;                        // m, the same along each axis
    std::vector<Vec3> inside;                      // m, amid the kept cells around it: on the flow's side of all geometry near
    std::vector<std::array<std::int8_t, 3>> direction; // sum of the distinct axis directions of its faces
    std::vector<std::uint8_t> outside;             // bit 2 * axis (+ 1): lies on the low (high) side of the domain box
    // Per face:
    std::vector<std::int32_t> ownerCell;           // core cell number, ascending
    std::vector<std::int32_t> part;                // of the geometry behind it
    std::vector<std::uint8_t> level;               // lattice level: its size
    std::vector<std::uint8_t> pieces;              // of a lattice face that was split: 2 at the first, 0 at the second; else 1
    // Vertices that the fit has put into edges: the last ones of all. Their core points have the numbers after the
    // LatticeMesh's.
    struct Inserted {
        std::array<std::int32_t, 2> ends{};        // vertices
        double t = 0;                              // share of the way from the first to the second

        // Its front position, given those of the ends and its wall position: on the edge, and a little off it towards the wall, so
        // that the cell behind stays convex where its face is cut from here.
        Vec3 frontAt(const Vec3& first, const Vec3& second, const Vec3& wall) const {
            const Vec3 onEdge = first + (second - first) * t;
            return onEdge + (wall - onEdge) * lift;
        }
        static constexpr double lift = 0.08; // share of the way to the wall
    };
    std::vector<Inserted> inserted;
    // Core points of the front in the middle of an edge of a coarser cell, with the ends of that edge: ascending.
    struct Hanging {
        std::int32_t point = -1;
        std::array<std::int32_t, 2> ends{-1, -1};
        friend auto operator<=>(const Hanging&, const Hanging&) = default;
    };
    std::vector<Hanging> hanging;
    std::vector<std::int32_t> whole;               // owner cells, ascending, whose faces the fit must not cut
    std::int32_t corePoints = 0;                   // of the LatticeMesh
    // Core points behind the front that the fit has moved, by number.
    std::vector<std::int32_t> movedPoints;
    std::vector<Vec3> movedTo;                     // m
    std::vector<float> movedSize;                  // m, smallest edge of the cells around
    std::vector<std::uint8_t> movedOutside;        // as outside

    Vec3 wall(std::size_t vertex) const {          // m, position on the wall
        const auto& p = mesh.point(FrontMesh::VertexHandle(static_cast<int>(vertex)));
        return {p[0], p[1], p[2]};
    }
    bool staysWhole(std::size_t face) const;
    // Are these vertices all on one edge of a coarse cell? The face on its other side has them all: a face on them alone would
    // be a part of that one. With an inserted vertex both its ends count.
    bool areOnOneEdge(std::span<const std::int32_t> vertices) const;
    // Of a prism at a vertex, between the vertices before and after it on its face: the cosine between the edge off the wall and the
    // normal of the corner, times the corner's sine; the worse one of wall and front.
    double cornerAt(std::size_t vertex, std::size_t before, std::size_t next) const;
    std::size_t firstInserted() const { return front.size() - inserted.size(); } // vertex
    // "" or the first fault: open edges away from the domain's sides, isolated vertices, sizes of arrays.
    std::string validate() const;
    std::uint64_t checksum() const;
};

// Wall positions start at front + thickness * h * direction, where every prism is valid by construction.
Front buildFront(const LatticeMesh& mesh, double thickness);

// The part nearest to each face's wall centre.
void assignParts(Front& front, const SurfaceIndex& index);

} // namespace i2b
