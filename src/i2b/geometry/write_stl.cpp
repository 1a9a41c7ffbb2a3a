#include "i2b/geometry/write_stl.h"
#include "i2b/core/error.h"
#include "i2b/core/parallel.h"
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fmt/format.h>
#include <functional>
#include <iterator>
#include <numeric>
#include <span>
#include <unistd.h>

namespace i2b {
namespace {

// A file under another name until commit(); removed if that never comes.
class PendingFile {
  public:
    explicit PendingFile(const std::string& path)
        : path_(path), pending_(fmt::format("{}.{}.part", path, ::getpid())),
          file_(std::fopen(pending_.c_str(), "wb")) {
        if (!file_) fail();
    }
    ~PendingFile() {
        if (file_) std::fclose(file_);
        if (!committed_) std::remove(pending_.c_str());
    }
    PendingFile(const PendingFile&) = delete;
    PendingFile& operator=(const PendingFile&) = delete;

    void write(std::string_view bytes) {
        if (std::fwrite(bytes.data(), 1, bytes.size(), file_) != bytes.size()) fail();
    }
    void commit() {
        std::FILE* const file = file_;
        file_ = nullptr;
        if (std::fclose(file) != 0 || std::rename(pending_.c_str(), path_.c_str()) != 0) fail();
        committed_ = true;
    }

  private:
    [[noreturn]] void fail() {
        const int error = errno;
        if (file_) std::fclose(file_);
        file_ = nullptr;
        std::remove(pending_.c_str());
        throw Error(ErrorKind::input, fmt::format("the STL file cannot be written, {}", std::strerror(error)),
                    path_, "check the folder and the room on the disk");
    }
    std::string path_, pending_;
    std::FILE* file_;
    bool committed_ = false;
};

// Triangles part by part, in order within each; first[p] is where part p begins, first.back() the end.
struct ByPart {
    std::vector<std::size_t> order, first;
    std::span<const std::size_t> of(std::size_t part) const {
        return std::span(order).subspan(first[part], first[part + 1] - first[part]);
    }
};

ByPart byPart(const Surface& s) {
    ByPart result;
    result.first.resize(s.parts.size() + 1);
    for (const std::int32_t p : s.partOf) ++result.first[static_cast<std::size_t>(p)];
    exclusiveScan(result.first);
    std::vector<std::size_t> next = result.first;
    result.order.resize(s.triangles.size());
    for (std::size_t t = 0; t < s.triangles.size(); ++t)
        result.order[next[static_cast<std::size_t>(s.partOf[t])]++] = t;
    return result;
}

Vec3 normalOf(const Surface& s, std::size_t t) {
    const auto& v = s.triangles[t];
    return normalized(cross(s.points[v[1]] - s.points[v[0]], s.points[v[2]] - s.points[v[0]]));
}

void appendAscii(const Surface& s, std::size_t t, std::string& text) {
    const auto out = std::back_inserter(text);
    const Vec3 n = normalOf(s, t);
    fmt::format_to(out, "facet normal {:.6g} {:.6g} {:.6g}\n outer loop\n", n.x, n.y, n.z);
    for (const std::uint32_t v : s.triangles[t]) { // as many digits as bring the same double back
        const Vec3& p = s.points[v];
        fmt::format_to(out, "  vertex {} {} {}\n", p.x, p.y, p.z);
    }
    text += " endloop\nendfacet\n";
}

void appendBinary(const Surface& s, std::size_t t, std::string& bytes) {
    std::array<float, 12> values;
    const auto put = [&](std::size_t at, const Vec3& p) {
        for (int i = 0; i < 3; ++i) values[at + static_cast<std::size_t>(i)] = static_cast<float>(p[i]);
    };
    put(0, normalOf(s, t));
    for (std::size_t k = 0; k < 3; ++k) put(3 + 3 * k, s.points[s.triangles[t][k]]);
    bytes.append(reinterpret_cast<const char*>(values.data()), sizeof values);
    bytes.append(2, '\0');
}

// Formats on all cores, a batch of chunks at a time so that the text never stands whole in memory.
template <class Append>
void writeTriangles(PendingFile& file, const Surface& s, std::span<const std::size_t> order,
                    const Append& append) {
    constexpr std::size_t chunk = 4096, batch = 64 * chunk;
    std::array<std::string, 64> texts;
    for (std::size_t begin = 0; begin < order.size(); begin += batch) {
        const std::size_t n = std::min(batch, order.size() - begin);
        parallelChunks(n, chunk, [&](std::size_t from, std::size_t to, std::size_t c) {
            texts[c].clear();
            for (std::size_t i = from; i != to; ++i) append(s, order[begin + i], texts[c]);
        });
        for (std::size_t c = 0; c * chunk < n; ++c) file.write(texts[c]);
    }
}

void writeAsciiSolid(PendingFile& file, const Surface& s, const std::string& name,
                     std::span<const std::size_t> order) {
    file.write("solid " + name + "\n");
    writeTriangles(file, s, order, appendAscii);
    file.write("endsolid " + name + "\n");
}

// The header must not begin with "solid", by which readers know ASCII files.
void writeBinarySolid(PendingFile& file, const Surface& s, const std::string& name,
                      std::span<const std::size_t> order) {
    std::string header = ("binary STL, m: " + name).substr(0, 80);
    header.resize(80, '\0');
    const auto count = static_cast<std::uint32_t>(order.size());
    header.append(reinterpret_cast<const char*>(&count), sizeof count);
    file.write(header);
    writeTriangles(file, s, order, appendBinary);
}

void checkCount(std::size_t triangles, const std::string& path, StlFormat format) {
    if (format == StlFormat::binary && triangles > ~std::uint32_t{0})
        throw Error(ErrorKind::input, fmt::format("{} triangles are more than binary STL counts", triangles),
                    path, "write ASCII or one file a part");
}

} // namespace

void writeStl(const Surface& surface, const std::string& path, StlFormat format) {
    checkCount(surface.triangles.size(), path, format);
    PendingFile file(path);
    if (format == StlFormat::ascii) {
        const ByPart parts = byPart(surface);
        for (std::size_t p = 0; p < surface.parts.size(); ++p)
            if (!parts.of(p).empty()) writeAsciiSolid(file, surface, surface.parts[p].name, parts.of(p));
    } else {
        std::vector<std::size_t> order(surface.triangles.size());
        std::iota(order.begin(), order.end(), std::size_t{0});
        writeBinarySolid(file, surface, surface.parts.size() == 1 ? surface.parts[0].name : "all parts",
                         order);
    }
    file.commit();
}

std::vector<std::string> writeStlFolder(const Surface& surface, const std::string& folder, StlFormat format) {
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (error)
        throw Error(ErrorKind::input, fmt::format("the folder cannot be made, {}", error.message()), folder,
                    "check the path");
    const ByPart parts = byPart(surface);
    std::vector<std::string> paths;
    for (std::size_t p = 0; p < surface.parts.size(); ++p) {
        if (parts.of(p).empty()) continue;
        const std::string path = (std::filesystem::path(folder) / (surface.parts[p].name + ".stl")).string();
        checkCount(parts.of(p).size(), path, format);
        PendingFile file(path);
        const auto write = format == StlFormat::ascii ? writeAsciiSolid : writeBinarySolid;
        write(file, surface, surface.parts[p].name, parts.of(p));
        file.commit();
        paths.push_back(path);
    }
    return paths;
}

} // namespace i2b
