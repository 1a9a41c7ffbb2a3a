// Cells and faces of a mesh, gathered into batches for the kernels of glance_hexes.h and glance_quads.h. One per thread.
#pragma once
#include "i2b/quality/glance_hexes.h"
#include "i2b/quality/glance_quads.h"
#include "i2b/quality/mesh_geometry.h"
#include <array>

namespace i2b {

// Every lane counts as clear that no bound is asked of, but for what the kernels cannot judge: concave cells and faces,
// cells without volume, tetrahedra of no or negative volume.
inline constexpr double notAsked = 1e300;
inline constexpr HexBounds openHexBounds{-notAsked, notAsked, notAsked, -notAsked, -notAsked};
inline constexpr QuadBounds openQuadBounds{.shortEdge2 = 0, .faceArea = 0, .flatness = -1, .spread = 0, .cosine = -2, .weight = 0, .ratio = 0,
                                           .skewness = notAsked, .pyramid3 = 0, .tetShape = 0, .twist = -2, .triangleTwist = -2};

// Cells with six quadrilaterals for faces.
class HexGlance {
  public:
    HexGlance(const PolyMesh& mesh, const Rows& cellFaces, const HexBounds& bounds) : mesh_(mesh), cellFaces_(cellFaces), bounds_(bounds) {}

    bool isHex(std::span<const std::int32_t> faces) const {
        if (faces.size() != 6) return false;
        for (const std::int32_t f : faces)
            if (mesh_.faceOffsets[std::size_t(f) + 1] - mesh_.faceOffsets[std::size_t(f)] != 4) return false;
        return true;
    }
    // A cell that isHex(). clear(cell, batch, lane), odd(cell): called for each cell once, here or in finish().
    template <class Clear, class Odd>
    void add(std::int32_t cell, const Clear& clear, const Odd& odd) {
        take(cell);
        if (taken_ == laneCount) finish(clear, odd);
    }
    template <class Clear, class Odd>
    void finish(const Clear& clear, const Odd& odd) {
        if (taken_ == 0) return;
        const std::size_t taken = taken_;
        while (taken_ < laneCount) take(cell_[0]); // idle lanes repeat the first
        taken_ = 0;
        const unsigned marked = glanceAtHexes(batch_, bounds_, extremes);
        for (std::size_t lane = 0; lane < taken; ++lane)
            if ((marked >> lane & 1U) != 0) odd(cell_[lane]);
            else clear(cell_[lane], batch_, lane);
    }
    CellMoments moments(std::size_t lane) const { return {batch_.centre[lane], batch_.volume[lane]}; } // of a clear one

    HexExtremes extremes; // of all clear ones

  private:
    void take(std::int32_t cell) {
        const std::span<const std::int32_t> faces = cellFaces_[cell];
        for (std::size_t i = 0; i < 6; ++i) {
            const auto f = std::size_t(faces[i]);
            const std::int32_t* const v = mesh_.faceVertices.data() + mesh_.faceOffsets[f];
            for (std::size_t k = 0; k < 4; ++k) batch_.point[i][k].set(taken_, mesh_.points[std::size_t(v[k])]);
            batch_.side[i][taken_] = mesh_.owner[f] == cell ? 1 : -1;
            batch_.inner[i][taken_] = f < mesh_.neighbour.size() ? 1 : 0;
        }
        cell_[taken_++] = cell;
    }

    const PolyMesh& mesh_;
    const Rows& cellFaces_;
    HexBounds bounds_;
    HexBatch batch_;
    std::array<std::int32_t, laneCount> cell_{};
    std::size_t taken_ = 0;
};

// Inner faces of four different vertices.
class QuadGlance {
  public:
    // moments: of all cells, as they are when faces are added
    QuadGlance(const PolyMesh& mesh, const CellMoments* moments, const QuadBounds& bounds) : mesh_(mesh), moments_(moments), bounds_(bounds) {}

    // False: not such a face. clear(face, batch, lane), odd(face): called for each face once, here or in finish().
    template <class Clear, class Odd>
    bool add(std::size_t face, const Clear& clear, const Odd& odd) {
        if (face >= mesh_.neighbour.size() || !take(face)) return false;
        if (taken_ == laneCount) finish(clear, odd);
        return true;
    }
    template <class Clear, class Odd>
    void finish(const Clear& clear, const Odd& odd) {
        if (taken_ == 0) return;
        const std::size_t taken = taken_;
        while (taken_ < laneCount) take(face_[0]); // idle lanes repeat the first
        taken_ = 0;
        const unsigned marked = glanceAtQuads(batch_, bounds_, extremes);
        for (std::size_t lane = 0; lane < taken; ++lane)
            if ((marked >> lane & 1U) != 0) odd(face_[lane]);
            else clear(face_[lane], batch_, lane);
    }

    QuadExtremes extremes; // of all clear ones

  private:
    bool take(std::size_t f) {
        const std::size_t first = mesh_.faceOffsets[f];
        if (mesh_.faceOffsets[f + 1] - first != 4) return false;
        const std::int32_t* const v = mesh_.faceVertices.data() + first;
        if (v[0] == v[1] || v[0] == v[2] || v[0] == v[3] || v[1] == v[2] || v[1] == v[3] || v[2] == v[3]) return false;
        for (std::size_t i = 0; i < 4; ++i) batch_.point[i].set(taken_, mesh_.points[std::size_t(v[i])]);
        const CellMoments &own = moments_[std::size_t(mesh_.owner[f])], &nei = moments_[std::size_t(mesh_.neighbour[f])];
        batch_.own.set(taken_, own.centre), batch_.nei.set(taken_, nei.centre);
        batch_.ownVolume[taken_] = own.volume, batch_.neiVolume[taken_] = nei.volume;
        face_[taken_++] = f;
        return true;
    }

    const PolyMesh& mesh_;
    const CellMoments* moments_;
    QuadBounds bounds_;
    QuadBatch batch_;
    std::array<std::size_t, laneCount> face_{};
    std::size_t taken_ = 0;
};

} // namespace i2b
