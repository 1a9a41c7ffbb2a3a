#include "i2b/samples/sample.h"
#include "i2b/core/error.h"
#include "i2b/samples/parts.h"
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace i2b {
namespace {

struct Entry {
    const char* name;
    samples::Parts (*make)(const samples::Make&);
};
constexpr Entry entries[] = {{"engine", samples::engineParts},
                             {"missile", samples::missileParts},
                             {"wing-body", samples::wingBodyParts},
                             {"tunnel", samples::tunnelParts},
                             {"box", samples::boxParts},
                             {"sphere", samples::sphereParts}};

Surface surfaceOf(const samples::Parts& parts, const std::string& file) {
    Surface surface;
    for (const samples::NamedPart& part : parts) {
        const auto base = std::uint32_t(surface.points.size());
        const auto id = std::int32_t(surface.parts.size());
        surface.points.insert(surface.points.end(), part.mesh.points.begin(), part.mesh.points.end());
        for (const auto& t : part.mesh.triangles)
            surface.triangles.push_back({t[0] + base, t[1] + base, t[2] + base});
        surface.partOf.resize(surface.triangles.size(), id);
        surface.parts.push_back({part.name, file, part.mesh.triangles.size()});
    }
    return surface;
}

} // namespace

std::vector<std::string> sampleNames() {
    std::vector<std::string> names;
    for (const Entry& e : entries) names.push_back(e.name);
    return names;
}

Surface makeSample(const std::string& name, const SampleOptions& options) {
    if (!(options.dirt >= 0 && options.dirt <= 100))
        throw Error(ErrorKind::usage, fmt::format("dirt {} is not between 0 and 100", options.dirt),
                    "sample " + name, "0 is clean, 1 the usual dirt");
    if (options.resolution < 1 || options.resolution > 8)
        throw Error(ErrorKind::usage, fmt::format("resolution {} is not between 1 and 8", options.resolution),
                    "sample " + name, "1 is the usual one");
    for (const Entry& e : entries)
        if (name == e.name) return surfaceOf(e.make({options.dirt, options.resolution}), "built-in:" + name);
    throw Error(ErrorKind::usage, fmt::format("there is no sample called '{}'", name), "sample",
                fmt::format("take one of {}", fmt::join(sampleNames(), ", ")));
}

std::optional<Vec3> sampleSeed(const std::string& name, const std::string& region) {
    // Beside the first cylinder, in the middle of the jacket's width.
    if (name == "engine" && region == "jacket") return Vec3{samples::engine::cylinder(0), 0.053, 0.40};
    if (name == "tunnel" && region == "inside") return Vec3{1.0, 0, 0.15};
    return std::nullopt;
}

} // namespace i2b
