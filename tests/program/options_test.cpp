#include "i2b/core/error.h"
#include "i2b/program/options.h"
#include <cmath>
#include <gmock/gmock.h>
#include <limits>

namespace i2b {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

Options good() {
    Options options;
    options.geometry.files = {"body.stl"};
    options.size.surface = 0.01;
    return options;
}

void setPlate(Options& o) { o.layers.yPlus = 30, o.layers.velocity = 40, o.layers.viscosity = 1.5e-5, o.layers.length = 4.6; }

std::vector<std::string> keys(const Options& options) {
    std::vector<std::string> found;
    for (const Problem& problem : validate(options)) {
        EXPECT_FALSE(problem.text.empty());
        EXPECT_FALSE(problem.remedy.empty()) << problem.key;
        found.push_back(problem.key);
    }
    return found;
}

// One number and a file are enough: every default is acceptable.
TEST(Validate, FileAndSizeSuffice) { EXPECT_THAT(keys(good()), IsEmpty()); }

// Each broken option is found, alone, under its own key.
TEST(Validate, NamesEachBrokenOption) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const std::vector<std::pair<std::string, void (*)(Options&)>> cases{
        {"geometry", [](Options& o) { o.geometry.files.clear(); }},
        {"scale", [](Options& o) { o.geometry.scale = 0; }},
        {"scale", [](Options& o) { o.geometry.scale = -1; }},
        {"feature-angle", [](Options& o) { o.geometry.featureAngle = 181; }},
        {"crease-angle", [](Options& o) { o.geometry.creaseAngle = -1; }},
        {"feature-lines", [](Options& o) { o.geometry.featureLines = {""}; }},
        {"feature-part", [](Options& o) { o.geometry.featureParts = {"wheel", "wheel("}; }},
        {"feature-box", [](Options& o) { o.geometry.featureBoxes = {{{{0, 0, 0}, {1, 1, 0}}, BoxEdges::all}}; }},
        {"size", [](Options& o) { o.size.surface = 0; }},
        {"size", [](Options& o) { o.size.surface = -1; }},
        {"max-size", [](Options& o) { o.size.max = 0.005; }},
        {"max-size", [](Options& o) { o.size.max = -1; }},
        {"min-size", [](Options& o) { o.size.min = 0.02; }},
        {"part-size",
         [](Options& o) {
             o.size.parts = {{"wheel", sameSize(0)}};
         }},
        {"part-size",
         [](Options& o) {
             o.size.parts = {{"wheel(", sameSize(0.01)}};
         }},
        {"box-size",
         [](Options& o) {
             o.size.boxes = {{{{0, 0, 0}, {1, 1, 0}}, sameSize(0.1)}};
         }},
        {"box-size",
         [](Options& o) {
             o.size.boxes = {{{{0, 0, 0}, {1, 1, 1}}, sameSize(0)}};
         }},
        {"sphere-size", [](Options& o) { o.size.spheres = {{{0, 0, 0}, 0, sameSize(1)}}; }},
        {"cylinder-size", [](Options& o) { o.size.cylinders = {{{0, 0, 0}, {0, 0, 0}, 1, sameSize(1)}}; }},
        {"band-size", [](Options& o) { o.size.bands = {{"a", 0, sameSize(1)}}; }},
        {"band-size", [](Options& o) { o.size.bands = {{"a(", 1, sameSize(1)}}; }},
        {"point-size", [](Options& o) { o.size.points = {{{0, 0, 0}, {1, 1, 0}}}; }},
        {"segment-size", [](Options& o) { o.size.segments = {{{0, 0, 0}, {0, 0, 0}, sameSize(1)}}; }},
        {"line-size", [](Options& o) { o.size.lines = {{{0, 0, 0}, {0, 0, 0}, sameSize(1)}}; }},
        {"curvature", [](Options& o) { o.size.curvature = -1; }},
        {"gap-cells", [](Options& o) { o.size.gapCells = -1; }},
        {"buffer-cells", [](Options& o) { o.size.bufferCells = 0; }},
        {"box",
         [](Options& o) {
             o.domain.box = Box{{0, 0, 0}, {1, -1, 1}};
         }},
        {"seed",
         [](Options& o) {
             o.domain.box = Box{{0, 0, 0}, {1, 1, 1}}, o.domain.seeds = {{"", {2, 0, 0}}};
         }},
        {"seed",
         [](Options& o) {
             o.domain.flow = Flow::external, o.domain.seeds = {{"", {2, 0, 0}}};
         }},
        {"keep-out",
         [](Options& o) {
             o.domain.box = Box{{0, 0, 0}, {1, 1, 1}}, o.domain.keepOut = {{"", {2, 0, 0}}};
         }},
        {"keep-out", [](Options& o) { o.domain.keepOut = {{"", {0, std::nan(""), 0}}}; }},
        {"clearance", [](Options& o) { o.fit.clearance = -0.1; }},
        {"sweeps", [](Options& o) { o.fit.sweeps = -1; }},
        {"fit-seconds", [](Options& o) { o.fit.seconds = -1; }},
        {"layers", [](Options& o) { o.layers.count = 101; }},
        {"first-layer", [](Options& o) { o.layers.first = -1; }},
        {"growth", [](Options& o) { o.layers.growth = 0.4; }},
        {"growth", [](Options& o) { o.layers.growth = 5; }},
        {"layer-thickness", [](Options& o) { o.layers.thickness = -1; }},
        {"growth", [](Options& o) { o.layers.count = 3, o.layers.first = 1, o.layers.thickness = 4, o.layers.growth = 1.2; }},
        {"layer-thickness", [](Options& o) { o.layers.count = 3, o.layers.first = 1, o.layers.thickness = 40; }},
        {"layer-thickness", [](Options& o) { o.layers.first = 1, o.layers.thickness = 2; }},
        {"part-layers", [](Options& o) { o.layers.parts = {{"a(", 1}}; }},
        {"part-layers", [](Options& o) { o.layers.parts = {{"a", 101}}; }},
        {"part-layers", [](Options& o) { o.layers.parts = {{"a", 1, -1}}; }},
        {"part-layers", [](Options& o) { o.layers.parts = {{"a", 1, 0, 0, 9}}; }},
        {"part-layers", [](Options& o) { o.layers.parts = {{"a", 3, 1, 4, 1.2}}; }},
        {"y-plus", [](Options& o) { o.layers.yPlus = -1; }},
        {"viscosity", [](Options& o) { o.layers.viscosity = -1; }},
        {"y-plus", [](Options& o) { o.layers.yPlus = 1; }},
        {"y-plus", [](Options& o) { o.layers.velocity = 40, o.layers.viscosity = 1.5e-5, o.layers.length = 1; }},
        {"y-plus", [](Options& o) { setPlate(o), o.layers.first = 1e-3; }},
        {"y-plus", [](Options& o) { setPlate(o), o.layers.unit = LayerUnit::cell; }},
        {"y-plus", [](Options& o) { setPlate(o), o.layers.viscosity = 1; }},
        {"max-non-orthogonality", [](Options& o) { o.quality.nonOrthogonality = 181; }},
        {"max-concavity", [](Options& o) { o.quality.concavity = -1; }},
        {"min-pyramid-volume", [](Options& o) { o.quality.pyramidVolume = std::nan(""); }},
        {"min-tet-quality", [](Options& o) { o.quality.tetQuality = 2; }},
        {"min-face-area", [](Options& o) { o.quality.faceArea = std::nan(""); }},
        {"max-internal-skewness", [](Options& o) { o.quality.internalSkewness = std::nan(""); }},
        {"max-boundary-skewness", [](Options& o) { o.quality.boundarySkewness = std::nan(""); }},
        {"min-face-weight", [](Options& o) { o.quality.faceWeight = 2; }},
        {"min-volume-ratio", [](Options& o) { o.quality.volumeRatio = 2; }},
        {"min-twist", [](Options& o) { o.quality.twist = -2; }},
        {"min-triangle-twist", [](Options& o) { o.quality.triangleTwist = 2; }},
        {"min-flatness", [](Options& o) { o.quality.flatness = 2; }},
        {"min-determinant", [](Options& o) { o.quality.determinant = std::nan(""); }},
        {"format", [](Options& o) { o.output.formats = {"vtk"}; }},
        {"out", [](Options& o) { o.output.folder.clear(); }},
        {"threads", [](Options& o) { o.threads = -1; }},
    };
    for (const auto& [key, spoil] : cases) {
        Options options = good();
        spoil(options);
        EXPECT_THAT(keys(options), ElementsAre(key));
    }
    Options options = good();
    options.layers.growth = options.size.surface = options.geometry.featureAngle = nan;
    EXPECT_THAT(keys(options), ElementsAre("size", "feature-angle", "growth"));
}

