#include "i2b/geometry/nastran_piece.h"
#include "i2b/geometry/nastran_card.h"
#include "i2b/geometry/text_scan.h"
#include <algorithm>
#include <limits>
#include <optional>

namespace i2b {
namespace {

constexpr std::array<std::string_view, 3> triangles{"ctria3", "ctria6", "ctriar"};
constexpr std::array<std::string_view, 4> quadrangles{"cquad4", "cquad8", "cquadr", "cquad"};
constexpr std::array<std::string_view, 12> others{"ctetra", "chexa", "cpenta", "cpyram", "cbar", "cbeam", "crod", "conrod", "ctube", "cshear", "ctriax6", "cbush"};

// A whole number at the begin of a text, which is taken off it with the blanks around.
std::optional<std::int32_t> takeNumber(std::string_view& rest) {
    rest = text::trimmed(rest);
    std::int32_t value = 0;
    const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), value);
    if (error != std::errc()) return {};
    rest.remove_prefix(static_cast<std::size_t>(end - rest.data()));
    return value;
}

std::string_view upTo(std::string_view& rest, char stop) {
    const std::size_t at = std::min(rest.size(), rest.find(stop));
    const std::string_view taken = rest.substr(0, at);
    rest.remove_prefix(std::min(rest.size(), at + 1));
    return text::trimmed(taken);
}

struct DeckReader {
    std::string_view bytes;
    double scale;
    NastranPiece& piece;
    NastranCard card = {};

    bool fail(const char* at, std::string what) {
        piece.faultAt = static_cast<std::uint64_t>(at - bytes.data()), piece.fault = std::move(what);
        return false;
    }
    bool isAny(const auto& names) const {
        return std::ranges::any_of(names, [&](std::string_view name) { return card.is(name); });
    }
    bool isId(const std::optional<std::int64_t>& id) const { return id && *id > 0 && *id <= std::numeric_limits<std::int32_t>::max(); }

    bool readGrid(const char* at) {
        const auto id = card.integer(0), system = card.integer(1);
        if (!isId(id)) return fail(at, "a GRID has no number");
        if (!system) return fail(at, "a GRID has a coordinate system that is no number");
        if (*system != 0) return fail(at, "a GRID is given in a coordinate system of its own: export in the basic one");
        const auto x = card.real(2), y = card.real(3), z = card.real(4);
        if (!x || !y || !z) return fail(at, "a GRID has a coordinate that is no number");
        piece.grids.push_back({static_cast<std::int32_t>(*id), Vec3{*x, *y, *z} * scale});
        return true;
    }
    bool readElement(const char* at, std::size_t corners) {
        const auto property = card.integer(1);
        if (!property || *property < 0 || *property > std::numeric_limits<std::int32_t>::max()) return fail(at, "an element has no property number");
        NastranPiece::Element element{static_cast<std::int32_t>(*property), {}};
        for (std::size_t k = 0; k < corners; ++k) {
            const auto id = card.integer(2 + k);
            if (!isId(id)) return fail(at, "an element has a corner without a number");
            element.grids[k] = static_cast<std::int32_t>(*id);
        }
        piece.elements.push_back(element);
        return true;
    }
    void addName(std::optional<std::int32_t> property, int rank, std::string_view name) {
        if (property && !text::trimmed(name).empty()) piece.names.push_back({*property, rank, std::string(text::trimmed(name))});
    }
    // $ANSA_NAME_COMMENT;7;PSHELL;name;...  $ANSA_NAME;7;PSHELL;~ and on the next line $name
    void readAnsaName(std::string_view rest, std::string_view next) {
        const bool isWhole = rest.starts_with("_COMMENT;");
        rest.remove_prefix(isWhole ? 9 : 1);
        const auto property = takeNumber(rest);
        if (rest.starts_with(";")) rest.remove_prefix(1);
        const std::string_view kind = upTo(rest, ';');
        if (kind != "PSHELL" && kind != "PCOMP") return; // a material, a set
        if (isWhole) addName(property, 2, upTo(rest, ';'));
        else if (next.starts_with("$")) addName(property, 2, next.substr(1));
    }
    // $HMNAME PROP       7"name" 4     $HMNAME COMP       7"name"
    void readHyperMeshName(std::string_view rest) {
        const bool isProperty = rest.starts_with("PROP");
        if (!isProperty && !rest.starts_with("COMP")) return;
        rest.remove_prefix(4);
        const auto property = takeNumber(rest);
        upTo(rest, '"');
        addName(property, isProperty ? 2 : 1, upTo(rest, '"'));
    }
    // $ Femap with NX Nastran Property 7 : name
    void readFemapName(std::string_view rest) {
        constexpr std::string_view word = "Property ";
        const std::size_t at = rest.find(word);
        if (at == std::string_view::npos) return;
        rest.remove_prefix(at + word.size());
        const auto property = takeNumber(rest);
        upTo(rest, ':');
        addName(property, 2, rest);
    }
    void readComment(text::Cursor& c) {
        const std::string_view line = c.line();
        c.skipLine(), c.skipBlank();
        if (line.starts_with("$ANSA_NAME;") || line.starts_with("$ANSA_NAME_COMMENT;")) readAnsaName(line.substr(10), c.line());
        if (line.starts_with("$HMNAME ")) readHyperMeshName(text::trimmed(line.substr(8)));
        if (line.starts_with("$ Femap")) readFemapName(line);
    }
    bool readCard(text::Cursor& c) {
        const char* const at = c.at;
        if (!text::isSpace(*at)) {
            card.read(c);
            if (card.is("grid")) return readGrid(at);
            if (isAny(triangles)) return readElement(at, 3);
            if (isAny(quadrangles)) return readElement(at, 4);
            piece.otherElements += isAny(others);
            piece.ends = card.is("enddata");
            const std::string_view line = text::Cursor{at, c.end}.line();
            piece.includes += text::equalsNoCase(line.substr(0, std::min<std::size_t>(8, line.size())), "include ");
            return !piece.ends;
        }
        c.skipLine(); // of a card that is left out, or of case control
        return true;
    }
};

} // namespace

NastranPiece readNastranPiece(std::string_view bytes, std::size_t begin, std::size_t end, double scale) {
    NastranPiece piece;
    DeckReader reader{bytes, scale, piece};
    text::Cursor c{bytes.data() + begin, bytes.data() + end};
    while (!c.done()) {
        if (text::isLineEnd(*c.at)) ++c.at;
        else if (*c.at == '$') reader.readComment(c);
        else if (!reader.readCard(c)) break;
    }
    return piece;
}

} // namespace i2b
