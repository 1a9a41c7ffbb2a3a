// The header of a PLY file (Turk, The PLY Polygon File Format, 1994): which elements come, how often, and what each has. Private to the
// PLY reader.
#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace i2b {

enum class PlyType : std::uint8_t { int8, uint8, int16, uint16, int32, uint32, float32, float64 };
enum class PlyEncoding : std::uint8_t { ascii, littleEndian, bigEndian };

struct PlyProperty {
    std::string name;
    PlyType type = PlyType::float32; // of the value, or of each of a list
    bool isList = false;
    PlyType count = PlyType::uint8;  // of a list's length
};

struct PlyElement {
    std::string name;
    std::uint64_t count = 0;
    std::vector<PlyProperty> properties;
};

struct PlyHeader {
    PlyEncoding encoding = PlyEncoding::ascii;
    std::vector<PlyElement> elements;
    std::map<std::int64_t, std::string> parts; // of comments "part NUMBER NAME", which the property "part" of faces refers to
    std::size_t bytes = 0;                     // of the header
    std::string fault;                         // what is wrong; empty: nothing
};

PlyHeader readPlyHeader(std::string_view bytes);

} // namespace i2b
