// Proves, on every built-in geometry: what leaves generate() keeps to 65 degrees of non-orthogonality and a skewness of 4,
// no cell is wrong, no face breaks a limit of the mesh quality dictionary, and plain checkMesh has nothing to say; limits that the
// user sets are worked for, and those that no mesh reaches cost nothing but a word.
#include "i2b/geometry/write_stl.h"
#include "i2b/program/generate.h"
#include "i2b/samples/sample.h"
#include "pipeline/shape_run.h"
#include <filesystem>
#include <gtest/gtest.h>
#include <unistd.h>

namespace i2b::test {
namespace {

struct SampleCase {
    const char* name;
    double h;     // m, cells at the wall
    bool inside;
};

void PrintTo(const SampleCase& c, std::ostream* out) { *out << c.name; }

const SampleCase sampleCases[] = {{"box", 0.1, false},      {"sphere", 0.06, false},    {"missile", 0.1, false},
                                  {"tunnel", 0.03, true},   {"wing-body", 0.1, false}, {"engine", 0.04, false}};

class Samples : public testing::TestWithParam<SampleCase> {};

MeshResult meshOf(const SampleCase& c, const DictionaryLimits& limits = {}) {
    const std::filesystem::path file = std::filesystem::temp_directory_path() / ("i2b_sample_" + std::to_string(getpid()) + "_" + c.name + ".stl");
    writeStl(makeSample(c.name), file.string(), StlFormat::binary);
    Options options;
    options.geometry.files = {file.string()};
    options.size.surface = c.h;
    options.size.max = 8 * c.h;
    options.quality = limits;
    if (c.inside) options.domain.seeds = {{"", *sampleSeed(c.name, "inside")}};
    Context context;
    MeshResult result = generate(options, context);
    std::filesystem::remove(file);
    return result;
}

TEST_P(Samples, KeepToTheLimits) {
    const MeshResult result = meshOf(GetParam());
    const QualityReport& q = result.report.quality.value();
    EXPECT_EQ(result.mesh.validate(), "");
    EXPECT_LE(q.maxNonOrthogonality, 65);
    EXPECT_LE(q.maxSkewness, 4);
    EXPECT_EQ(q.negativeVolumeCells + q.wrongOrientedFaces + q.openCells, 0);
    EXPECT_EQ(plainFailures(q), "");
    for (const DictionaryCheck& check : q.dictionary) {
        if (check.asked) { EXPECT_EQ(check.faces, 0) << check.key; }
    }
    EXPECT_GT(q.cells, 500);
}

INSTANTIATE_TEST_SUITE_P(BuiltIn, Samples, testing::ValuesIn(sampleCases), [](const auto& info) {
    std::string name = info.param.name;
    std::erase(name, '-');
    return name;
});

TEST(SampleLimits, OfTheUserAreWorkedFor) {
    DictionaryLimits limits;
    EXPECT_GT(meshOf({"missile", 0.05, false}, limits).report.quality->maxNonOrthogonality, 52);
    limits.nonOrthogonality = 52;
    const QualityReport q = meshOf({"missile", 0.05, false}, limits).report.quality.value();
    EXPECT_LE(q.maxNonOrthogonality, 52);
    EXPECT_EQ(q.dictionaryFaces, 0);
}

// Else cells are merged without end, and what the mesh would keep to is lost with what it cannot.
TEST(SampleLimits, OutOfReachAreNotedOnly) {
    const SampleCase sphere{"sphere", 0.05, false};
    const MeshResult plain = meshOf(sphere);
    const struct {
        const char* option;
        double DictionaryLimits::*limit;
        double value;
    } cases[] = {{"max-non-orthogonality", &DictionaryLimits::nonOrthogonality, 1},   {"max-internal-skewness", &DictionaryLimits::internalSkewness, 0.01},
                 {"max-internal-skewness", &DictionaryLimits::internalSkewness, -1}, {"min-face-weight", &DictionaryLimits::faceWeight, 0.499},
                 {"min-volume-ratio", &DictionaryLimits::volumeRatio, 0.99},         {"min-determinant", &DictionaryLimits::determinant, 0.99},
                 {"min-tet-quality", &DictionaryLimits::tetQuality, 0.9},            {"min-face-area", &DictionaryLimits::faceArea, 1}};
    for (const auto& c : cases) {
        DictionaryLimits limits;
        limits.*c.limit = c.value;
        const MeshResult result = meshOf(sphere, limits);
        EXPECT_EQ(result.report.checksum, plain.report.checksum) << c.option;
        const std::vector<std::string>& notes = result.cartesian->notes.messages;
        ASSERT_EQ(std::ranges::count_if(notes, [&](const std::string& n) { return n.starts_with(c.option); }), 1) << c.option;
        EXPECT_GT(result.report.quality->dictionaryFaces, 1000) << c.option; // beyond what was asked
    }
}

// None may be added without a case here.
TEST(SampleTable, IsComplete) {
    const std::vector<std::string> names = sampleNames();
    for (const std::string& name : names)
        EXPECT_EQ(std::ranges::count_if(sampleCases, [&](const SampleCase& c) { return name == c.name; }), 1) << name;
}

} // namespace
} // namespace i2b::test
