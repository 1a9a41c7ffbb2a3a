// The strip of wall faces before the rims of sheets: which faces they are, and where on the rim each of their nodes is to be. Two rows of
// nodes bound the strip, one of either side of the sheet; nodes across it become one where an edge joins them.
#pragma once
#include "i2b/core/vec.h"
#include <array>
#include <cstdint>
#include <unordered_map>
#include <vector>

namespace i2b {

class FeatureIndex;
class SurfaceIndex;
struct Front;
struct PolyMesh;
struct Wall;

struct RimRows {
    static constexpr double tooNear = 0.35; // of h along the rim: nodes so near are one, or an edge between them would be too short
    struct Node {
        bool moves = false;
        Vec3 to;                   // m, on the rim
        double h = 0;              // m, of the front around
        std::int32_t partner = -1; // point that becomes one with it
        std::array<std::int32_t, 2> row{-1, -1}; // neighbours along its row, places; none where there are not two
    };
    struct Edge { std::int32_t a, b; std::size_t face, other; }; // points; places in wall.faces
    std::vector<Node> nodes;                // per wall node
    std::vector<std::uint8_t> isBefore;     // per wall face: all its nodes go to a rim
    std::vector<Edge> across;               // between two such faces
    std::unordered_map<std::int32_t, std::vector<std::int32_t>> facesOf; // per point that moves, places in wall.faces, ascending
};

// wall: its nodes follow each other as the vertices of front do. index: of the geometry; rims: of it, alone.
RimRows findRimRows(const PolyMesh& mesh, const Wall& wall, const Front& front, const SurfaceIndex& index, const FeatureIndex& rims);

// Where two nodes that become one go: on a corner of the rim that one of them has, else between them. m
Vec3 betweenOnRim(const RimRows::Node& a, const RimRows::Node& b, const FeatureIndex& rims);

} // namespace i2b
