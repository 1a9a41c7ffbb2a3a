// The cells around a node that may move, judged as checkMesh judges them: what the optimiser asks again and again.
#pragma once
#include "i2b/quality/mesh_geometry.h"
#include "i2b/quality/quality_report.h"
#include <cmath>
#include <limits>
#include <numbers>

namespace i2b {

inline constexpr double nearLimit = 0.98; // of a limit: so near to it a move may bring cells that is not for their sake

// How bad faces and cells are: sums over those that are near or over the limits, each measure taken as a share of its
// limit (1: at the limit).
struct Badness {
    double sum = 0;   // of the squares of what is over 0.9
    double worst = 0;
    double beyond = 0;     // the worst of what a report counts: pyramids that are only low are no fault yet
    bool invalid = false;  // a cell without a positive volume, or a face pyramid that points the wrong way
};

// What the tetrahedra of faces lack (face_tets.h).
struct TetLack {
    double sum = 0;         // of the squares
    bool undivided = false; // a face does not divide
};

class CellStar {
  public:
    // Keeps references. moments: of all cells, as they are now; those of the star's own cells are worked out anew.
    CellStar(const PolyMesh& mesh, const Rows& cellFaces, const CellMoments* moments, const QualityLimits& limits, std::int32_t thinFrom,
             bool thinWeights = false)
        : mesh_(mesh), cellFaces_(cellFaces), moments_(moments), limits_(limits), thinFrom_(thinFrom), thinWeights_(thinWeights),
          orthoLimit_(1 - std::cos(limits.nonOrthogonality * std::numbers::pi / 180)) {}

    // All cells that use one of the points (sorted): ascending. from: one that does for each group of points that hang together.
    const std::vector<std::int32_t>& cellsAt(const std::vector<std::int32_t>& points, const std::vector<std::int32_t>& from);
    // The star of the points: cells is what cellsAt() gives for them.
    void take(const std::vector<std::int32_t>& points, const std::vector<std::int32_t>& cells);
    void gather(const std::vector<std::int32_t>& points, const std::vector<std::int32_t>& from) { take(points, cellsAt(points, from)); }
    const std::vector<std::int32_t>& cells() const { return cells_; } // ascending
    // From here on determinants of thin cells (cellFullness) count too: at least so much.
    void countFlat(double least) { leastFull_ = least; }
    // With these points of the mesh as they are now; no others may have moved since.
    Badness judge();
    // The same where it is no worse than before and of a sum under `most`; else some of it, which tells that it is not.
    Badness judge(const Badness& before, double most);
    // Does a move for another thing's sake keep to the limits, or make nothing worse where they are broken already?
    bool mayStand(const Badness& before);
    // The same of tetrahedra, which are in no other figure. Looks no further where the sum comes to `most`.
    TetLack judgeTets(double most = std::numeric_limits<double>::infinity());
    // After it: does every face divide there, or lack all of them together no more than before where some did not?
    bool mayDivide(const TetLack& before);
    // After judge(), and after the first judgeTets(), at a place close by: of what had a part in their sum alone, as slopes take it.
    double sumNearby();
    double tetSumNearby();
    // m, of the edges that end at the point, one of those gathered.
    double shortestEdgeAt(std::int32_t point) const;
    // Mean of the other ends of these edges, each as often as faces have it.
    Vec3 middleOf(std::int32_t point) const;

  private:
    struct Face {
        std::int32_t face, owner, neighbour; // cells: place in cells_, or -1
        bool moves;                          // uses one of the points
    };
    bool uses(std::int32_t face) const;
    template <class F>
    void forEdgesAt(std::int32_t point, const F& f) const;
    void judgeCell(std::size_t i, Badness& out);
    void judgeFace(std::size_t i, Badness& out);
    void look(std::size_t i, Badness& out) { i < cells_.size() ? judgeCell(i, out) : judgeFace(i - cells_.size(), out); }
    template <class TooBad>
    Badness judge(const TooBad& tooBad);
    double tetShareOf(std::size_t i, double hopeless = -std::numeric_limits<double>::infinity()); // that and `hopeless` as tetShare()
    // Worked out once a turn, where they are asked for.
    const FaceShape& shapeOf(std::size_t i);
    std::span<const FaceShape> shapesOf(std::size_t cell);
    const CellMoments& momentsOf(std::int32_t place, std::int32_t cell);

    const PolyMesh& mesh_;
    const Rows& cellFaces_;
    const CellMoments* moments_;
    QualityLimits limits_;
    std::int32_t thinFrom_;
    bool thinWeights_; // do weights and volume ratios among thin cells count?
    double leastFull_ = 0; // of thin cells; 0: does not count
    double orthoLimit_; // of 1 less the cosine
    std::vector<std::int32_t> points_, cells_;
    std::vector<Face> faces_;                          // ascending
    std::vector<std::uint64_t> sides_;                 // of all cells: face, then place in cellOf_; ascending
    std::vector<std::uint32_t> cellOf_;                // of each side, place in cells_
    std::vector<std::uint32_t> faceOf_, firstFace_;    // the faces of each cell, places in faces_
    std::vector<FaceShape> shapes_, row_;
    std::vector<CellMoments> own_;
    std::uint32_t turn_ = 0;                           // counts the looks
    std::vector<std::uint32_t> shapeTurn_, ownTurn_;   // of what shapes_ and own_ hold; 0: nothing
    std::size_t critical_ = ~std::size_t(0);           // what made the last place too bad: a cell, or a face after all cells
    std::vector<std::uint32_t> order_, rest_;          // all, numbered so: what had a part in judge()'s sum comes first,
    std::size_t summed_ = 0;                           // so many; rest_: for judge() alone
    std::size_t tetsSummed_ = 0;                       // the same of tetOrder_
    std::vector<std::uint32_t> tetOrder_;              // places in faces_: what lacked most in the first look comes first; or empty
};

} // namespace i2b
