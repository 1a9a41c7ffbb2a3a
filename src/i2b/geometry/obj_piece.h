// A stretch of an OBJ file, read by one thread without knowing the others; private to the OBJ reader.
#pragma once
#include "i2b/core/vec.h"
#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace i2b {

// A point as the file names it: 1.. counts from the begin of the file. -1.. counts back from the statement
// and is kept from 0 within the piece (less than 0: in a piece before it), with relativeBias added to tell it
// apart, for how many points come before the piece is known only later.
using ObjIndex = std::int64_t;
constexpr ObjIndex relativeBias = -(ObjIndex{1} << 50);

struct ObjName {
    std::uint64_t triangle = 0, segment = 0; // of the piece, from which it holds
    bool object = false;                     // `o`; else `g`
    std::string name;
};

struct ObjPiece {
    std::vector<Vec3> points;
    std::vector<std::array<ObjIndex, 3>> triangles;
    std::vector<std::array<ObjIndex, 2>> segments;
    std::vector<ObjIndex> freePoints;
    std::vector<ObjName> names;
    std::uint64_t shortFaces = 0, freeForms = 0; // left out
    std::uint64_t faultAt = ~std::uint64_t{0};   // byte in the file
    std::string fault;                           // what is wrong there; empty: nothing
};

// Reads bytes[begin, end). Points in metres.
ObjPiece readObjPiece(std::string_view bytes, std::size_t begin, std::size_t end, double scale);

} // namespace i2b
