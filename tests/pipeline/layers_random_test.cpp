// Proves, on hundreds of small cases of every kind of soup and every built-in geometry, over counts, heights, growths, units
// and rules for parts: no cell of layers is inside out and no face points the wrong way, whatever is asked for; every wall
// face has the layers asked for or the report says why not; where plain checkMesh fails for layers too thin, the summary
// says so.
#include "i2b/core/error.h"
#include "i2b/geometry/write_stl.h"
#include "i2b/layers/layer_plan.h"
#include "i2b/program/generate.h"
#include "i2b/program/print.h"
#include "i2b/samples/sample.h"
#include "pipeline/random_case.h"
#include "pipeline/shape_run.h"
#include <algorithm>
#include <filesystem>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <random>
#include <unistd.h>

namespace i2b::test {
namespace {

constexpr unsigned shards = 12, soupsPerShard = 18, samplesPerShard = 2;

struct BuiltIn {
    const char* name;
    double h; // m, cells at the wall
    bool inside;
};
const BuiltIn builtIns[] = {{"box", 0.2, false},   {"sphere", 0.12, false},    {"missile", 0.25, false},
                            {"tunnel", 0.06, true}, {"wing-body", 0.25, false}, {"engine", 0.15, false}};

class Dice { // the standard's distributions differ between libraries
  public:
    explicit Dice(unsigned seed) : random_(seed * 2246822519u + 99u) {}
    double real(double lo, double hi) { return lo + (hi - lo) * (static_cast<double>(random_()) / 4294967296.0); }
    int whole(int lo, int hi) { return lo + static_cast<int>(random_() % static_cast<unsigned>(hi - lo + 1)); }
    bool chance(double p) { return real(0, 1) < p; }

  private:
    std::mt19937 random_;
};

// Heights from several cells down to a hundred thousandth of one.
LayerOptions layersOf(Dice& dice, double h, const std::vector<Part>& parts) {
    LayerOptions o;
    o.count = dice.chance(0.04) ? dice.whole(13, 25) : dice.whole(1, 12);
    o.growth = dice.chance(0.2) ? 0 : dice.real(1, 1.6);
    if (dice.chance(0.2)) o.unit = LayerUnit::cell;
    const double unit = o.unit == LayerUnit::cell ? 1 : h;
    if (dice.chance(0.7)) o.first = unit * std::pow(10, dice.real(-5, -0.5));
    if (o.first == 0 && dice.chance(0.5)) o.thickness = unit * (dice.chance(0.5) ? dice.real(0.02, 1.5) : dice.real(1.5, 5));
    for (const Part& part : parts) {
        if (!dice.chance(0.3)) continue;
        PartLayers rule;
        rule.part = part.name, rule.count = dice.whole(0, 8);
        if (dice.chance(0.5)) rule.first = unit * std::pow(10, dice.real(-4, -1));
        else if (rule.count > 0 && dice.chance(0.3)) rule.thickness = unit * dice.real(0.1, 4);
        o.parts.push_back(rule);
    }
    return o;
}

std::string asked(const LayerOptions& o) {
    std::string text = fmt::format("{} layers, first {:g}, growth {:g}, thickness {:g}{}", o.count, o.first, o.growth, o.thickness,
                                   o.unit == LayerUnit::cell ? " cells" : "");
    for (const PartLayers& p : o.parts) text += fmt::format("; {}={},first={:g},thickness={:g}", p.part, p.count, p.first, p.thickness);
    return text;
}

// "" or what is wrong.
std::string faultOf(const MeshResult& r) {
    if (std::string fault = r.mesh.validate(); !fault.empty()) return fault;
    const QualityReport& q = *r.report.quality;
    if (q.negativeVolumeCells > 0) return fmt::format("{} negative volumes", q.negativeVolumeCells);
    if (q.wrongOrientedFaces > 0) return fmt::format("{} wrong oriented faces", q.wrongOrientedFaces);
    if (q.openCells > 0) return fmt::format("{} open cells", q.openCells);
    for (std::size_t f = 0; f < r.walls.asked.size(); ++f) {
        if (r.walls.achieved[f] < r.walls.asked[f] && r.walls.cause[f] == LayerCause::none)
            return fmt::format("wall face {} has {} of {} layers without a cause", f, r.walls.achieved[f], r.walls.asked[f]);
        if (r.walls.asked[f] > 0 && !(r.walls.first[f] > 0)) return fmt::format("wall face {} has no height", f);
    }
    std::int64_t faces = 0;
    for (const LayerRow& row : r.report.layers->parts) faces += row.faces;
    if (faces != r.report.wallFaces) return fmt::format("{} wall faces, {} in the report", r.report.wallFaces, faces);
    if (q.highAspectRatioCells > 0 && summaryText(r.report).find("aspect ratio over") == std::string::npos) return "thin cells are not named";
    return "";
}

// The fault of meshing a soup; cases that are refused as input have none, and are counted.
std::string meshFault(const Surface& soup, Options options, unsigned& refused) {
    static int count = 0;
    const std::filesystem::path file = std::filesystem::temp_directory_path() / fmt::format("i2b_layers_{}_{}.stl", getpid(), count++);
    options.geometry.files = {file.string()};
    std::string fault;
    try {
        writeStl(soup, file.string(), StlFormat::ascii);
        Context context;
        fault = faultOf(generate(options, context));
    } catch (const Error& e) {
        if (e.kind() == ErrorKind::input) {
            ++refused;
        } else {
            fault = e.problem();
        }
    }
    std::filesystem::remove(file);
    return fault;
}

class RandomLayers : public testing::TestWithParam<unsigned> {};

TEST_P(RandomLayers, AreRightOnSoups) {
    unsigned refused = 0;
    for (unsigned i = 0; i < soupsPerShard; ++i) {
        const unsigned seed = firstRandomCase() + GetParam() * soupsPerShard + i;
        RandomCase c = randomCase(seed);
        Dice dice(seed);
        do c.options.layers = layersOf(dice, c.options.size.surface, c.soup.parts);
        while (!faultOf(requestOf(c.options.layers)).empty());
        EXPECT_EQ(meshFault(c.soup, c.options, refused), "") << "seed " << seed << ", " << c.kind << ": " << asked(c.options.layers);
    }
    EXPECT_LT(refused, soupsPerShard / 2); // else this would prove little
}

TEST_P(RandomLayers, AreRightOnSamples) {
    unsigned refused = 0;
    for (unsigned i = 0; i < samplesPerShard; ++i) {
        const unsigned seed = firstRandomCase() + GetParam() * samplesPerShard + i;
        const BuiltIn& b = builtIns[seed % std::size(builtIns)];
        const Surface soup = makeSample(b.name);
        Dice dice(1000 + seed);
        Options o;
        o.size.surface = b.h * dice.real(0.9, 1.1);
        o.size.max = 8 * b.h;
        if (b.inside) o.domain.seeds = {{"", *sampleSeed(b.name, "inside")}};
        o.layers = layersOf(dice, b.h, soup.parts);
        EXPECT_EQ(meshFault(soup, o, refused), "") << "seed " << seed << ", " << b.name << ": " << asked(o.layers);
    }
    EXPECT_EQ(refused, 0u);
}

INSTANTIATE_TEST_SUITE_P(Shards, RandomLayers, testing::Range(0u, shards));

} // namespace
} // namespace i2b::test
