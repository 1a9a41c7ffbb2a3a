#include "i2b/carve/room.h"
#include "i2b/grid/mask_ops.h"

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
            MaskLeaf* leaf = write.touchLeaf(toCoord(piece.origin));
            LeafBits b = leafBits(leaf);
            for (std::size_t n = 0; n < 8; ++n) b[n] |= piece.mask[n];
            setLeafBits(*leaf, b);
        }
    }
    return candidates;
}

} // namespace

Room::Room(const CellGrid& grid, const CutCells& cut, const Regions& regions, const Region& region, const std::vector<Mask::Ptr>& kept,
           const std::vector<Mask::Ptr>& taken, const SurfaceIndex& index, const RoomOptions& options)
    : grid_(grid), kept_(kept), taken_(taken), index_(index), options_(options), painted_(regions.cellsOf(region.id)),
      candidates_(candidatesOf(grid, cut, regions, painted_, kept, options.pocketCells)) {}

bool Room::touchesTaken(const Place& c) const {
    if (taken_.empty()) return false;
    for (int i = 0; i < 27; ++i) {
        if (isOn(taken_, {c.level, {c.at[0] + i % 3 - 1, c.at[1] + i / 3 % 3 - 1, c.at[2] + i / 9 - 1}})) return true;
    }
    return false;
}

bool Room::has(const Place& c, double& clearance) const {
    const ClosestPoint near = index_.closest(centre(c), h(c));
    clearance = near ? near.distance : h(c);
    if (clearance < options_.rim * h(c) || touchesTaken(c)) return false;
    for (int d = 0; d < 6; ++d) {
        const Place n = faceNeighbour(c, d);
        if (isForeign(n) && isWay(c, n)) return false;
    }
    return true;
}

// Balls about three points of the way: the ones at its ends belong to cells that have room.
bool Room::isWay(const Place& a, const Place& b) const {
    const Vec3 from = centre(a), to = centre(b);
    for (std::size_t i = 0; i < 3; ++i) {
        if (index_.closest(from + (to - from) * (0.25 * double(i + 1)), options_.way[i] * h(a))) return false;
    }
    return true;
}

bool Room::mayJoin(const Place& c, double& clearance) const {
    if (!isCandidate(c) || isKept(c) || !has(c, clearance)) return false;
    bool joined = false;
    for (int d = 0; d < 6; ++d) {
        const Place n = faceNeighbour(c, d);
        if (!isKept(n)) continue;
        if (isWallBetween(n, c)) return false;
        joined = joined || isWay(n, c);
    }
    return joined;
}

} // namespace i2b
