// The result: a polyhedral mesh in OpenFOAM's face-based form.
//
//   face f has vertices faceVertices[faceOffsets[f] .. faceOffsets[f+1]), ordered so that its normal (right hand)
//   points from owner[f] to neighbour[f], or out of the domain on a boundary face.
//   Internal faces come first, by owner, then neighbour (upper triangular order); boundary faces follow patch by patch.
#pragma once
#include "i2b/core/raw_vector.h"
#include "i2b/core/vec.h"
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace i2b {

struct Patch {
    std::string name;
    std::string type = "patch"; // OpenFOAM's: wall, patch, symmetryPlane, empty, ...
    std::int32_t start = 0;     // first face
    std::int32_t count = 0;
};

struct CellZone {
    std::string name;
    RawVector<std::int32_t> cells; // ascending
};

struct PolyMesh {
    RawVector<Vec3> points;                   // m
    RawVector<std::uint32_t> faceOffsets;     // faces + 1
    RawVector<std::int32_t> faceVertices;
    RawVector<std::int32_t> owner;            // per face
    RawVector<std::int32_t> neighbour;        // per internal face
    std::int32_t cells = 0;
    std::vector<Patch> patches;
    std::vector<CellZone> zones;
    // Optional data for inspection; empty, or one value each.
    std::vector<std::uint8_t> cellLevel;      // per cell: lattice level, finest over the axes; layer cells carry their column's
    std::vector<std::uint8_t> cellLayer;      // per cell: 0 core, 1 the layer cell at the wall, 2 the next, ...
    std::vector<std::int32_t> cellRegion;     // per cell: painted region

    std::int32_t faces() const { return static_cast<std::int32_t>(owner.size()); }
    std::int32_t internalFaces() const { return static_cast<std::int32_t>(neighbour.size()); }
    std::span<const std::int32_t> face(std::int32_t f) const {
        return {faceVertices.data() + faceOffsets[static_cast<std::size_t>(f)],
                faceVertices.data() + faceOffsets[static_cast<std::size_t>(f) + 1]};
    }

    // "" or the first fault: array sizes, index ranges, owner < neighbour, upper triangular order, patches covering
    // the boundary faces in order, repeated or unused points, cells that are not closed. Cheap checks first.
    std::string validate() const;
    std::uint64_t checksum() const; // of everything but the optional data
};

} // namespace i2b
