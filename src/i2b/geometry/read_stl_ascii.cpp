// ASCII STL: "solid NAME", facets, "endsolid"; keywords in any case and layout. Normals are not looked at,
// for they mean nothing here. The text is cut at lines that begin with "facet" or "solid" and its pieces are
// read at once.
#include "i2b/core/error.h"
#include "i2b/core/parallel.h"
#include "i2b/geometry/file_soup.h"
#include "i2b/geometry/text_scan.h"
#include "i2b/geometry/weld.h"
#include <algorithm>
#include <fmt/format.h>

namespace i2b {
namespace {

constexpr std::size_t pieceBytes = std::size_t{1} << 21; // about 8000 triangles

bool startsWithWord(std::string_view s, std::string_view lowerCase) {
    return s.size() > lowerCase.size() && text::equalsNoCase(s.substr(0, lowerCase.size()), lowerCase) &&
           text::isBlank(s[lowerCase.size()]);
}

// True if the line at `at` begins a facet or a solid: between these no facet is open.
bool canStart(std::string_view bytes, std::size_t at) {
    while (at < bytes.size() && text::isSpace(bytes[at])) ++at;
    return startsWithWord(bytes.substr(at), "facet") || startsWithWord(bytes.substr(at), "solid");
}

// A solid's name is the rest of its line; where all of the file is one line, what comes before the first
// facet.
std::string_view solidName(text::Cursor& c) {
    c.skipSpace();
    const char* const begin = c.at;
    std::string_view name = c.restOfLine();
    for (std::size_t i = 0; i < name.size(); ++i)
        if ((i == 0 || text::isBlank(name[i - 1])) && startsWithWord(name.substr(i), "facet") &&
            startsWithWord(text::trimmed(name.substr(i + 5)), "normal")) {
            c.at = name.data() + i;
            return text::trimmed({begin, static_cast<std::size_t>(c.at - begin)});
        }
    return name;
}

struct FacetReader {
    std::string_view bytes; // of the whole file, for places
    double scale;
    StlPiece& piece;
    PieceWelder welder;
    std::vector<Vec3> corners = {}; // of the open facet
    const char* facet = nullptr;    // where it began; null: none is open

    std::uint64_t placeOf(const char* at) const { return static_cast<std::uint64_t>(at - bytes.data()); }
    bool fail(const char* at, std::string what) {
        piece.faultAt = placeOf(at), piece.fault = std::move(what);
        return false;
    }
    bool readVertex(text::Cursor& c) {
        const char* const begin = c.at;
        if (!facet) return fail(begin, "a vertex stands outside a facet");
        Vec3 p;
        for (int i = 0; i < 3; ++i) {
            c.skipBlank();
            const char* const end = text::number(c.at, c.end, p[i]);
            if (!end && c.done()) return fail(facet, "the file is truncated inside the facet that begins");
            if (!end) return fail(c.at, "a vertex has something that is no number");
            c.at = end;
        }
        corners.push_back(p * scale);
        return true;
    }
    void takeTriangle(const Vec3& a, const Vec3& b, const Vec3& d) {
        const TriangleKind kind = kindOf(a, b, d);
        if (kind == TriangleKind::notNumber && piece.notNumbers == 0) piece.firstNotNumber = placeOf(facet);
        if (isKept(kind, piece))
            piece.triangles.push_back({welder.add(a), welder.add(b), welder.add(d)});
    }
    bool endFacet(const char* at) {
        if (!facet) return fail(at, "a facet ends that did not begin");
        if (corners.size() < 3) return fail(facet, fmt::format("a facet has {} corners", corners.size()));
        for (std::size_t i = 2; i < corners.size(); ++i) takeTriangle(corners[0], corners[i - 1], corners[i]);
        corners.clear();
        facet = nullptr;
        return true;
    }
    // One statement; false at a fault.
    bool readStatement(std::string_view word, text::Cursor& c) {
        if (text::equalsNoCase(word, "vertex")) return readVertex(c);
        if (text::equalsNoCase(word, "endfacet")) return endFacet(word.data());
        if (text::equalsNoCase(word, "facet")) {
            if (facet) return fail(word.data(), "a facet begins inside another");
            facet = word.data();
            return true;
        }
        if (text::equalsNoCase(word, "normal")) { // whatever the three words are
            for (int i = 0; i < 3; ++i) c.token();
            return true;
        }
        if (text::equalsNoCase(word, "outer") || text::equalsNoCase(word, "loop") ||
            text::equalsNoCase(word, "endloop"))
            return true;
        if (text::equalsNoCase(word, "solid")) {
            if (facet) return fail(word.data(), "a solid begins inside a facet");
            piece.solids.push_back({piece.triangles.size(), piece.points.size(), std::string(solidName(c))});
            welder.startPart();
            piece.endsSolid = false;
            return true;
        }
        if (text::equalsNoCase(word, "endsolid")) piece.endsSolid = true;
        c.skipLine(); // a comment, a colour, the name of the solid that ends
        return true;
    }
};

StlPiece readPiece(const MappedFile& file, std::size_t begin, std::size_t end, double scale) {
    StlPiece piece;
    const char* const data = file.bytes().data();
    FacetReader reader{file.bytes(), scale, piece, PieceWelder(piece.points)};
    text::Cursor c{data + begin, data + end};
    for (std::string_view word = c.token(); !word.empty(); word = c.token())
        if (!reader.readStatement(word, c)) return piece;
    if (reader.facet) reader.fail(reader.facet, "the file is truncated inside the facet that begins");
    piece.points.shrink_to_fit();
    piece.triangles.shrink_to_fit();
    return piece;
}

} // namespace

bool looksLikeAsciiStl(std::string_view bytes) {
    if (bytes.starts_with("\xEF\xBB\xBF")) bytes.remove_prefix(3);
    const std::string_view head = text::trimmed(bytes.substr(0, 4096));
    if (head.find('\0') != std::string_view::npos) return false; // "solid" may begin a binary header
    return startsWithWord(head, "solid") || startsWithWord(head, "facet") ||
           text::equalsNoCase(head, "solid");
}

FileSoup readStlAscii(const MappedFile& file, double scale) {
    const std::string_view bytes = file.bytes();
    std::vector<StlPiece> pieces =
        readInPieces(file, pieceBytes, canStart, [&](std::size_t begin, std::size_t end) { return readPiece(file, begin, end, scale); });
    std::uint64_t firstNotNumber = ~std::uint64_t{0};
    for (const StlPiece& piece : pieces) {
        if (!piece.fault.empty()) refuseAt(file, piece.fault, piece.faultAt);
        firstNotNumber = std::min(firstNotNumber, piece.firstNotNumber);
    }
    const bool ended = pieces.back().endsSolid;
    FileSoup soup = joinPieces(file, pieces);
    if (soup.notes.notNumbers > 0)
        soup.notes.messages.push_back(fmt::format("{}: {} triangles with coordinates that are not usable "
                                                  "numbers were left out, the first at line {}",
                                                  file.path(), soup.notes.notNumbers,
                                                  text::lineOf(bytes, firstNotNumber)));
    if (!ended)
        soup.notes.messages.push_back(
            fmt::format("{}: the last solid has no end; the file may be incomplete", file.path()));
    return soup;
}

} // namespace i2b
