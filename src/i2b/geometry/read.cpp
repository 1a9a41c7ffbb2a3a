#include "i2b/geometry/read.h"
#include "i2b/core/error.h"
#include "i2b/core/parallel.h"
#include "i2b/geometry/file_soup.h"
#include "i2b/geometry/part_names.h"
#include "i2b/geometry/text_scan.h"
#include <algorithm>
#include <cmath>
#include <exception>
#include <filesystem>
#include <fmt/format.h>
#include <unordered_map>

namespace i2b {
namespace {

// "wheel.STL.gz" -> ".stl"
std::string extensionOf(const std::string& path) {
    std::filesystem::path file(path);
    if (text::equalsNoCase(file.extension().string(), ".gz")) file = file.stem();
    std::string extension = file.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(), text::lower);
    return extension;
}

bool isText(std::string_view bytes) {
    const std::string_view head = bytes.substr(0, 4096);
    return std::none_of(head.begin(), head.end(),
                        [](char c) { return static_cast<unsigned char>(c) < 32 && !text::isBlank(c); });
}

// Content decides; the name only where the content does not.
FileSoup readByContent(const MappedFile& file, double scale) {
    const std::string_view bytes = file.bytes();
    const std::string extension = extensionOf(file.path());
    if (looksLikePly(bytes)) return readPly(file, scale);
    if (looksLikeBinaryStl(bytes)) return readStlBinary(file, scale);
    if (looksLikeAsciiStl(bytes)) return readStlAscii(file, scale);
    if (looksLikeObj(bytes)) return readObj(file, scale);
    if (looksLikeNastran(bytes)) return readNastran(file, scale);
    const bool stlName = extension == ".stl" || extension == ".stlb";
    if (stlName && !isText(bytes)) return readStlBinary(file, scale);
    if (extension == ".obj" && isText(bytes))
        throw Error(ErrorKind::input, "the OBJ file has no statement that makes geometry", file.path(),
                    "export it again");
    throw Error(ErrorKind::input, fmt::format("the file ({} bytes) is neither STL, OBJ, PLY nor Nastran", bytes.size()),
                file.path(), "export the geometry as STL, OBJ, PLY or Nastran shells");
}

FileSoup readFile(const std::string& path, double scale) {
    const MappedFile file(path);
    FileSoup soup = readByContent(file, scale);
    const Surface& s = soup.surface;
    if (s.triangles.empty() && s.segments.empty() && s.freePoints.empty()) {
        const std::uint64_t left = soup.notes.notNumbers + soup.notes.coincident;
        throw Error(ErrorKind::input,
                    left == 0 ? "the file has no triangles"
                              : fmt::format("the file has no usable triangles, {} were left out", left),
                    path, "export it again");
    }
    return soup;
}

std::string plural(std::uint64_t n, const char* what) {
    return fmt::format("{} {}{}", n, what, n == 1 ? "" : "s");
}

void takeNotes(const std::string& path, const GeometryNotes& from, GeometryNotes& to) {
    to.messages.insert(to.messages.end(), from.messages.begin(), from.messages.end());
    if (from.coincident > 0)
        to.messages.push_back(fmt::format("{}: {} with all corners at one place left out", path,
                                          plural(from.coincident, "triangle")));
    if (from.zeroArea > 0)
        to.messages.push_back(
            fmt::format("{}: {} without area kept", path, plural(from.zeroArea, "triangle")));
    if (from.emptyParts > 0)
        to.messages.push_back(
            fmt::format("{}: {} without triangles left out", path, plural(from.emptyParts, "solid")));
    to.notNumbers += from.notNumbers;
    to.coincident += from.coincident;
    to.zeroArea += from.zeroArea;
    to.emptyParts += from.emptyParts;
}

// Frees the soup on return.
void append(FileSoup from, Surface& to) {
    Surface& s = from.surface;
    if (to.points.size() + s.points.size() >= ~std::uint32_t{0})
        throw Error(ErrorKind::input, "the files together have more points than 32 bits count", "",
                    "leave some of them out");
    const auto point = static_cast<std::uint32_t>(to.points.size());
    const auto part = static_cast<std::int32_t>(to.parts.size());
    const std::size_t triangle = to.triangles.size();
    to.points.insert(to.points.end(), s.points.begin(), s.points.end());
    to.triangles.resize(triangle + s.triangles.size());
    to.partOf.resize(to.triangles.size());
    parallelFor(
        s.triangles.size(),
        [&](std::size_t t) {
            for (std::size_t k = 0; k < 3; ++k) to.triangles[triangle + t][k] = s.triangles[t][k] + point;
            to.partOf[triangle + t] = s.partOf[t] + part;
        },
        1 << 14);
    for (const FreeSegment& f : s.segments) to.segments.push_back({f.a + point, f.b + point, f.part + part});
    for (const std::uint32_t v : s.freePoints) to.freePoints.push_back(v + point);
    to.parts.insert(to.parts.end(), s.parts.begin(), s.parts.end());
}

// A name that says nothing gives way to the file's where it is the only one in the file or comes again there.
void nameParts(std::vector<Part>& parts, GeometryNotes& notes) {
    std::unordered_map<std::string, std::size_t> inFile, equalInFile;
    const auto key = [](const Part& part) { return part.file + '\n' + part.name; };
    for (const Part& part : parts) ++inFile[part.file], ++equalInFile[key(part)];
    std::vector<std::string> names;
    for (const Part& part : parts) {
        std::string name = toWord(part.name);
        const bool alone = inFile[part.file] == 1, again = equalInFile[key(part)] > 1;
        if (name.empty() || ((alone || again) && isUninformative(part.name))) name = stemOf(part.file);
        names.push_back(std::move(name));
    }
    makeUnique(names);
    for (std::size_t p = 0; p < parts.size(); ++p) {
        notes.renamedParts += parts[p].name != names[p];
        parts[p].name = std::move(names[p]);
    }
}

} // namespace

Surface readSurface(const std::vector<std::string>& files, double scale, GeometryNotes& notes) {
    if (files.empty()) throw Error(ErrorKind::usage, "no geometry file is named", "", "name at least one");
    if (!(std::isfinite(scale) && scale > 0))
        throw Error(ErrorKind::usage, fmt::format("the scale {} is not a positive number", scale), "",
                    "give metres per unit of the file, such as 0.001");
    // Inflating is serial, so files run side by side. Faults are kept, so that it is always the first file's
    // that is told.
    std::vector<FileSoup> soups(files.size());
    std::vector<std::exception_ptr> faults(files.size());
    parallelFor(
        files.size(),
        [&](std::size_t i) {
            try {
                soups[i] = readFile(files[i], scale);
            } catch (...) {
                faults[i] = std::current_exception();
            }
        },
        1);
    for (const std::exception_ptr& fault : faults)
        if (fault) std::rethrow_exception(fault);

    for (std::size_t i = 0; i < files.size(); ++i) takeNotes(files[i], soups[i].notes, notes);
    Surface surface = std::move(soups.front().surface);
    for (std::size_t i = 1; i < soups.size(); ++i) append(std::move(soups[i]), surface);
    if (surface.triangles.empty())
        throw Error(ErrorKind::input, "the geometry has lines or points but no triangles", files.front(),
                    "add the surface that they belong to");
    nameParts(surface.parts, notes);
    return surface;
}

} // namespace i2b
