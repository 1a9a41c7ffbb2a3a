#include "i2b/carve/room.h"
#include "i2b/core/collect.h"
#include "i2b/grid/mask_ops.h"
#include <algorithm>
#include <cmath>
#include <tbb/parallel_sort.h>

namespace i2b {
namespace {

std::vector<Mask::Ptr> candidatesOf(const CellGrid& grid, const CutCells& cut, const Regions& regions, const std::vector<Mask::Ptr>& painted,
                                    const std::vector<Mask::Ptr>& kept, std::uint64_t pocketCells) {
    std::vector<Mask::Ptr> candidates;
    for (std::size_t l = 0; l < grid.levels.size(); ++l) {
        candidates.push_back(unionOf(*cut.levels[l], *differenceOf(*painted[l], *kept[l])));
        openvdb::tree::ValueAccessor<Mask> write(*candidates[l]);
        for (const RegionPiece& piece : regions.pieces[l]) {
            const Region& other = regions.table[static_cast<std::size_t>(piece.region)];
            if (other.painted || other.touchesDomainBox || other.cells > pocketCells) continue;
            setLeafBitsOn(write, toCoord(piece.origin), piece.mask);
        }
    }
    return candidates;
}

} // namespace

Room::Room(const CellGrid& grid, const CutCells& cut, const Regions& regions, const Region& region, const std::vector<Mask::Ptr>& kept,
           const std::vector<Mask::Ptr>& taken, const SurfaceIndex& index, const RoomOptions& options)
    : grid_(grid), kept_(kept), taken_(taken), index_(index), options_(options), painted_(regions.cellsOf(region.id)),
      candidates_(candidatesOf(grid, cut, regions, painted_, kept, options.pocketCells)) {}

// By a face, an edge or a corner, whatever the level of the other cell; grids are graded 2:1 across all of these.
bool Room::touchesTaken(const Place& c) const {
    const LevelTriple& own = grid_.levels[std::size_t(c.level)].level;
    const int finest = grid_.lattice.maxLevel;
    for (std::size_t l = 0; l < taken_.size(); ++l) {
        const LevelTriple& level = grid_.levels[l].level;
        Index3 first{}, last{};
        bool graded = true;
        for (std::size_t axis = 0; axis < 3; ++axis) graded = graded && std::abs(level[axis] - own[axis]) <= 1;
        if (!graded) continue;
        for (std::size_t axis = 0; axis < 3; ++axis) { // closed intervals of the finest lattice meet
            const int shift = finest - level[axis], ownShift = finest - own[axis];
            const std::int64_t low = std::int64_t(c.at[axis]) << ownShift, high = std::int64_t(c.at[axis] + 1) << ownShift;
            first[axis] = static_cast<std::int32_t>((low + (std::int64_t(1) << shift) - 1) >> shift) - 1;
            last[axis] = static_cast<std::int32_t>(high >> shift);
        }
        for (Index3 at = first; at[0] <= last[0]; ++at[0])
            for (at[1] = first[1]; at[1] <= last[1]; ++at[1])
                for (at[2] = first[2]; at[2] <= last[2]; ++at[2])
                    if (isOn(taken_, {static_cast<std::int32_t>(l), at})) return true;
    }
    return false;
}

WallsAround Room::wallsAround(const Place& c) const {
    const Vec3 from = centre(c);
    const ClosestPoint near = index_.closest(from, options_.gapWidth * h(c));
    if (!near) return {options_.gapWidth, {}};
    WallsAround walls{near.distance / h(c), normalized(near.point - from)};
    const SegmentHit hit = index_.firstHit(from, from - walls.toWall * (options_.gapWidth * h(c)));
    walls.isOpposite = hit && std::abs(dot(index_.normal(hit.triangle), walls.toWall)) > options_.facing;
    if (walls.isOpposite) walls.width = walls.clearance + hit.t * options_.gapWidth;
    return walls;
}

bool Room::isKeptAt(const Place& c, const Vec3& offset) const {
    Place at = c;
    for (std::size_t axis = 0; axis < 3; ++axis) at.at[axis] += static_cast<std::int32_t>(std::floor(0.5 + offset[int(axis)]));
    return isKept(at);
}

bool Room::isFree(const Place& c) const {
    if (touchesTaken(c)) return false;
    for (int d = 0; d < 6; ++d) {
        const Place n = faceNeighbour(c, d);
        if (isForeign(n) && isWay(c, n)) return false;
    }
    return true;
}

double Room::distance(const Place& c) const {
    const ClosestPoint near = index_.closest(centre(c), h(c));
    return near ? near.distance : h(c);
}

bool Room::has(const Place& c, double& clearance) const {
    clearance = distance(c);
    return clearance >= options_.rim * h(c) && isFree(c);
}

// Balls about three points of the way: the ones at its ends belong to cells that have room.
bool Room::isWay(const Place& a, const Place& b) const {
    const Vec3 from = centre(a), to = centre(b);
    for (std::size_t i = 0; i < 3; ++i) {
        if (index_.closest(from + (to - from) * (0.25 * double(i + 1)), options_.way[i] * h(a))) return false;
    }
    return true;
}

// Beyond an edge that the flow goes around, cells that reach far into the solid cost the edge: they are told by how many are kept
// around.
bool Room::isInTheOpen(const Place& c) const {
    int kept = 0;
    for (int i = 0; i < 27; ++i) kept += isKept({c.level, {c.at[0] + i % 3 - 1, c.at[1] + i / 3 % 3 - 1, c.at[2] + i / 9 - 1}});
    return kept > options_.tuckedAway;
}

bool Room::displace(const Place& kept, Displaced& displaced) const {
    if (displaced.size() == displaced.capacity() || !isOn(candidates_, kept) || wallsAround(kept).isOpposite) return false;
    displaced.push_back(kept);
    return true;
}

bool Room::mayJoin(const Place& c, double& clearance, Displaced& displaced) const {
    if (!isCandidate(c) || isKept(c)) return false;
    clearance = distance(c);
    if (clearance < options_.least * h(c) || !isFree(c)) return false;
    if (clearance < options_.rim * h(c) && isInTheOpen(c)) return false;
    const auto isInGap = [&] { return wallsAround(c).isOpposite; };
    if (clearance < options_.squeezed * h(c) && !isInGap()) return false;
    bool joined = false;
    for (int d = 0; d < 6; ++d) {
        const Place n = faceNeighbour(c, d);
        const bool kept = isKept(n);
        if (!kept && !isForeign(n)) continue;
        const bool walled = isWallBetween(n, c);
        if (!kept && !walled) return false;
        if (kept && walled && ((displaced.empty() && !isInGap()) || !displace(n, displaced))) return false;
        joined = joined || (kept && !walled);
    }
    return joined;
}

std::vector<Place> besideKept(const Room& room) {
    std::vector<Place> places;
    for (std::size_t l = 0; l < room.candidates().size(); ++l) {
        const std::vector<const MaskLeaf*> leaves = leavesOf(std::as_const(*room.candidates()[l]));
        const RawVector<Place> found = collect<Place>(leaves.size(), [&](std::size_t i, const auto& put) {
            const Index3 o = toIndex(leaves[i]->origin());
            bits::forEach(leafBits(leaves[i]), [&](int x, int y, int z) {
                const Place cell{static_cast<std::int32_t>(l), {o[0] + x, o[1] + y, o[2] + z}};
                if (room.isKept(cell)) return;
                for (int d = 0; d < 6; ++d) {
                    if (room.isKept(faceNeighbour(cell, d))) return put(cell);
                }
            });
        }, 64);
        places.insert(places.end(), found.begin(), found.end());
    }
    tbb::parallel_sort(places.begin(), places.end());
    return places;
}

} // namespace i2b
