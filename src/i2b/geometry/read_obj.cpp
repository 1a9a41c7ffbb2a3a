// Wavefront OBJ: points are numbered over the whole file, so pieces are read first, then their points are
// counted and scanned, and only then can corners be resolved. A part is a pair of `o` and `g`; taken up again
// it goes on.
#include "i2b/core/error.h"
#include "i2b/core/parallel.h"
#include "i2b/geometry/file_soup.h"
#include "i2b/geometry/obj_piece.h"
#include "i2b/geometry/part_names.h"
#include "i2b/geometry/text_scan.h"
#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <unordered_map>

namespace i2b {
namespace {

constexpr std::size_t pieceBytes = std::size_t{1} << 20;
constexpr std::size_t mostPoints = ~std::uint32_t{0};

// True unless the line before goes on behind a backslash.
bool canStart(std::string_view bytes, std::size_t at) {
    std::size_t end = at - 1; // a line end
    if (bytes[end] == '\r' && bytes[at] == '\n') return false;
    if (end > 0 && bytes[end] == '\n' && bytes[end - 1] == '\r') --end;
    return end == 0 || bytes[end - 1] != '\\';
}

// Triangles and segments of a piece from here on belong to the part.
struct Run {
    std::size_t triangle = 0, segment = 0;
    std::int32_t part = 0;
};

struct ObjFile {
    const MappedFile& file;
    std::vector<ObjPiece> pieces;
    std::vector<std::size_t> firstPoint;
    std::vector<Vec3> points;

