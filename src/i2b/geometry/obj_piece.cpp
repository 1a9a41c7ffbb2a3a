#include "i2b/geometry/obj_piece.h"
#include "i2b/geometry/text_scan.h"

namespace i2b {
namespace {

// Far from the bias, so that sums with it keep their meaning.
constexpr ObjIndex largestIndex = ObjIndex{1} << 40;

struct StatementReader {
    std::string_view bytes;
    double scale;
    ObjPiece& piece;
    std::vector<ObjIndex> corners = {};

    bool fail(const char* at, std::string what) {
        piece.faultAt = static_cast<std::uint64_t>(at - bytes.data()), piece.fault = std::move(what);
        return false;
    }
    // Spaces, and line ends behind a backslash; nothing else is blank inside a statement.
    static void skipSpace(text::Cursor& c) {
        for (;;) {
            c.skipSpace();
            if (c.done() || *c.at != '\\') return;
            const char* next = c.at + 1;
            if (next == c.end || !text::isLineEnd(*next)) return;
            next += *next == '\r' && next + 1 != c.end && next[1] == '\n' ? 2 : 1;
            c.at = next;
        }
    }
    static bool atEnd(const text::Cursor& c) { return c.done() || text::isLineEnd(*c.at); }
    static void skipStatement(text::Cursor& c) {
        for (;;) {
            skipSpace(c);
            if (atEnd(c)) return;
            ++c.at;
        }
    }
    bool readPoint(text::Cursor& c) { // x y z and perhaps a weight or a colour
        Vec3 p;
        for (int i = 0; i < 3; ++i) {
            skipSpace(c);
            const char* const end = atEnd(c) ? nullptr : text::number(c.at, c.end, p[i]);
            if (!end) return fail(c.at, "a point has something that is no number");
            c.at = end;
        }
        piece.points.push_back(p * scale);
        return true;
    }
    // i, i/j, i//k, i/j/k: the point is what comes first.
    bool readCorners(text::Cursor& c) {
        corners.clear();
        for (skipSpace(c); !atEnd(c); skipSpace(c)) {
            if (*c.at == '#') return skipStatement(c), true;
            ObjIndex i = 0;
            const char* const first = *c.at == '+' ? c.at + 1 : c.at;
            const auto [end, error] = std::from_chars(first, c.end, i);
            const bool stops = end == c.end || text::isBlank(*end) || *end == '/' || *end == '\\';
            if (error != std::errc() || !stops || i == 0 || i > largestIndex || i < -largestIndex)
                return fail(c.at, "a corner has no point number");
            if (i < 0) i += static_cast<ObjIndex>(piece.points.size()) + relativeBias;
            corners.push_back(i);
            c.at = end;
            while (!atEnd(c) && !text::isSpace(*c.at) && *c.at != '\\') ++c.at; // texture and normal
        }
        return true;
    }
    bool readFace(text::Cursor& c) {
        if (!readCorners(c)) return false;
        piece.shortFaces += corners.size() < 3;
        for (std::size_t i = 2; i < corners.size(); ++i)
            piece.triangles.push_back({corners[0], corners[i - 1], corners[i]});
        return true;
    }
    bool readLine(text::Cursor& c) {
        if (!readCorners(c)) return false;
        for (std::size_t i = 1; i < corners.size(); ++i)
            piece.segments.push_back({corners[i - 1], corners[i]});
        return true;
    }
    bool readFreePoints(text::Cursor& c) {
        if (!readCorners(c)) return false;
        piece.freePoints.insert(piece.freePoints.end(), corners.begin(), corners.end());
        return true;
    }
    bool readStatement(text::Cursor& c) {
        skipSpace(c);
        const char* const begin = c.at;
        while (!atEnd(c) && !text::isSpace(*c.at) && *c.at != '\\') ++c.at;
        const std::string_view word(begin, static_cast<std::size_t>(c.at - begin));
        if (word == "v") return readPoint(c) && (skipStatement(c), true);
        if (word == "f" || word == "fo") return readFace(c); // fo: what f was called once
        if (word == "l") return readLine(c);
        if (word == "p") return readFreePoints(c);
        if (word == "g" || word == "o") {
            skipSpace(c);
            piece.names.push_back(
                {piece.triangles.size(), piece.segments.size(), word == "o", std::string(c.restOfLine())});
            return true;
        }
        piece.freeForms += word == "curv" || word == "surf";
        skipStatement(
            c); // comments too: a backslash continues them in some files, and nothing is lost where not
        return true;
    }
};

} // namespace

ObjPiece readObjPiece(std::string_view bytes, std::size_t begin, std::size_t end, double scale) {
    ObjPiece piece;
    StatementReader reader{bytes, scale, piece};
    text::Cursor c{bytes.data() + begin, bytes.data() + end};
    for (c.skipBlank(); !c.done(); c.skipBlank())
        if (!reader.readStatement(c)) break;
    return piece;
}

} // namespace i2b
