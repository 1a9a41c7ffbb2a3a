// The cells around points of a mesh in which points are made one: what a change there would bring, judged on a small mesh of its
// own, before it is done.
#pragma once
#include "i2b/assemble/mesh_topology.h"
#include "i2b/assemble/poly_mesh.h"
#include "i2b/core/numbering.h"
#include "i2b/core/raw_vector.h"
#include "i2b/edit/changer.h"
#include <cstdint>
#include <map>
#include <unordered_map>
#include <unordered_set>
#include <vector>

namespace i2b {

struct PointMove {
    std::int32_t keep = -1, gone = -1; // points; gone: becomes keep; -1: none does
    Vec3 to;                           // m, of keep
};

std::uint64_t edgeKey(std::int32_t a, std::int32_t b); // the lower point first

// Wall faces before a rim that go: their points are on the rim, and their cells, one where their columns would be divided across, are wedges
// without a wall face.
struct Zip {
    std::vector<PointMove> moves;                                               // points, on the wall and above it
    std::vector<std::int32_t> gone;                                           // faces: of the wall, and those taken in by others
    std::vector<std::pair<std::int32_t, std::vector<std::int32_t>>> loops;    // faces that take others in: points of before
    std::vector<std::pair<std::uint64_t, std::vector<std::int32_t>>> through; // edges led through points, from their lower end on
    std::vector<std::pair<std::int32_t, std::int32_t>> cells;                 // what they become: the lowest of those made one
    std::vector<std::int32_t> star;                                           // cells around, ascending
    struct Column { // points over a node of the wall in or beside it that move as one
        std::vector<std::int32_t> points; // away from the wall
        std::vector<double> share;        // of the move, which each takes
    };
    std::vector<Column> columns;
    double h = 0; // m
};

class ZipStar {
  public:
    ZipStar(PolyMesh& mesh, const Rows& cellFaces); // keeps references; points move in mesh, faces stay up to rewrite()

    bool isGone(std::int32_t point) const { return nowOf(point) != point; }
    // The points of a face after all that was joined and the move: fewer than three where nothing of it is left.
    void loopOf(std::int32_t face, const PointMove& move, std::vector<std::int32_t>& loop) const;
    // The cells that use the points (other: -1, none), ascending; from: one that uses the first.
    std::vector<std::int32_t> cellsAt(std::int32_t point, std::int32_t other, std::int32_t from) const;
    std::vector<std::int32_t> withNeighbours(const std::vector<std::int32_t>& cells) const; // ascending
    std::vector<std::int32_t> wallFaces(const std::vector<std::int32_t>& cells) const;
    // Does the wall stay a surface where two of its points become one? The edge between them is then gone, triangles on it are an edge,
    // and no other face or edge has both.
    bool mayJoin(const PointMove& move, const std::vector<std::int32_t>& star) const;
    // Is nothing that a check names worse in these cells than it was at first, with all that was done and the move?
    bool isNoWorse(const PointMove& move, const std::vector<std::int32_t>& star, const DictionaryLimits& limits) const;
    void apply(const PointMove& move);

    // All is as it was at first, but for these and the points given (m).
    void use(const std::vector<Zip>& zips, const std::map<std::int32_t, Vec3>& places);
    // Are faces and edges around a zip in use as they must be: no face twice at one point, none of a cell's sides gone, each edge of a cell
    // between two of its faces?
    bool isSound(const Zip& zip) const;
    Verdict before(const Zip& zip, const DictionaryLimits& limits) const; // as it was at first
    Verdict now(const Zip& zip, const DictionaryLimits& limits) const;
    // As isNoWorse(), but that cells may be concave: wedges of several faces are.
    bool isNoWorse(const Zip& zip, const Verdict& before, const DictionaryLimits& limits) const;
    // The cells and their neighbours as they are now; points: theirs, ascending.
    LocalEdits::Surroundings around(const std::vector<std::int32_t>& cells, std::vector<std::int32_t>& points) const;

    std::vector<std::int32_t> pointsGone() const; // that no face has any more, ascending
    // Of the mesh: faces of fewer than three points and points without faces go, all others keep their order. Gives the cells of wall faces
    // that are gone, ascending. Cells stay: united() says which are to be one.
    std::vector<std::int32_t> rewrite();
    const std::unordered_map<std::int32_t, std::int32_t>& united() const { return cellOf_; } // per cell that is not alone, the lowest with it

  private:
    enum class State { first, now };
    std::int32_t nowOf(std::int32_t point) const; // what it has become
    std::int32_t cellNow(std::int32_t cell) const;
    bool isWithin(std::int32_t face) const; // a cell of now
    std::vector<std::int32_t> withMembers(std::vector<std::int32_t> cells) const; // all of those that are one, ascending
    bool isWall(std::int32_t face) const;
    LocalEdits::Surroundings around(State state, const PointMove& move, const std::vector<std::int32_t>& star, std::vector<std::int32_t>* ids = nullptr) const;
    void loopOf(std::int32_t face, State state, const PointMove& move, std::vector<std::int32_t>& loop) const;
    void resolveLoops();
    void loopOfZipped(std::int32_t face, std::vector<std::int32_t>& loop) const;

    PolyMesh& mesh_;
    const Rows& cellFaces_;
    std::vector<bool> isJoined_, isZipped_;                                // per point, per face: is there anything about it below?
    std::unordered_map<std::int32_t, std::int32_t> joined_;                // per point that is gone another, which may have gone since
    std::unordered_map<std::int32_t, Vec3> first_;                         // m, of points that have moved
    std::unordered_set<std::int32_t> goneFaces_;
    std::unordered_map<std::int32_t, std::vector<std::int32_t>> loops_;    // per face that takes others in
    std::unordered_map<std::uint64_t, std::vector<std::int32_t>> through_; // per edge
    std::unordered_map<std::int32_t, std::int32_t> cellOf_;
    std::unordered_map<std::int32_t, std::vector<std::int32_t>> members_;  // per lowest cell, ascending
    std::vector<std::int32_t> zipped_;                                     // cells around zips, ascending
    Numbering zippedFaces_;                                                // theirs: what becomes of each is worked out once
    std::vector<std::size_t> loopStart_;                                   // per such face, and the end
    RawVector<std::int32_t> loopPoints_;
};

} // namespace i2b
