#include "i2b/geometry/feature_lines.h"
#include "i2b/core/error.h"
#include "i2b/geometry/file_soup.h"
#include <fmt/format.h>

namespace i2b {
namespace {

constexpr std::uint32_t none = ~0u;

Surface readFile(const std::string& path, double scale, std::vector<std::string>& notes) {
    const MappedFile file(path);
    if (!looksLikeObj(file.bytes()))
        throw Error(ErrorKind::input, "the file of feature lines is no Wavefront OBJ", path,
                    "write points as v, lines as l and corners as p statements");
    Surface lines = readObj(file, scale).surface;
    if (lines.segments.empty() && lines.freePoints.empty())
        throw Error(ErrorKind::input, "the file of feature lines has neither lines nor points", path,
                    "write lines as l and corners as p statements, or leave the file out");
    if (!lines.triangles.empty())
        notes.push_back(fmt::format("{}: {} triangle{} beside the feature lines left out", path, lines.triangles.size(),
                                    lines.triangles.size() == 1 ? "" : "s"));
    return lines;
}

// Points that only triangles use stay behind.
void append(const Surface& from, FeatureLines& to) {
    std::vector<std::uint32_t> number(from.points.size(), none);
    const auto take = [&](std::uint32_t p) {
        if (number[p] == none) {
            number[p] = static_cast<std::uint32_t>(to.points.size());
            to.points.push_back(from.points[p]);
        }
        return number[p];
    };
    for (const FreeSegment& s : from.segments) {
        const std::uint32_t a = take(s.a), b = take(s.b);
        to.segments.push_back({a, b});
    }
    for (const std::uint32_t p : from.freePoints) to.corners.push_back(take(p));
}

} // namespace

FeatureLines readFeatureLines(const std::vector<std::string>& files, double scale, std::vector<std::string>& notes) {
    FeatureLines lines;
    for (const std::string& file : files) append(readFile(file, scale, notes), lines);
    return lines;
}

} // namespace i2b