    [[noreturn]] void refuse(std::string what) const {
        throw Error(ErrorKind::input, std::move(what), file.path(), "export it again");
    }
    // From 0; points.size() or more if there is no such point.
    std::size_t resolve(ObjIndex index, std::size_t piece) const {
        if (index < relativeBias / 2)
            index += static_cast<ObjIndex>(firstPoint[piece]) - relativeBias;
        else
            index -= 1;
        return index < 0 ? points.size() : std::min(points.size(), static_cast<std::size_t>(index));
    }
};

void readPieces(ObjFile& obj, double scale) {
    const std::string_view bytes = obj.file.bytes();
    obj.pieces = readInPieces(obj.file, pieceBytes, canStart, [&](std::size_t begin, std::size_t end) { return readObjPiece(bytes, begin, end, scale); });
    for (const ObjPiece& piece : obj.pieces) {
        if (!piece.fault.empty()) refuseAt(obj.file, piece.fault, piece.faultAt);
        obj.firstPoint.push_back(piece.points.size());
    }
    const std::size_t points = exclusiveScan(obj.firstPoint);
    if (points >= mostPoints) obj.refuse("the file has more points than 32 bits count");
    obj.points.resize(points);
    parallelFor(
        obj.pieces.size(),
        [&](std::size_t i) {
            const std::vector<Vec3> own = std::move(obj.pieces[i].points);
            std::copy(own.begin(), own.end(), obj.points.data() + obj.firstPoint[i]);
        },
        1);
}

struct Taken { // of one piece
    std::uint64_t notNumbers = 0, coincident = 0, zeroArea = 0;
    std::size_t firstNotNumber = 0; // of the piece's triangles
    ObjIndex missing = 0;           // a point that a statement names and the file lacks; 0: none
};

// Resolves the piece's corners in place and leaves out the triangles that cannot be used.
Taken resolvePiece(ObjFile& obj, std::size_t i) {
    ObjPiece& piece = obj.pieces[i];
    Taken taken;
    const auto place = [&](ObjIndex& index) {
        const std::size_t at = obj.resolve(index, i);
        if (at == obj.points.size()) {
            if (taken.missing == 0) taken.missing = index;
            return false;
        }
        index = static_cast<ObjIndex>(at);
        return true;
    };
    std::size_t kept = 0, name = 0;
    const auto moveNames = [&](std::size_t t) {
        while (name < piece.names.size() && piece.names[name].triangle == t)
            piece.names[name++].triangle = kept;
    };
    for (std::size_t t = 0; t < piece.triangles.size(); ++t) {
        moveNames(t);
        auto v = piece.triangles[t];
        if (!place(v[0]) || !place(v[1]) || !place(v[2])) return taken;
        const auto point = [&](std::size_t k) { return obj.points[static_cast<std::size_t>(v[k])]; };
        const TriangleKind kind = kindOf(point(0), point(1), point(2));
        if (kind == TriangleKind::notNumber && taken.notNumbers == 0) taken.firstNotNumber = t;
        if (isKept(kind, taken)) piece.triangles[kept++] = v;
    }
    moveNames(piece.triangles.size());
    piece.triangles.resize(kept);
    for (auto& s : piece.segments)
        if (!place(s[0]) || !place(s[1])) return taken;
    for (ObjIndex& p : piece.freePoints)
        if (!place(p)) return taken;
    return taken;
}

void resolveAll(ObjFile& obj, FileSoup& soup) {
    std::vector<std::size_t> before;
    for (const ObjPiece& piece : obj.pieces) before.push_back(piece.triangles.size());
    exclusiveScan(before);
    std::vector<Taken> taken(obj.pieces.size());
    parallelFor(
        obj.pieces.size(), [&](std::size_t i) { taken[i] = resolvePiece(obj, i); }, 1);
    std::size_t firstNotNumber = 0; // from 1
    std::uint64_t shortFaces = 0, freeForms = 0;
    for (std::size_t i = 0; i < taken.size(); ++i) {
        if (ObjIndex index = taken[i].missing; index != 0) {
            if (index < relativeBias / 2)
                index += static_cast<ObjIndex>(obj.firstPoint[i]) - relativeBias + 1;
            obj.refuse(
                fmt::format("a face, line or point names point {}, and the file has {} points; it may be "
                            "truncated ({} bytes)",
                            index, obj.points.size(), obj.file.bytes().size()));
        }
        if (taken[i].notNumbers > 0 && soup.notes.notNumbers == 0)
            firstNotNumber = before[i] + taken[i].firstNotNumber + 1;
        soup.notes.notNumbers += taken[i].notNumbers;
        soup.notes.coincident += taken[i].coincident;
        soup.notes.zeroArea += taken[i].zeroArea;
        shortFaces += obj.pieces[i].shortFaces;
        freeForms += obj.pieces[i].freeForms;
    }
    const auto note = [&](std::string text) {
        soup.notes.messages.push_back(obj.file.path() + ": " + std::move(text));
    };
    if (soup.notes.notNumbers > 0)
        note(fmt::format(
            "{} triangles with coordinates that are not usable numbers were left out, the first is "
            "triangle {}",
            soup.notes.notNumbers, firstNotNumber));
    if (shortFaces > 0) note(fmt::format("{} faces with less than three corners were left out", shortFaces));
    if (freeForms > 0) note(fmt::format("{} free-form curves and surfaces were left out", freeForms));
}

// The names are settled when all parts are known: a group's own where no other object has one of that name.
void nameParts(const std::vector<std::array<std::string, 2>>& keys, std::vector<Part>& parts) {
    std::unordered_map<std::string, int> groups;
    for (const auto& [object, group] : keys) ++groups[group];
    for (std::size_t p = 0; p < parts.size(); ++p) {
        const auto& [object, group] = keys[p];
        const bool named = !isUninformative(group);
        if (!named && !isUninformative(object))
            parts[p].name = object;
        else if (!named)
            parts[p].name = group.empty() ? object : group;
        else if (groups[group] == 1 || isUninformative(object))
            parts[p].name = group;
        else
            parts[p].name = object + "_" + group;
    }
}

// A part comes to be with its first triangle or segment.
std::vector<std::vector<Run>> layRuns(const ObjFile& obj, FileSoup& soup) {
    std::vector<std::vector<Run>> runs(obj.pieces.size());
    std::vector<std::array<std::string, 2>> keys;
    std::unordered_map<std::string, std::int32_t> partOf;
    std::string object, group;
    const auto currentPart = [&] {
        const auto [at, fresh] =
            partOf.try_emplace(object + '\n' + group, static_cast<std::int32_t>(keys.size()));
        if (fresh) {
            keys.push_back({object, group});
            soup.surface.parts.push_back({"", obj.file.path(), 0});
        }
        return at->second;
    };
    for (std::size_t i = 0; i < obj.pieces.size(); ++i) {
        const ObjPiece& piece = obj.pieces[i];
        Run run;
        const auto take = [&](std::size_t triangle, std::size_t segment) {
            if (triangle == run.triangle && segment == run.segment) return;
            run.part = currentPart();
            soup.surface.parts[static_cast<std::size_t>(run.part)].triangles += triangle - run.triangle;
            runs[i].push_back(run);
            run = {triangle, segment, 0};
        };
        for (const ObjName& name : piece.names) {
            take(name.triangle, name.segment);
            if (name.object)
                object = name.name, group.clear();
            else
                group = name.name;
        }
        take(piece.triangles.size(), piece.segments.size());
    }
    nameParts(keys, soup.surface.parts);
    return runs;
}

void fill(ObjFile& obj, const std::vector<std::vector<Run>>& runs, Surface& s) {
    std::vector<std::size_t> firstTriangle, firstSegment, firstFree;
    for (const ObjPiece& piece : obj.pieces) {
        firstTriangle.push_back(piece.triangles.size());
        firstSegment.push_back(piece.segments.size());
        firstFree.push_back(piece.freePoints.size());
    }
    s.triangles.resize(exclusiveScan(firstTriangle));
    s.partOf.resize(s.triangles.size());
    s.segments.resize(exclusiveScan(firstSegment));
    s.freePoints.resize(exclusiveScan(firstFree));
    const auto narrow = [](ObjIndex v) { return static_cast<std::uint32_t>(v); };
    parallelFor(
        obj.pieces.size(),
        [&](std::size_t i) {
            const ObjPiece piece = std::move(obj.pieces[i]);
            for (std::size_t t = 0; t < piece.triangles.size(); ++t)
                for (std::size_t k = 0; k < 3; ++k)
                    s.triangles[firstTriangle[i] + t][k] = narrow(piece.triangles[t][k]);
            for (std::size_t r = 0; r < runs[i].size(); ++r) {
                const bool last = r + 1 == runs[i].size();
                const Run& run = runs[i][r];
                const std::size_t toTriangle = last ? piece.triangles.size() : runs[i][r + 1].triangle;
                const std::size_t toSegment = last ? piece.segments.size() : runs[i][r + 1].segment;
                std::fill(s.partOf.data() + firstTriangle[i] + run.triangle,
                          s.partOf.data() + firstTriangle[i] + toTriangle, run.part);
                for (std::size_t e = run.segment; e < toSegment; ++e)
                    s.segments[firstSegment[i] + e] = {narrow(piece.segments[e][0]),
                                                       narrow(piece.segments[e][1]), run.part};
            }
            for (std::size_t p = 0; p < piece.freePoints.size(); ++p)
                s.freePoints[firstFree[i] + p] = narrow(piece.freePoints[p]);
        },
        1);
}

} // namespace

bool looksLikeObj(std::string_view bytes) {
    if (bytes.starts_with("\xEF\xBB\xBF")) bytes.remove_prefix(3);
    bytes = bytes.substr(0, 1 << 16);
    if (bytes.find('\0') != std::string_view::npos) return false;
    static constexpr std::array words{"v", "vt", "vn", "vp", "f",      "l",
                                      "p", "g",  "o",  "s",  "mtllib", "usemtl"};
    text::Cursor c{bytes.data(), bytes.data() + bytes.size()};
    for (std::string_view word = c.token(); !word.empty(); word = c.token()) {
        if (word.front() != '#') return std::find(words.begin(), words.end(), word) != words.end();
        c.skipLine();
    }
    return false;
}

FileSoup readObj(const MappedFile& file, double scale) {
    FileSoup soup;
    ObjFile obj{file, {}, {}, {}};
    readPieces(obj, scale);
    resolveAll(obj, soup);
    const std::vector<std::vector<Run>> runs = layRuns(obj, soup);
    fill(obj, runs, soup.surface);
    keepUsedPoints(obj.points, soup.surface);
    return soup;
}

} // namespace i2b
