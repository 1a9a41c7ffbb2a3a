// What one file gives, before names are settled and files are joined; private to the readers.
#pragma once
#include "i2b/core/parallel.h"
#include "i2b/geometry/mapped_file.h"
#include "i2b/geometry/read.h"
#include "i2b/geometry/surface.h"
#include "i2b/geometry/text_scan.h"
#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace i2b {

struct FileSoup {
    Surface surface; // in metres; parts carry the names as the file has them, no part is empty
    GeometryNotes notes;
};

// A solid begins at a triangle and a point of its piece. file order.
struct SolidStart {
    std::uint64_t triangle = 0, point = 0;
    std::string name;
};

// A stretch of an STL file, read by one thread.
struct StlPiece {
    std::vector<Vec3> points;                            // welded within the piece and part
    std::vector<std::array<std::uint32_t, 3>> triangles; // into points
    std::vector<SolidStart> solids;
    std::uint64_t notNumbers = 0, coincident = 0, zeroArea = 0;
    std::uint64_t firstNotNumber = ~std::uint64_t{0}; // byte in the file
    std::uint64_t faultAt = ~std::uint64_t{0};        // byte in the file
    std::string fault;                                // what is wrong there; empty: nothing
    bool endsSolid = false;
};

// How a triangle is taken; see GeometryNotes.
enum class TriangleKind { good, zeroArea, coincident, notNumber };
TriangleKind kindOf(const Vec3& a, const Vec3& b, const Vec3& c);
// Counts a triangle, in anything that counts them as GeometryNotes does; is it one to keep?
template <class Counts>
bool isKept(TriangleKind kind, Counts& counts) {
    counts.notNumbers += kind == TriangleKind::notNumber;
    counts.coincident += kind == TriangleKind::coincident;
    counts.zeroArea += kind == TriangleKind::zeroArea;
    return kind == TriangleKind::good || kind == TriangleKind::zeroArea;
}

// A text in pieces, read side by side: read(begin, end) gives one, and canStart is as for text::pieces().
template <class CanStart, class Read>
auto readInPieces(const MappedFile& file, std::size_t size, const CanStart& canStart, const Read& read) {
    const std::string_view bytes = file.bytes();
    std::vector<std::size_t> starts = text::pieces(bytes, size, canStart);
    if (bytes.starts_with("\xEF\xBB\xBF")) starts.front() = 3;
    starts.push_back(bytes.size());
    std::vector<decltype(read(std::size_t(), std::size_t()))> pieces(starts.size() - 1);
    parallelFor(
        pieces.size(),
        [&](std::size_t i) {
            pieces[i] = read(starts[i], starts[i + 1]);
            file.release(starts[i], starts[i + 1]);
        },
        1);
    return pieces;
}
// at: byte in the file.
[[noreturn]] void refuseAt(const MappedFile& file, std::string_view fault, std::uint64_t at);

FileSoup readStlBinary(const MappedFile& file, double scale);
FileSoup readStlAscii(const MappedFile& file, double scale);
FileSoup readObj(const MappedFile& file, double scale);
FileSoup readNastran(const MappedFile& file, double scale);
FileSoup readPly(const MappedFile& file, double scale);

// Concatenates pieces in order, gives triangles their part and welds. Frees the pieces as it goes.
FileSoup joinPieces(const MappedFile& file, std::vector<StlPiece>& pieces);

// Gives the surface those of the points that it uses. Others would count in checks and take memory, and only among them can there be NaN.
// Segments and free points that are no numbers go with them.
void keepUsedPoints(std::vector<Vec3>& points, Surface& surface);

bool looksLikeAsciiStl(std::string_view bytes);
bool looksLikeBinaryStl(std::string_view bytes); // the header's count fits the size exactly
bool looksLikeObj(std::string_view bytes);
bool looksLikeNastran(std::string_view bytes);
bool looksLikePly(std::string_view bytes);

} // namespace i2b
