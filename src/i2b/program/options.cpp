#include "i2b/program/options.h"
#include "i2b/core/error.h"
#include "i2b/layers/layer_plan.h"
#include "i2b/program/entries.h"
#include <fmt/format.h>
#include <regex>

namespace i2b {
namespace {

const std::vector<std::string> knownFormats{"openfoam", "vtu", "ply", "vdb", "report"};

struct Checker {
    std::vector<Problem> problems;

    // Not-a-number fails every range.
    void within(const char* key, double value, double lo, double hi) {
        if (!(value >= lo && value <= hi))
            problems.push_back(
                {key, fmt::format("{} is {}", key, value), fmt::format("give {} to {}", lo, hi)});
    }
    void length(const char* key, double value, const char* zero) {
        if (!(value >= 0 && std::isfinite(value)))
            problems.push_back({key, fmt::format("{} is {} m", key, value),
                                fmt::format("give a positive length in metres, or 0: {}", zero)});
    }
    void add(const char* key, std::string text, std::string remedy) {
        problems.push_back({key, std::move(text), std::move(remedy)});
    }
};

bool hasVolume(const Box& box) {
    return isFinite(box.lo) && isFinite(box.hi) && box.lo.x < box.hi.x && box.lo.y < box.hi.y &&
           box.lo.z < box.hi.z;
}

void checkGeometry(const GeometryOptions& geometry, Checker& check) {
    if (geometry.files.empty()) check.add("geometry", "no geometry is given", "name at least one file");
    if (!(geometry.scale > 0 && std::isfinite(geometry.scale)))
        check.add("scale", fmt::format("scale is {}", geometry.scale),
                  "give metres per unit of the files, for example 0.001 for millimetres");
}

void checkName(const char* key, const std::string& part, Checker& check) {
    try {
        std::regex(part, std::regex::ECMAScript);
    } catch (const std::regex_error&) {
        check.add(key, fmt::format("'{}' is no regular expression", part),
                  "write the part's whole name, or an expression such as wheel.*");
    }
}

void checkFeatures(const GeometryOptions& geometry, Checker& check) {
    check.within("feature-angle", geometry.featureAngle, 0, 180);
    check.within("crease-angle", geometry.creaseAngle, 0, 180);
    for (const std::string& file : geometry.featureLines)
        if (file.empty()) check.add("feature-lines", "a file has no name", "name an OBJ file of lines");
    for (const std::string& part : geometry.featureParts) checkName("feature-part", part, check);
    for (const FeatureBox& box : geometry.featureBoxes)
        if (!hasVolume(box.box)) check.add("feature-box", "the box has no volume", "give the lower corner first");
}

bool isSize(const Vec3& size) { return isFinite(size) && size.x > 0 && size.y > 0 && size.z > 0; }
double smallest(const Vec3& size) { return std::min(size.x, std::min(size.y, size.z)); }

// The size and the name of the part that an entry of any list has, if it has them.
template <class T>
void checkItem(const char* key, const T& item, Checker& check) {
    if (!isSize(item.size))
        check.add(key, fmt::format("the size is {} m", smallest(item.size)), "give a positive length in metres");
    if constexpr (requires { item.part; }) checkName(key, item.part, check);
    if constexpr (requires { item.radius; })
        if (!(item.radius > 0 && std::isfinite(item.radius)))
            check.add(key, fmt::format("the radius is {} m", item.radius), "give a positive length in metres");
    if constexpr (requires { item.from; })
        if (!isFinite(item.from) || !isFinite(item.to) || item.from == item.to)
            check.add(key, "the two ends are no segment", "give two different places");
}

void checkPlaces(const SizeOptions& size, Checker& check) {
    for (const PartSize& part : size.parts) checkItem("part-size", part, check);
    for (const BoxSize& box : size.boxes) {
        checkItem("box-size", box, check);
        if (!hasVolume(box.box)) check.add("box-size", "the box has no volume", "give the lower corner first");
    }
    for (const SphereSize& sphere : size.spheres) {
        checkItem("sphere-size", sphere, check);
        if (!isFinite(sphere.centre)) check.add("sphere-size", "the centre is not finite", "give metres");
    }
    for (const CylinderSize& cylinder : size.cylinders) checkItem("cylinder-size", cylinder, check);
    for (const BandSize& band : size.bands) {
        checkItem("band-size", band, check);
        if (!(band.distance > 0 && std::isfinite(band.distance)))
            check.add("band-size", fmt::format("the distance is {} m", band.distance),
                      "give a positive length in metres");
    }
    for (const PointSize& point : size.points) {
        checkItem("point-size", point, check);
        if (!isFinite(point.place)) check.add("point-size", "the place is not finite", "give metres");
    }
    for (const SegmentSize& segment : size.segments) checkItem("segment-size", segment, check);
    for (const LineSize& line : size.lines) {
        checkItem("line-size", line, check);
        if (!isFinite(line.through) || !isFinite(line.direction) || !(norm(line.direction) > 0))
            check.add("line-size", "the direction has no length", "give a place and a direction");
    }
}

void checkSizes(const SizeOptions& size, Checker& check) {
    if (size.surface == 0)
        check.add("size", "size is missing",
                  "give the largest cell on the geometry in metres; a hundredth of its length is a first try "
                  "(i2b inspect prints the extent)");
    else if (!(size.surface > 0 && std::isfinite(size.surface)))
        check.add("size", fmt::format("size is {} m", size.surface), "give a positive length in metres");
    check.length("max-size", size.max, "from the extent of the domain");
    check.length("min-size", size.min, "half of size");
    if (size.max > 0 && size.max < size.surface)
        check.add("max-size", fmt::format("max-size, {} m, is below size, {} m", size.max, size.surface),
                  "give at least size, or 0: from the extent of the domain");
    if (size.min > size.surface && size.surface > 0)
        check.add("min-size", fmt::format("min-size, {} m, is above size, {} m", size.min, size.surface),
                  "give at most size, or 0: half of size");
    checkPlaces(size, check);
    check.within("curvature", size.curvature, 0, 10000);
    check.within("gap-cells", size.gapCells, 0, 100);
    check.within("buffer-cells", size.bufferCells, 1, 64);
}

void checkDomain(const DomainOptions& domain, Checker& check) {
    if (domain.box && !hasVolume(*domain.box))
        check.add("box", "the box has no volume", "give the lower corner first: x0 y0 z0 x1 y1 z1");
    if (domain.flow != Flow::automatic && !domain.seeds.empty())
        check.add("seed", "seeds and external or internal exclude each other", "give one of the two");
    const auto checkSeeds = [&](const char* key, const char* what, const std::vector<Seed>& places) {
        for (const Seed& seed : places) {
            const std::string place = fmt::format("the {} at {}, {}, {}", what, seed.place.x, seed.place.y, seed.place.z);
            if (!isFinite(seed.place))
                check.add(key, place + " is not finite", "give metres");
            else if (domain.box && !domain.box->contains(seed.place))
                check.add(key, place + " lies outside the box", "move it or enlarge the box");
        }
    };
    checkSeeds("seed", "seed", domain.seeds);
    checkSeeds("keep-out", "place to keep out of", domain.keepOut);
}

// The flow past the plate that y-plus is taken from.
void checkPlate(const LayerOptions& layers, Checker& check) {
    constexpr double leastReynolds = 1e3; // where the fit has long lost its meaning
    const bool any = layers.yPlus > 0 || layers.velocity > 0 || layers.viscosity > 0 || layers.length > 0;
    const bool all = layers.yPlus > 0 && layers.velocity > 0 && layers.viscosity > 0 && layers.length > 0;
    if (any && !all) check.add("y-plus", "y-plus, velocity, viscosity and length belong together", "give all four, or none");
    if (!all) return;
    if (layers.first > 0) check.add("y-plus", "y-plus and first-layer exclude each other", "give one of the two");
    if (layers.unit == LayerUnit::cell) check.add("y-plus", "y-plus gives metres where layer-unit is cell", "give layer-unit m");
    const double reynolds = layers.velocity * layers.length / layers.viscosity;
    if (!(reynolds >= leastReynolds && std::isfinite(reynolds)))
        check.add("y-plus", fmt::format("the Reynolds number is {:.3g}, too low for a turbulent wall", reynolds),
                  "check velocity, viscosity and length");
}

void checkPartLayers(const PartLayers& part, Checker& check) {
    checkName("part-layers", part.part, check);
    const auto spoilt = [&](const std::string& what, const char* remedy) {
        check.add("part-layers", fmt::format("of '{}' {}", part.part, what), remedy);
    };
    if (part.count < 0 || part.count > maxLayers) spoilt(fmt::format("the count is {}", part.count), "give 0 (none) to 100 layers");
    for (const auto& [name, height] : {std::pair("first", part.first), std::pair("thickness", part.thickness)})
        if (!(height >= 0 && std::isfinite(height)))
            spoilt(fmt::format("{} is {}", name, height), "give a positive length in layer-unit, or 0: as for all walls");
    if (part.growth != 0 && !(part.growth >= leastGrowth && part.growth <= mostGrowth))
        spoilt(fmt::format("growth is {}", part.growth), "give 0.5 to 4, or 0: as for all walls");
}

void checkLayers(const LayerOptions& layers, Checker& check) {
    const std::size_t before = check.problems.size();
    check.within("layers", layers.count, 0, maxLayers);
    check.length("first-layer", layers.first, "from layer-thickness, else from the room");
    check.length("layer-thickness", layers.thickness, "from first-layer, else all the room");
    if (layers.growth != 0) check.within("growth", layers.growth, leastGrowth, mostGrowth);
    for (const PartLayers& part : layers.parts) checkPartLayers(part, check);
    const std::pair<const char*, double> figures[] = {
        {"y-plus", layers.yPlus}, {"velocity", layers.velocity}, {"viscosity", layers.viscosity}, {"length", layers.length}};
    for (const auto& [key, value] : figures)
        if (!(value >= 0 && std::isfinite(value))) check.add(key, fmt::format("{} is {}", key, value), "give a positive number, or 0: not given");
    if (check.problems.size() > before) return; // what follows needs figures that make sense
    checkPlate(layers, check);
    if (check.problems.size() > before) return;
    const char* const remedy = "give two of first height, thickness and growth";
    if (const std::string fault = faultOf(requestOf(layers)); !fault.empty())
        return check.add(layers.growth > 0 ? "growth" : "layer-thickness", fault, remedy);
    for (const PartLayers& part : layers.parts)
        if (const std::string fault = faultOf(requestOf(layers, part)); !fault.empty())
            check.add("part-layers", fmt::format("of '{}' {}", part.part, fault), remedy);
}

// Within OpenFOAM's own ranges; values that mean "not asked" lie at or beyond their ends.
void checkQuality(const DictionaryLimits& quality, Checker& check) {
    constexpr double any = 1e300;
    check.within("max-non-orthogonality", quality.nonOrthogonality, 0, 180);
    check.within("min-pyramid-volume", quality.pyramidVolume, -any, any);
    check.within("min-tet-quality", quality.tetQuality, -any, 1);
    check.within("max-concavity", quality.concavity, 0, 180);
    check.within("min-face-area", quality.faceArea, -any, any);
    check.within("max-internal-skewness", quality.internalSkewness, -any, any);
    check.within("max-boundary-skewness", quality.boundarySkewness, -any, any);
    check.within("min-face-weight", quality.faceWeight, -any, 1);
    check.within("min-volume-ratio", quality.volumeRatio, -any, 1);
    check.within("min-twist", quality.twist, -1, 1);
    check.within("min-triangle-twist", quality.triangleTwist, -1, 1);
    check.within("min-flatness", quality.flatness, -1, 1);
    check.within("min-determinant", quality.determinant, -any, any);
}

void checkOutput(const OutputOptions& output, Checker& check) {
    if (output.folder.empty()) check.add("out", "out is empty", "name a folder");
    for (const std::string& format : output.formats)
        if (std::ranges::find(knownFormats, format) == knownFormats.end())
            check.add("format", fmt::format("'{}' is no format", format),
                      fmt::format("choose from {}", fmt::join(knownFormats, ", ")));
}

} // namespace

std::vector<Problem> validate(const Options& options) {
    Checker check;
    checkGeometry(options.geometry, check);
    checkSizes(options.size, check);
    checkDomain(options.domain, check);
    checkFeatures(options.geometry, check);
    check.within("clearance", options.fit.clearance, 0, 1);
    check.within("sweeps", options.fit.sweeps, 0, 100);
    check.within("fit-seconds", options.fit.seconds, 0, 1e6);
    checkLayers(options.layers, check);
    checkQuality(options.quality, check);
    checkOutput(options.output, check);
    check.within("threads", options.threads, 0, 4096);
    return check.problems;
}

void requireValid(const Case& given) {
    const std::vector<Problem> problems = validate(given.options);
    if (problems.empty()) return;
    const auto place = [&](const std::string& key) {
        const auto line = given.lines.find(key);
        if (line != given.lines.end()) return fmt::format("{}:{}, key {}", given.file, line->second, key);
        return key == "geometry" ? std::string("command line") : "--" + key;
    };
    // The first problem is the error; the others follow in its remedy, so that one run names them all.
    std::string remedy = problems.front().remedy;
    for (std::size_t i = 1; i < problems.size(); ++i)
        remedy += fmt::format("\n{} ({}): {}", problems[i].text, place(problems[i].key), problems[i].remedy);
    throw Error(ErrorKind::usage, problems.front().text, place(problems.front().key), remedy);
}

} // namespace i2b
