// Which removed cells may be given back to a region: cut cells, cells too close to the geometry and cells that paint
// left in pockets, where their centre has room and lies on the flow's side.
#pragma once
#include "i2b/carve/vertices.h"
#include "i2b/geometry/surface_index.h"
#include "i2b/paint/regions.h"
#include <array>
#include <boost/container/static_vector.hpp>

namespace i2b {

struct RoomOptions {
    double rim = 0.2;                          // of h: least distance from a given cell's centre to the geometry
    double centre = 0.24;                      // of h: the same where others are reached from it
    std::array<double, 3> way{0.25, 0.25, 0.2}; // of h: least distance to the geometry at quarters of a way between centres
    double squeezed = 0.05;                    // of h: the same where a front needs it,
    double least = 0.001;                      // of h: and where it does in a gap: on which side the centre is must be sure
    int tuckedAway = 13;                       // kept ones of the 26 cells around, at most, for a cell with less room than rim
    double gapWidth = 2;                       // of h: from a cell's centre to a wall that faces the nearest one
    double facing = 0.5;                       // cosine of the angle to its normal, at most, under which a wall is met that faces another
    std::uint64_t pocketCells = 64;            // an unpainted region of so many cells is part of a passage, not a room of its own
};

// Walls about the centre of a cell.
struct WallsAround {
    double clearance = 0;  // of h: to the nearest wall
    Vec3 toWall;           // unit vector; zero where no wall is near
    bool isOpposite = false; // beyond the centre another wall faces that one,
    double width = 0;        // of h: so far from it; 0 without one
};

// Cells on the other side of walls that go where one in a gap comes back: a sheet has room for one of the two.
using Displaced = boost::container::static_vector<Place, 3>;

// Cells beside another region, in sight of it, have no room: paint decides which regions are meshed. Some quarter of a
// way lies within h / 8 of any sheet that it passes, so a crack narrower than 0.31 h lets none through.
class Room {
  public:
    // kept: of the region; looked at as it is when asked, never changed here. taken: cells of other zones.
    Room(const CellGrid& grid, const CutCells& cut, const Regions& regions, const Region& region, const std::vector<Mask::Ptr>& kept,
         const std::vector<Mask::Ptr>& taken, const SurfaceIndex& index, const RoomOptions& options = {});

    const RoomOptions& options() const { return options_; }
    const std::vector<Mask::Ptr>& candidates() const { return candidates_; } // by level: removed at first, may come back
    bool isCandidate(const Place& c) const { return isOn(candidates_, c) || isOn(painted_, c); }
    bool isKept(const Place& c) const { return isOn(kept_, c); }

    bool isForeign(const Place& c) const { // an uncut cell of another region, or of none
        return grid_.levels[std::size_t(c.level)].cells->isValueOn(toCoord(c.at)) && !isKept(c) && !isCandidate(c);
    }
    // The wall opposite may be up to gapWidth away from the centre.
    WallsAround wallsAround(const Place& c) const;
    // Is the cell kept, of c's level, that holds the place at this offset (of h) from c's centre?
    bool isKeptAt(const Place& c, const Vec3& offset) const;
    // Is no cell near that belongs to others?
    bool isFree(const Place& c) const;
    // Has the cell room? clearance: m, from its centre to the geometry, as far as an edge.
    bool has(const Place& c, double& clearance) const;
    // May cells be reached from one with this clearance?
    bool leadsOn(const Place& c, double clearance) const { return clearance >= options_.centre * h(c); }
    // May one go straight from centre a to centre b, with room all along?
    bool isWay(const Place& a, const Place& b) const;
    // Does geometry cross the straight line between the centres?
    bool isWallBetween(const Place& a, const Place& b) const { return bool(index_.firstHit(centre(a), centre(b))); }
    // Of a kept cell beyond a wall from one that is to come back: does it go? It is added if so: if it has come back itself, and lies in no gap.
    bool displace(const Place& kept, Displaced& displaced) const;
    // May the cell join a kept neighbour, where the front is the better for it? No wall stands between it and any that stays, and one does
    // to all that belong to others; with less room than others have it must not lie in the open. clearance: m, as of has().
    bool mayJoin(const Place& c, double& clearance, Displaced& displaced) const;

  private:
    Vec3 centre(const Place& c) const { return grid_.lattice.cellBox(grid_.levels[std::size_t(c.level)].level, c.at).centre(); }
    double h(const Place& c) const { return grid_.lattice.h(grid_.levels[std::size_t(c.level)].level); }
    bool isOn(const std::vector<Mask::Ptr>& masks, const Place& c) const { return masks[std::size_t(c.level)]->isValueOn(toCoord(c.at)); }
    bool touchesTaken(const Place& c) const;
    bool isInTheOpen(const Place& c) const;
    double distance(const Place& c) const; // m, from its centre to the geometry, as far as an edge

    const CellGrid& grid_;
    const std::vector<Mask::Ptr>&kept_, &taken_;
    const SurfaceIndex& index_;
    RoomOptions options_;
    std::vector<Mask::Ptr> painted_, candidates_;
};

// Candidates that share a face with a kept cell of their level, in order.
std::vector<Place> besideKept(const Room& room);

inline Place faceNeighbour(Place c, int direction) { // direction: 2 * axis (+ 1 for the high side)
    c.at[static_cast<std::size_t>(direction >> 1)] += direction & 1 ? 1 : -1;
    return c;
}

} // namespace i2b
