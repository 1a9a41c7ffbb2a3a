// How a face of the front is cut from crossing to crossing (insert.h), so that each piece stands on one side of the lines.
#pragma once
#include "i2b/fit/crossings.h"
#include "i2b/fit/front_room.h"
#include "i2b/fit/lie.h"

namespace i2b {

struct CutPlace { // a vertex of a face that may be cut
    std::int32_t vertex = -1;    // of the front; or
    std::int32_t crossing = -1;
    bool star = false;           // stands on a line or border
    bool isEnd = false;          // of a cut
};
using CutRing = std::vector<CutPlace>;

struct FaceCuts { // of one face
    std::vector<CutRing> pieces;
    bool valid = true;
};

// Keeps references to all that it looks at.
class FaceCutter {
  public:
    // x: positions of the band's nodes; crossingOf: per edge of the front, its place in crossings, or -1.
    FaceCutter(const Front& front, const Band& band, const SurfaceIndex& index, const FeatureIndex& features, const Positions& x,
               const WallMarks& marks, const std::vector<EdgeCrossing>& crossings, const std::vector<std::int32_t>& crossingOf)
        : front_(front), band_(band), index_(index), features_(features), x_(x), marks_(marks), crossings_(crossings), crossingOf_(crossingOf) {}

    // also: a crossing that counts though it is not alive.
    FaceCuts cutsOf(std::size_t face, std::int32_t also = -1) const;
    // The worst scaled Jacobian of the prisms' corners on pieces of a face, if a crossing were where moved, of the same edge, is; -1: none can be.
    double worstCorner(const std::vector<CutRing>& pieces, const EdgeCrossing& moved) const;
    // Of the edges from a crossing in these pieces, how many run along a line.
    std::size_t linesFrom(std::int32_t crossing, const std::vector<CutRing>& pieces) const;
    // Does no line ask for it?
    bool isOptional(const CutPlace& p) const;
    // Its place on the wall.
    const Vec3& wallAt(const CutPlace& p, const EdgeCrossing* moved = nullptr) const {
        return p.vertex >= 0 ? x_[std::size_t(p.vertex)] : crossingAt(p, moved).wall;
    }
    // For corners of a piece that have too little height under the front.
    void wishRoom(const CutRing& piece, std::vector<RoomWish>& wishes) const;

  private:
    CutRing ringOf(std::size_t face, std::int32_t also) const;
    bool runsAlong(const CutPlace& from, const CutPlace& to) const;
    void divide(const CutRing& ring, FaceCuts& cuts) const;
    bool bestCut(const CutRing& ring, std::size_t& from, std::size_t& to) const;
    bool differ(const CutRing& ring, std::size_t from, std::size_t to) const;
    FeatureIndex::Line lineAlong(const CutPlace& from, const CutPlace& to) const;
    bool liesOnLine(const CutRing& ring, std::size_t from, std::size_t to) const;
    Foot footUnder(const CutRing& ring, std::size_t from, std::size_t to) const;
    bool isOnOneEdge(const CutRing& ring) const;
    double worstCorner(const CutRing& ring, const EdgeCrossing* moved = nullptr) const;
    bool isOnBend(const CutPlace& p) const;
    Lie lieOfRing(const CutRing& ring) const;
    bool isNearer(const CutRing& ring, const std::vector<CutRing>& pieces) const;
    bool dents(const CutPlace& p) const;
    const EdgeCrossing& crossingAt(const CutPlace& p, const EdgeCrossing* moved = nullptr) const {
        const EdgeCrossing& c = crossings_[std::size_t(p.crossing)];
        return moved && moved->edge == c.edge ? *moved : c;
    }
    double hAt(const CutPlace& p) const { return band_.h[std::size_t(p.vertex >= 0 ? p.vertex : crossings_[std::size_t(p.crossing)].p)]; }
    const Vec3& frontAt(const CutPlace& p, const EdgeCrossing* moved = nullptr) const {
        return p.vertex >= 0 ? x_[std::size_t(band_.frontNode[std::size_t(p.vertex)])] : crossingAt(p, moved).front;
    }

    const Front& front_;
    const Band& band_;
    const SurfaceIndex& index_;
    const FeatureIndex& features_;
    const Positions& x_;
    const WallMarks& marks_;
    const std::vector<EdgeCrossing>& crossings_;
    const std::vector<std::int32_t>& crossingOf_;
};

} // namespace i2b