// Figures that do not contradict each other are taken, whichever of them are given.
TEST(Validate, TakesLayersGivenInAnyWay) {
    const std::vector<void (*)(Options&)> cases{
        [](Options& o) { o.layers = {5, 1e-3, 1.2}; },
        [](Options& o) { o.layers = {5, 1e-3, 0, 8e-3}; },
        [](Options& o) { o.layers = {5, 0, 1.2, 8e-3, LayerUnit::cell}; },
        [](Options& o) { o.layers = {3, 1, 1.2, 3.64}; },
        [](Options& o) { o.layers = {0, 1, 1.2, 99}; }, // no layers, no heights
        [](Options& o) { setPlate(o); },
        [](Options& o) { o.layers.first = 1e-3, o.layers.growth = 1.2, o.layers.parts = {{"a", 0}, {"b", 2, 0, 4e-3}, {"c", 2, 0, 0.01, 1.5}}; },
    };
    for (const auto& set : cases) {
        Options options = good();
        set(options);
        EXPECT_THAT(keys(options), IsEmpty());
    }
}

// The error names every problem at once, and where each key was set: line of the case file or option.
TEST(RequireValid, SaysWhereEachKeyWasSet) {
    Case given;
    given.options = good();
    given.options.size.surface = 0;
    given.options.layers.growth = 9;
    given.file = "car.toml";
    given.lines["growth"] = 7;
    try {
        requireValid(given);
        FAIL() << "accepted";
    } catch (const Error& error) {
        EXPECT_EQ(error.exitStatus(), 2);
        EXPECT_THAT(error.what(), HasSubstr("size is missing (--size): give"));
        EXPECT_THAT(error.what(), HasSubstr("car.toml:7, key growth"));
    }
}

} // namespace
} // namespace i2b
