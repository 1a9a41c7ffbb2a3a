// A stretch of a Nastran deck, read by one thread without knowing the others; private to the Nastran reader.
#pragma once
#include "i2b/core/vec.h"
#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace i2b {

struct NastranPiece {
    struct Grid {
        std::int32_t id = 0;
        Vec3 place; // m
    };
    struct Element {
        std::int32_t property = 0;
        std::array<std::int32_t, 4> grids{}; // ids; the last is 0 for triangles
    };
    struct Name {
        std::int32_t property = 0;
        int rank = 0; // the highest of a property counts
        std::string name;
    };
    std::vector<Grid> grids;
    std::vector<Element> elements;
    std::vector<Name> names;
    std::uint64_t otherElements = 0, includes = 0; // left out
    std::uint64_t faultAt = ~std::uint64_t{0};     // byte in the file
    std::string fault;                             // what is wrong there; empty: nothing
    bool ends = false;                             // ENDDATA: nothing after it counts
};

// Reads bytes[begin, end). Triangles and quadrangles of any order by their corners; points in metres. Names are those that ANSA,
// HyperMesh and Femap write into comments.
NastranPiece readNastranPiece(std::string_view bytes, std::size_t begin, std::size_t end, double scale);

} // namespace i2b
