// The part of the mesh that the fit moves: the prisms between front and wall, and the core cells within a few rings
// of the front. Nodes are the wall positions b (one a fan), then core points: front points f, rings behind, and the
// fixed points of the outermost cells.
#pragma once
#include "i2b/fit/band_corners.h"
#include "i2b/fit/blocks.h"
#include "i2b/fit/csr.h"
#include "i2b/front/front.h"
#include "i2b/front/wanted_room.h"
#include <cstdint>
#include <vector>

namespace i2b {

struct BandEdge {
    std::int32_t b = 0;                   // the other end
    float weight = 1;                     // in Laplacians: h / lattice length, less across the front
};

using Positions = RawVector<Vec3>;        // m, per node

struct Band {
    std::size_t walls = 0;                // nodes [0, walls) are wall nodes, in fan order
    std::size_t fronts = 0;               // nodes [walls, walls + fronts) are front points
    std::size_t movable = 0;              // nodes [0, movable) move; the rest are fixed
    Positions start;                      // a valid state
    RawVector<double> h;                  // m, per node: edge of the finest cell around
    RawVector<double> reach;              // m, per wall node: longest edge of the cells around, for what must be found
    RawVector<std::uint8_t> outside;      // per node: sides of the domain box that it lies in
    RawVector<std::int32_t> corePoint;    // per node from walls on: number in the LatticeMesh
    RawVector<std::int32_t> frontNode;    // per wall node: its front node
    RawVector<Vec3> inside;               // m, per front node (less walls): amid the kept cells around it; where that is behind
                                          // geometry, too, as at convex edges, at `away` (startPositions())
    RawVector<Vec3> away;                 // m, per front node (less walls), up to startPositions(): the middle of the cells straight off its wall
    std::vector<std::uint8_t> behind;     // per front node (less walls): starts behind geometry, seen from inside
    Csr<std::int32_t> fansOf;             // per front node (less walls): its wall nodes
    BandCorners corners;
    ChangingCsr<BandEdge> edges;          // per node; fixed: but those of the wall
    Csr<std::int32_t> parents;            // per node: ends of the coarse edge or face on whose middle it hangs; or none

    NodeBlocks blocks;                    // of the movable nodes
    WantedRoom room;                      // between front and wall

    std::size_t nodes() const { return start.size(); }
    // Of a prism at a wall or front node, in h: what the energy and the Laplacian tend to.
    double prismHeight(std::size_t node) const;
};

Band buildBand(const LatticeMesh& mesh, const Front& front, int rings, const WantedRoom& room = {});

// After faces of the front were split: the same nodes and core, other prisms.
void renewPrisms(Band& band, const Front& front);

} // namespace i2b
