// What repair looks for in a mesh: cells that are wrong, and what is over the limits of quality. Measured once for the
// whole mesh and afterwards only where points have moved, with the same outcome.
#pragma once
#include "i2b/quality/flags.h"
#include "i2b/quality/mesh_geometry.h"
#include "i2b/quality/quality_report.h"
#include "i2b/quality/tet_quality.h"
#include <limits>

namespace i2b {

// Fewer severe faults are better, then fewer of any kind.
struct FaultCount {
    std::int64_t severe = 0; // faces over the limits of non-orthogonality or skewness, which spoil a solution first
    std::int64_t all = 0;
    friend auto operator<=>(const FaultCount&, const FaultCount&) = default;
};

class MeshFaults {
  public:
    // Keeps references. limits: those of orthogonality, skewness, weight, volume ratio and determinant count. Cells from
    // thinFrom on may be as thin as they are: their determinants do not count, nor weights and volume ratios among them, nor faces
    // that do not divide, unless these are few: fewer where many cells are so thin that they are beyond limits of determinants anyway.
    // mayMove: per point 1 where it may; cells and faces all of whose points stay are taken to be good, and not looked at. Empty: all are.
    MeshFaults(const PolyMesh& mesh, const Rows& cellFaces, const QualityLimits& limits,
               std::int32_t thinFrom = std::numeric_limits<std::int32_t>::max(), const std::vector<std::uint8_t>& mayMove = {});

    // After points have moved. seeds: cells among which every moved point has one that uses it.
    void update(const std::vector<std::int32_t>& movedPoints, const std::vector<std::int32_t>& seeds);
    void update(const std::vector<std::int32_t>& cells); // all that use a moved point, each once
    // Of the same the moments alone, for moves that are judged by these; update() is to follow.
    void follow(const std::vector<std::int32_t>& cells);

    const CellMoments* moments() const { return moments_.data(); } // of all cells with a point that may move, and those beside them
    const QualityLimits& limits() const { return limits_; }
    std::int32_t thinFrom() const { return thinFrom_; }
    bool countsThinWeights() const { return (thinFlags_ & lowWeight) != 0; }
    bool countsThinUndivided() const { return (thinFlags_ & undivided) != 0; }

    // Cells without a positive volume, or with a face pyramid that points the wrong way or is next to nothing.
    std::vector<std::int32_t> badCells() const;
    // Cells at both sides of the faces over the limits and cells over theirs: of each kind of fault those that come
    // first, as many as a report names. severeOnly: those of non-orthogonal and skew faces.
    std::vector<std::int32_t> poorCells(FaultCount& faults, bool severeOnly = false) const;
    // Faces that do not divide into tetrahedra (face_tets.h); these count nowhere else.
    std::vector<std::int32_t> undividedFaces() const;
    // All faces with any fault that counts, those of cells with one among them.
    std::vector<std::int32_t> poorFaces() const;

  private:
    enum CellFlag : std::uint8_t { bad = 1, lowDeterminant = 2 };
    enum FaceFlag : std::uint8_t { nonOrthogonal = 1, skew = 2, lowWeight = 4, lowRatio = 8, undivided = 16 };
    void measureCells(const std::vector<std::uint8_t>& near);
    void measureFaces(const std::vector<std::uint8_t>& near);
    void measureCellAt(std::int32_t cell, CellFaceShapes& shapes);
    void measureFaceAt(std::int32_t face);
    std::vector<std::int32_t> cellsAround(const std::vector<std::int32_t>& seeds);
    bool hasMoved(std::int32_t face) const;
    void lookAtThin();
    bool thinLackDeterminants() const;
    // Those that count.
    int flagsOf(std::size_t face) const { return faceFlags_[face] & (mesh_.owner[face] < thinFrom_ ? 0xff : thinFlags_); }

    const PolyMesh& mesh_;
    const Rows& cellFaces_;
    QualityLimits limits_;
    std::int32_t thinFrom_;
    double severeCosine_;
    TetTolerance tets_;
    RawVector<CellMoments> moments_;
    Flags cellFlags_, faceFlags_;
    int thinFlags_ = 0xff; // of faces among thin cells: what counts
    std::vector<std::uint8_t> moved_, changed_; // per point, per cell; clear between updates
};

} // namespace i2b
