#include "i2b/geometry/ply_header.h"
#include "i2b/geometry/text_scan.h"
#include <array>
#include <fmt/format.h>
#include <optional>

namespace i2b {
namespace {

constexpr std::size_t mostBytes = std::size_t{1} << 24; // of a header

std::optional<PlyType> typeOf(std::string_view name) {
    static constexpr std::array<std::array<std::string_view, 2>, 8> names{
        {{"char", "int8"}, {"uchar", "uint8"}, {"short", "int16"}, {"ushort", "uint16"}, {"int", "int32"}, {"uint", "uint32"}, {"float", "float32"}, {"double", "float64"}}};
    for (std::size_t i = 0; i < names.size(); ++i)
        if (name == names[i][0] || name == names[i][1]) return static_cast<PlyType>(i);
    return {};
}

// One line behind "property"; false where it makes no sense.
bool addProperty(text::Cursor& line, PlyHeader& header) {
    if (header.elements.empty()) return false;
    PlyProperty property;
    std::string_view type = line.token();
    property.isList = type == "list";
    if (property.isList) {
        const auto count = typeOf(line.token());
        if (!count || *count >= PlyType::float32) return false;
        property.count = *count;
        type = line.token();
    }
    const auto known = typeOf(type);
    if (!known) return false;
    property.type = *known;
    property.name = std::string(line.token());
    header.elements.back().properties.push_back(std::move(property));
    return true;
}

bool addElement(text::Cursor& line, PlyHeader& header) {
    PlyElement element{std::string(line.token()), 0, {}};
    const std::string_view count = line.token();
    const auto [end, error] = std::from_chars(count.data(), count.data() + count.size(), element.count);
    header.elements.push_back(std::move(element));
    return error == std::errc() && end == count.data() + count.size();
}

bool setEncoding(std::string_view name, PlyHeader& header) {
    if (name == "ascii") header.encoding = PlyEncoding::ascii;
    else if (name == "binary_little_endian") header.encoding = PlyEncoding::littleEndian;
    else if (name == "binary_big_endian") header.encoding = PlyEncoding::bigEndian;
    else return false;
    return true;
}

void addPart(text::Cursor line, PlyHeader& header) {
    if (line.token() != "part") return;
    const std::string_view word = line.token();
    std::int64_t number = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
    if (error == std::errc() && end == word.data() + word.size()) header.parts[number] = std::string(line.restOfLine());
}

} // namespace

PlyHeader readPlyHeader(std::string_view bytes) {
    PlyHeader header;
    text::Cursor c{bytes.data(), bytes.data() + std::min(bytes.size(), mostBytes)};
    while (!c.done()) {
        const std::string_view whole = c.line();
        c.skipLine(), c.skipLineEnd();
        text::Cursor line{whole.data(), whole.data() + whole.size()};
        const std::string_view word = line.token();
        if (word == "end_header") {
            header.bytes = static_cast<std::size_t>(c.at - bytes.data());
            return header;
        }
        const bool isRight = word == "property"  ? addProperty(line, header)
                             : word == "element" ? addElement(line, header)
                             : word == "format"  ? setEncoding(line.token(), header)
                                                 : true;
        if (word == "comment") addPart(line, header);
        if (!isRight) {
            header.fault = fmt::format("the PLY header says \"{}\"", text::trimmed(whole));
            return header;
        }
    }
    header.fault = "the PLY file is truncated: its header has no end";
    return header;
}

} // namespace i2b
