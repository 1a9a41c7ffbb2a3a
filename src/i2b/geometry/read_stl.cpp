// Binary STL: 80 bytes of anything, a 32-bit count, then 50 bytes a triangle (normal, three corners as float,
// 16 bits of anything), little-endian. Several such files in a row are several parts.
#include "i2b/core/error.h"
#include "i2b/core/parallel.h"
#include "i2b/geometry/file_soup.h"
#include "i2b/geometry/weld.h"
#include <bit>
#include <cstring>
#include <fmt/format.h>

namespace i2b {
namespace {

static_assert(std::endian::native == std::endian::little);
constexpr std::size_t headerBytes = 84, triangleBytes = 50, trianglesAPiece = 8192;

struct Stretch { // triangles of one solid in the file
    std::size_t firstByte = 0, triangles = 0;
    bool startsSolid = false;
};

std::uint64_t countAt(std::string_view bytes, std::size_t header) {
    std::uint32_t count = 0;
    std::memcpy(&count, bytes.data() + header + 80, 4);
    return count;
}

// Bytes a file of this header's count has.
std::uint64_t promisedBytes(std::string_view bytes, std::size_t header) {
    return headerBytes + triangleBytes * countAt(bytes, header);
}

// Several binary files in a row end exactly at the end of the file.
bool isChain(std::string_view bytes) {
    std::size_t at = 0;
    while (bytes.size() - at >= headerBytes) {
        const std::uint64_t size = promisedBytes(bytes, at);
        if (size > bytes.size() - at) return false;
        at += size;
    }
    return at == bytes.size();
}

void addSolid(std::vector<Stretch>& stretches, std::size_t firstByte, std::size_t triangles) {
    for (std::size_t t = 0; t < triangles || t == 0; t += trianglesAPiece)
        stretches.push_back(
            {firstByte + t * triangleBytes, std::min(trianglesAPiece, triangles - t), t == 0});
}

// The header's count is often wrong: programs that stream write 0 or -1 and never come back. Where whole
// triangles follow, the size decides; a count that promises more than there is means a truncated file.
std::vector<Stretch> layOut(const MappedFile& file, std::vector<std::string>& messages) {
    const std::string_view bytes = file.bytes();
    std::vector<Stretch> stretches;
    if (isChain(bytes)) {
        for (std::size_t at = 0; at < bytes.size(); at += promisedBytes(bytes, at))
            addSolid(stretches, at + headerBytes, countAt(bytes, at));
        return stretches;
    }
    const std::uint64_t promised = countAt(bytes, 0), body = bytes.size() - headerBytes;
    const std::uint64_t held = body / triangleBytes, rest = body % triangleBytes;
    const bool unset = promised == 0 || promised == 0xFFFFFFFFu;
    if (!unset && promised > held)
        throw Error(ErrorKind::input,
                    fmt::format("the STL file is truncated: {} triangles take {} bytes, it has {}", promised,
                                promisedBytes(bytes, 0), bytes.size()),
                    file.path(), "export or copy it again");
    if (unset && held > 0 && rest == 0) {
        messages.push_back(
            fmt::format("{}: the header says {} triangles; by its size the file has {}, all were read",
                        file.path(), promised, held));
        addSolid(stretches, headerBytes, held);
    } else if (!unset && rest == 0) {
        messages.push_back(
            fmt::format("{}: the header says {} triangles; by its size the file has {}, all were read",
                        file.path(), promised, held));
        addSolid(stretches, headerBytes, held);
    } else if (!unset) {
        messages.push_back(fmt::format("{}: {} bytes after its {} triangles were left out", file.path(),
                                       bytes.size() - promisedBytes(bytes, 0), promised));
        addSolid(stretches, headerBytes, promised);
    } else {
        throw Error(
            ErrorKind::input,
            fmt::format(
                "the STL file is truncated: its header says {} triangles and {} bytes are not a whole "
                "number of them ({} bytes expected for {})",
                promised, bytes.size(), headerBytes + triangleBytes * (held + 1), held + 1),
            file.path(), "export or copy it again");
    }
    return stretches;
}

StlPiece readStretch(const MappedFile& file, const Stretch& stretch, double scale) {
    StlPiece piece;
    if (stretch.startsSolid) piece.solids.push_back({});
    piece.triangles.reserve(stretch.triangles);
    piece.points.reserve(stretch.triangles); // a closed surface has half as many points as triangles
    PieceWelder welder(piece.points);
    for (std::size_t t = 0; t < stretch.triangles; ++t) {
        const std::size_t at = stretch.firstByte + t * triangleBytes;
        std::array<float, 9> v;
        std::memcpy(v.data(), file.bytes().data() + at + 12, sizeof v);
        std::array<Vec3, 3> p;
        for (std::size_t i = 0; i < 3; ++i)
            p[i] = {scale * double(v[3 * i]), scale * double(v[3 * i + 1]), scale * double(v[3 * i + 2])};
        const TriangleKind kind = kindOf(p[0], p[1], p[2]);
        if (kind == TriangleKind::notNumber && piece.notNumbers == 0) piece.firstNotNumber = at;
        if (isKept(kind, piece))
            piece.triangles.push_back({welder.add(p[0]), welder.add(p[1]), welder.add(p[2])});
    }
    piece.points.shrink_to_fit();
    file.release(stretch.firstByte, stretch.firstByte + stretch.triangles * triangleBytes);
    return piece;
}

// From 1, over the whole file.
std::uint64_t firstNotNumber(const std::vector<Stretch>& stretches, const std::vector<StlPiece>& pieces) {
    std::uint64_t before = 0;
    for (std::size_t i = 0; i < pieces.size(); before += stretches[i++].triangles)
        if (pieces[i].notNumbers > 0)
            return before + (pieces[i].firstNotNumber - stretches[i].firstByte) / triangleBytes + 1;
    return 0;
}

} // namespace

bool looksLikeBinaryStl(std::string_view bytes) { return bytes.size() > headerBytes && isChain(bytes); }

FileSoup readStlBinary(const MappedFile& file, double scale) {
    if (file.bytes().size() < headerBytes)
        throw Error(ErrorKind::input,
                    fmt::format("the STL file is truncated: a header takes {} bytes, it has {}", headerBytes,
                                file.bytes().size()),
                    file.path(), "export or copy it again");
    std::vector<std::string> messages;
    const std::vector<Stretch> stretches = layOut(file, messages);
    std::vector<StlPiece> pieces(stretches.size());
    parallelFor(
        stretches.size(), [&](std::size_t i) { pieces[i] = readStretch(file, stretches[i], scale); }, 1);
    const std::uint64_t firstBad = firstNotNumber(stretches, pieces);
    FileSoup soup = joinPieces(file, pieces);
    soup.notes.messages = std::move(messages);
    if (soup.notes.notNumbers > 0)
        soup.notes.messages.push_back(fmt::format("{}: {} triangles with coordinates that are not usable "
                                                  "numbers were left out, the first is triangle {}",
                                                  file.path(), soup.notes.notNumbers, firstBad));
    return soup;
}

} // namespace i2b
