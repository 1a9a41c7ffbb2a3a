// The cells around points of a mesh in which points are made one: what a change there would bring, judged on a small mesh of its
// own, before it is done.
#pragma once
#include "i2b/assemble/mesh_topology.h"
#include "i2b/assemble/poly_mesh.h"
#include "i2b/quality/changer.h"
#include <cstdint>
#include <unordered_map>
#include <vector>

namespace i2b {

struct RimMove {
    std::int32_t keep = -1, gone = -1; // points; gone: becomes keep; -1: none does
    Vec3 to;                           // m, of keep
};

class RimStar {
  public:
    RimStar(PolyMesh& mesh, const Rows& cellFaces); // keeps references; points move in mesh, faces stay up to rewrite()

    bool isGone(std::int32_t point) const { return joined_.contains(point); }
    // The points of a face after all that was joined and the move: fewer than three where nothing of it is left.
    void loopOf(std::int32_t face, const RimMove& move, std::vector<std::int32_t>& loop) const;
    // The cells that use the points (other: -1, none), ascending; from: one that uses the first.
    std::vector<std::int32_t> cellsAt(std::int32_t point, std::int32_t other, std::int32_t from) const;
    std::vector<std::int32_t> withNeighbours(const std::vector<std::int32_t>& cells) const; // ascending
    std::vector<std::int32_t> wallFaces(const std::vector<std::int32_t>& cells) const;
    // Does the wall stay a surface where two of its points become one? The edge between them is then gone, triangles on it are an edge,
    // and no other face or edge has both.
    bool mayJoin(const RimMove& move, const std::vector<std::int32_t>& star) const;
    // Is nothing that a check names worse in these cells than it was at first, with all that was done and the move?
    bool isNoWorse(const RimMove& move, const std::vector<std::int32_t>& star, const DictionaryLimits& limits) const;
    void apply(const RimMove& move);
    void takeBack(const RimMove& move); // of a point that was moved once

    // Of the mesh: faces of fewer than three points and points without faces go, all others keep their order. Gives the cells of wall faces
    // that are gone, ascending.
    std::vector<std::int32_t> rewrite();

  private:
    enum class State { first, now };
    std::int32_t nowOf(std::int32_t point) const; // what it has become
    bool isWall(std::int32_t face) const;
    LocalEdits::Surroundings around(State state, const RimMove& move, const std::vector<std::int32_t>& star) const;
    void loopOf(std::int32_t face, State state, const RimMove& move, std::vector<std::int32_t>& loop) const;

    PolyMesh& mesh_;
    const Rows& cellFaces_;
    std::unordered_map<std::int32_t, std::int32_t> joined_; // per point that is gone another, which may have gone since
    std::unordered_map<std::int32_t, Vec3> first_;          // m, of points that have moved
};

} // namespace i2b
