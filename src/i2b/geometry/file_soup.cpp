#include "i2b/geometry/file_soup.h"
#include "i2b/core/error.h"
#include "i2b/core/parallel.h"
#include "i2b/geometry/weld.h"
#include <algorithm>
#include <fmt/format.h>

namespace i2b {
namespace {

// A run of triangles and points of one piece that belong to one part.
struct Run {
    std::size_t triangle = 0, point = 0;
    std::int32_t part = 0;
};

// A solid becomes a part when its first triangle comes, so that empty ones leave no trace but a count.
std::vector<std::vector<Run>> layRuns(const MappedFile& file, const std::vector<StlPiece>& pieces,
                                      FileSoup& soup) {
    std::vector<std::vector<Run>> runs(pieces.size());
    std::string name; // of the solid that is open; nameless before the first
    bool isPart = false, open = false;
    std::vector<Part>& parts = soup.surface.parts;
    const auto take = [&](std::size_t i, std::size_t triangle, std::size_t point, std::size_t end) {
        if (triangle == end) return;
        if (!isPart) parts.push_back({name, file.path(), 0});
        isPart = true;
        parts.back().triangles += end - triangle;
        runs[i].push_back({triangle, point, static_cast<std::int32_t>(parts.size()) - 1});
    };
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        std::size_t triangle = 0, point = 0;
        for (const SolidStart& solid : pieces[i].solids) {
            take(i, triangle, point, solid.triangle);
            soup.notes.emptyParts += open && !isPart;
            triangle = solid.triangle, point = solid.point;
            name = solid.name, isPart = false, open = true;
        }
        take(i, triangle, point, pieces[i].triangles.size());
    }
    soup.notes.emptyParts += open && !isPart;
    return runs;
}

} // namespace

TriangleKind kindOf(const Vec3& a, const Vec3& b, const Vec3& c) {
    constexpr double largest = 1e30;   // squares and their products stay finite in double
    for (const Vec3* p : {&a, &b, &c}) // written so that NaN fails
        if (!(std::abs(p->x) <= largest && std::abs(p->y) <= largest && std::abs(p->z) <= largest))
            return TriangleKind::notNumber;
    const Vec3 u = b - a, v = c - a;
    const double longest = std::max({norm2(u), norm2(v), norm2(c - b)});
    if (longest == 0 && a == b && a == c) return TriangleKind::coincident;
    return norm2(cross(u, v)) <= 1e-24 * longest * longest ? TriangleKind::zeroArea : TriangleKind::good;
}

void refuseAt(const MappedFile& file, std::string_view fault, std::uint64_t at) {
    throw Error(ErrorKind::input, fmt::format("{} at line {} of {} bytes", fault, text::lineOf(file.bytes(), at), file.bytes().size()), file.path(), "export it again");
}

void keepUsedPoints(std::vector<Vec3>& points, Surface& s) {
    const auto usable = [&](std::uint32_t v) {
        return kindOf(points[v], points[v], points[v]) != TriangleKind::notNumber;
    };
    std::erase_if(s.segments, [&](const FreeSegment& f) { return !usable(f.a) || !usable(f.b); });
    std::erase_if(s.freePoints, [&](std::uint32_t v) { return !usable(v); });
    constexpr std::uint32_t unused = ~std::uint32_t{0};
    std::vector<std::uint32_t> number(points.size(), unused);
    for (const auto& t : s.triangles)
        for (const std::uint32_t v : t) number[v] = 0;
    for (const FreeSegment& f : s.segments) number[f.a] = number[f.b] = 0;
    for (const std::uint32_t v : s.freePoints) number[v] = 0;
    std::uint32_t next = 0;
    for (std::size_t p = 0; p < points.size(); ++p)
        if (number[p] != unused) {
            points[next] = points[p];
            number[p] = next++;
        }
    if (next != points.size()) {
        points.resize(next);
        parallelFor(s.triangles.size(), [&](std::size_t t) {
            for (std::uint32_t& v : s.triangles[t]) v = number[v];
        });
        for (FreeSegment& f : s.segments) f.a = number[f.a], f.b = number[f.b];
        for (std::uint32_t& v : s.freePoints) v = number[v];
    }
    s.points = std::move(points);
}

FileSoup joinPieces(const MappedFile& file, std::vector<StlPiece>& pieces) {
    FileSoup soup;
    const std::vector<std::vector<Run>> runs = layRuns(file, pieces, soup);
    std::vector<std::size_t> firstPoint, firstTriangle;
    for (const StlPiece& piece : pieces) {
        firstPoint.push_back(piece.points.size());
        firstTriangle.push_back(piece.triangles.size());
        soup.notes.notNumbers += piece.notNumbers;
        soup.notes.coincident += piece.coincident;
        soup.notes.zeroArea += piece.zeroArea;
    }
    const std::size_t points = exclusiveScan(firstPoint), triangles = exclusiveScan(firstTriangle);
    if (points >= ~std::uint32_t{0})
        throw Error(ErrorKind::input, "the file has more points than 32 bits count", file.path(),
                    "split it or leave out detail");
    Surface& s = soup.surface;
    s.points.resize(points);
    s.triangles.resize(triangles);
    s.partOf.resize(triangles);
    std::vector<std::int32_t> partOfPoint(points);
    parallelFor(
        pieces.size(),
        [&](std::size_t i) {
            const auto offset = static_cast<std::uint32_t>(firstPoint[i]);
            StlPiece piece = std::move(pieces[i]);
            std::copy(piece.points.begin(), piece.points.end(), s.points.data() + firstPoint[i]);
            for (std::size_t t = 0; t < piece.triangles.size(); ++t)
                for (std::size_t k = 0; k < 3; ++k)
                    s.triangles[firstTriangle[i] + t][k] = piece.triangles[t][k] + offset;
            for (std::size_t r = 0; r < runs[i].size(); ++r) {
                const Run& run = runs[i][r];
                const bool last = r + 1 == runs[i].size();
                const std::size_t toTriangle = last ? piece.triangles.size() : runs[i][r + 1].triangle;
                const std::size_t toPoint = last ? piece.points.size() : runs[i][r + 1].point;
                std::fill(s.partOf.data() + firstTriangle[i] + run.triangle,
                          s.partOf.data() + firstTriangle[i] + toTriangle, run.part);
                std::fill(partOfPoint.data() + firstPoint[i] + run.point,
                          partOfPoint.data() + firstPoint[i] + toPoint, run.part);
            }
        },
        1);
    weldPoints(s.points, partOfPoint, s.triangles);
    return soup;
}

} // namespace i2b
