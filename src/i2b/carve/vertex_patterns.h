// The 256 ways in which the eight cells around a lattice vertex can be kept or removed.
//
// Octant o = x | y << 1 | z << 2, each bit set on the positive side. Around the vertex there are twelve quarter faces
// (between octants o and o ^ axis) and six lattice edges. A quarter face whose octants differ is exposed. Exposed
// faces meet at lattice edges: two of them join there; where four do (kept and removed alternate), the sheets come
// apart between the kept octants, unless those are joined elsewhere around the vertex: then between the removed ones.
// Following the joins gives closed cycles of faces, the fans: each is one sheet of the front, gets a vertex of its
// own, and belongs to one face-connected component of kept octants.
#pragma once
#include "i2b/core/vec.h"
#include <array>
#include <cstdint>

namespace i2b {

inline constexpr std::uint8_t noFan = 0xff;

// Quarter face between octants o (bit of axis clear) and o | 1 << axis.
inline constexpr int quarterFace(int axis, int octant) {
    const int b = octant >> ((axis + 1) % 3) & 1, c = octant >> ((axis + 2) % 3) & 1;
    return 4 * axis + 2 * c + b;
}

enum class Alternation : std::uint8_t { none, keptApart, removedApart };

struct VertexPattern {
    std::array<std::uint8_t, 8> component{};  // kept octant -> component; noFan where removed
    std::uint8_t components = 0;
    std::array<std::uint8_t, 12> fan{};       // quarter face -> fan; noFan where not exposed
    std::uint8_t fans = 0;
    std::array<std::uint8_t, 6> fanComponent{};
    std::array<std::array<std::int8_t, 3>, 6> direction{}; // sum of the distinct outward face normals of a fan
    std::array<bool, 6> good{};               // some direction has a positive component on every face of the fan
    std::array<Alternation, 6> edge{};        // lattice edge 2 * axis + (1 if positive side)
    bool allGood = true;
};

const VertexPattern& vertexPattern(std::uint8_t kept);

// Octants outside the domain take the state of their mirror image, so that the front meets a domain side squarely.
// outside: bit 2 * axis (+ 1) set where the octants on the negative (positive) side lie outside.
std::uint8_t mirrored(std::uint8_t kept, int outside);

} // namespace i2b
