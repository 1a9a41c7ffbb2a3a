#include "i2b/core/error.h"
#include "i2b/program/case_file.h"
#include "i2b/program/entries.h"
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <gmock/gmock.h>

namespace i2b {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

// Every field away from its default, with numbers that need all their digits.
Case everything() {
    Case c;
    Options& o = c.options;
    o.geometry = {{"a \"quoted\".stl", "dir/b.obj"},
                  0.001,
                  1.0 / 3,
                  2.5,
                  {"edges.obj", "dir/more, edges.obj"},
                  {"fin{1,2}", "body"},
                  {{{{-1, -2, -3}, {4, 5, 1.0 / 3}}, BoxEdges::all}, {{{0, 0, 0}, {1, 1, 1}}, BoxEdges::none}}};
    o.size.surface = 0.1;
    o.size.max = 1e22;
    o.size.min = 1e-7;
    o.size.parts = {{"wheel.*", sameSize(0.05)}, {"fin\\d", {2, 1, 0.5}}};
    o.size.boxes = {{{{-1, -2, -3}, {4, 5, 6.5}}, sameSize(0.25)}};
    o.size.spheres = {{{1, 2, 3}, 0.5, {0.1, 0.2, 1.0 / 3}}};
    o.size.cylinders = {{{0, 0, 0}, {1, 0, 0}, 0.25, sameSize(0.125)}, {{0, 1, 0}, {1, 1, 0}, 1, sameSize(0.5)}};
    o.size.bands = {{"body|wheel{1,2}", 0.2, sameSize(0.03)}};
    o.size.points = {{{1, 2, -3}, sameSize(1e-3)}};
    o.size.segments = {{{1, 2, -3}, {4, 5, 6}, sameSize(1e-3)}};
    o.size.lines = {{{1, 2, -3}, {0, 0, 1}, {1, 2, 3}}};
    o.size.curvature = 36;
    o.size.gapCells = 4;
    o.size.bufferCells = 5;
    o.domain.box = Box{{-1.5, 0, 0}, {1, 2, 3}};
    o.domain.flow = Flow::internal;
    o.domain.seeds = {{"jacket", {0.1, -0.2, 0.3}}, {"", {1, 2, 3}}};
    o.domain.keepOut = {{"cabin", {0.4, 0.5, -0.6}}};
    o.fit = {0.2, 7};
    o.layers = {3, 1e-4, 1.35, 0.01, LayerUnit::cell, 30, 40, 1.5e-5, 4.6, {{"wheel{1,2}", 2, 1e-3, 0, 1.25}, {"body", 0, 0, 0, 0}}};
    o.output = {"out/car", {"vtu"}, true};
    o.quality = {60, 1e-14, -1e30, 70, 1e-9, 3, 10, 0.1, 0.02, 0.05, 0.01, 0, 0.002};
    o.threads = 3;
    c.quiet = true;
    return c;
}

template <class T>
void expectSameItems(const std::vector<T>& a, const std::vector<T>& b) {
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
        const auto same = [&](const auto& entry) { EXPECT_EQ(a[i].*(entry.member), b[i].*(entry.member)); };
        std::apply([&](const auto&... entry) { (same(entry), ...); }, entriesOf(a[i]));
    }
}

// Compared field by field: the text form alone could hide what it leaves out.
void expectSame(const Options& a, const Options& b) {
    EXPECT_EQ(a.geometry.files, b.geometry.files);
    EXPECT_EQ(a.geometry.scale, b.geometry.scale);
    EXPECT_EQ(a.geometry.featureAngle, b.geometry.featureAngle);
    EXPECT_EQ(a.geometry.creaseAngle, b.geometry.creaseAngle);
    EXPECT_EQ(a.geometry.featureLines, b.geometry.featureLines);
    EXPECT_EQ(a.geometry.featureParts, b.geometry.featureParts);
    expectSameItems(a.geometry.featureBoxes, b.geometry.featureBoxes);
    EXPECT_EQ(a.size.surface, b.size.surface);
    EXPECT_EQ(a.size.max, b.size.max);
    EXPECT_EQ(a.size.min, b.size.min);
    EXPECT_EQ(a.size.bufferCells, b.size.bufferCells);
    EXPECT_EQ(a.size.curvature, b.size.curvature);
    EXPECT_EQ(a.size.gapCells, b.size.gapCells);
    expectSameItems(a.size.parts, b.size.parts);
    expectSameItems(a.size.boxes, b.size.boxes);
    expectSameItems(a.size.spheres, b.size.spheres);
    expectSameItems(a.size.cylinders, b.size.cylinders);
    expectSameItems(a.size.bands, b.size.bands);
    expectSameItems(a.size.points, b.size.points);
    expectSameItems(a.size.segments, b.size.segments);
    expectSameItems(a.size.lines, b.size.lines);
    EXPECT_EQ(a.domain.box, b.domain.box);
    EXPECT_EQ(a.domain.flow, b.domain.flow);
    ASSERT_EQ(a.domain.seeds.size(), b.domain.seeds.size());
    for (std::size_t i = 0; i < a.domain.seeds.size(); ++i) {
        EXPECT_EQ(a.domain.seeds[i].name, b.domain.seeds[i].name);
        EXPECT_EQ(a.domain.seeds[i].place, b.domain.seeds[i].place);
    }
    ASSERT_EQ(a.domain.keepOut.size(), b.domain.keepOut.size());
    for (std::size_t i = 0; i < a.domain.keepOut.size(); ++i) {
        EXPECT_EQ(a.domain.keepOut[i].name, b.domain.keepOut[i].name);
        EXPECT_EQ(a.domain.keepOut[i].place, b.domain.keepOut[i].place);
    }
    EXPECT_EQ(a.fit.clearance, b.fit.clearance);
    EXPECT_EQ(a.fit.sweeps, b.fit.sweeps);
    EXPECT_EQ(a.fit.seconds, b.fit.seconds);
    EXPECT_EQ(a.layers.count, b.layers.count);
    EXPECT_EQ(a.layers.first, b.layers.first);
    EXPECT_EQ(a.layers.growth, b.layers.growth);
    EXPECT_EQ(a.layers.thickness, b.layers.thickness);
    EXPECT_EQ(a.layers.unit, b.layers.unit);
    EXPECT_EQ(a.layers.yPlus, b.layers.yPlus);
    EXPECT_EQ(a.layers.velocity, b.layers.velocity);
    EXPECT_EQ(a.layers.viscosity, b.layers.viscosity);
    EXPECT_EQ(a.layers.length, b.layers.length);
    expectSameItems(a.layers.parts, b.layers.parts);
    EXPECT_EQ(a.quality.nonOrthogonality, b.quality.nonOrthogonality);
    EXPECT_EQ(a.quality.pyramidVolume, b.quality.pyramidVolume);
    EXPECT_EQ(a.quality.tetQuality, b.quality.tetQuality);
    EXPECT_EQ(a.quality.concavity, b.quality.concavity);
    EXPECT_EQ(a.quality.faceArea, b.quality.faceArea);
    EXPECT_EQ(a.quality.internalSkewness, b.quality.internalSkewness);
    EXPECT_EQ(a.quality.boundarySkewness, b.quality.boundarySkewness);
    EXPECT_EQ(a.quality.faceWeight, b.quality.faceWeight);
    EXPECT_EQ(a.quality.volumeRatio, b.quality.volumeRatio);
    EXPECT_EQ(a.quality.twist, b.quality.twist);
    EXPECT_EQ(a.quality.triangleTwist, b.quality.triangleTwist);
    EXPECT_EQ(a.quality.flatness, b.quality.flatness);
    EXPECT_EQ(a.quality.determinant, b.quality.determinant);
    EXPECT_EQ(a.output.folder, b.output.folder);
    EXPECT_EQ(a.output.formats, b.output.formats);
    EXPECT_EQ(a.output.ascii, b.output.ascii);
    EXPECT_EQ(a.threads, b.threads);
}

std::string complaint(const std::string& text) {
    try {
        parseCase(text, "car.toml");
    } catch (const Error& error) {
        EXPECT_EQ(error.exitStatus(), 2);
        return error.what();
    }
    return "accepted";
}

// What --write-case prints is what was asked for, to the last bit of every number.
TEST(CaseFile, RoundTripsEveryField) {
    const Case written = everything();
    const Case back = parseCase(formatCase(written), "");
    expectSame(written.options, back.options);
    EXPECT_TRUE(back.quiet);
}

// The defaults too, where box is absent and neither flow is chosen.
TEST(CaseFile, RoundTripsTheDefaults) { expectSame(Options{}, parseCase(formatCase({}), "").options); }

// The complete case file has every key, so that it can serve as the reference of them.
TEST(CaseFile, WritesEveryKey) {
    const std::string text = formatCase(everything());
    for (const Setting& setting : settings())
        EXPECT_THAT(text, HasSubstr("\n" + std::string(setting.key) + " = ")) << setting.key;
}

// Geometry is found from anywhere: its names are relative to the case file.
TEST(CaseFile, GeometryIsRelativeToTheFile) {
    const Case c = parseCase("geometry = ['a.stl', '/data/b.stl']", "cases/car.toml");
    EXPECT_THAT(c.options.geometry.files, ::testing::ElementsAre("cases/a.stl", "/data/b.stl"));
}

// Limits of quality stand before the tables or in [quality], under the same names.
TEST(CaseFile, LimitsOfQuality) {
    const Case table = parseCase("[quality]\nmax-non-orthogonality = 70\nmin-tet-quality = -1e30\n", "car.toml");
    EXPECT_EQ(table.options.quality.nonOrthogonality, 70);
    EXPECT_EQ(table.options.quality.tetQuality, -1e30);
    EXPECT_EQ(table.options.quality.internalSkewness, 4);
    expectSame(parseCase("max-non-orthogonality = 70\nmin-tet-quality = -1e30\n", "").options, table.options);
    EXPECT_THAT(complaint("[quality]\nmax-non-orthogonalty = 70"), AllOf(HasSubstr("car.toml:2"), HasSubstr("max-non-orthogonality")));
}

// The short forms of lists of one.
TEST(CaseFile, TakesShortForms) {
    const Case c = parseCase("geometry = 'a.stl'\nseed = [1, 2, 3.5]\n", "car.toml");
    EXPECT_EQ(c.options.geometry.files, std::vector<std::string>{"a.stl"});
    ASSERT_EQ(c.options.domain.seeds.size(), 1u);
    EXPECT_EQ(c.options.domain.seeds[0].place, (Vec3{1, 2, 3.5}));
    const Case two = parseCase("seed = [[1, 2, 3], { name = 'b', place = [4, 5, 6] }]", "car.toml");
    ASSERT_EQ(two.options.domain.seeds.size(), 2u);
    EXPECT_EQ(two.options.domain.seeds[1].name, "b");
}

// Each mistake is reported with file, line and key, and with what to write instead.
TEST(CaseFile, NamesFileLineAndKey) {
    EXPECT_THAT(complaint("size = 1\nmaxsize = 2\n"),
                AllOf(HasSubstr("car.toml:2, key maxsize"), HasSubstr("write max-size")));
    EXPECT_THAT(complaint("\n\nlaundry = 2\n"), AllOf(HasSubstr("car.toml:3"), HasSubstr("--write-case")));
    EXPECT_THAT(complaint("\nsize = 'big'\n"),
                AllOf(HasSubstr("car.toml:2, key size"), HasSubstr("string"), HasSubstr("a number")));
    EXPECT_THAT(complaint("layers = 1.5"), AllOf(HasSubstr("key layers"), HasSubstr("a whole number")));
    EXPECT_THAT(complaint("layers = 9999999999"), HasSubstr("a whole number"));
    EXPECT_THAT(complaint("ascii = 1"), AllOf(HasSubstr("key ascii"), HasSubstr("true or false")));
    EXPECT_THAT(complaint("out = 3"), HasSubstr("a text in quotes"));
    EXPECT_THAT(complaint("geometry = [1]"), HasSubstr("a text in quotes"));
    EXPECT_THAT(complaint("format = 1"), HasSubstr("a list"));
    EXPECT_THAT(complaint("box = [0, 0, 0, 1, 1]"), AllOf(HasSubstr("key box"), HasSubstr("6 numbers")));
    EXPECT_THAT(complaint("seed = [\n[0, 0, 0],\n[1, 'x', 2]]"),
                AllOf(HasSubstr("car.toml:3"), HasSubstr("a number")));
    EXPECT_THAT(complaint("part-size = [{ part = 'a' }]"), HasSubstr("an entry is missing"));
    EXPECT_THAT(complaint("part-size = [{ part = 'a', size = 1, colour = 2 }]"),
                HasSubstr("unknown entry 'colour'"));
    EXPECT_THAT(complaint("box-size = [3]"), HasSubstr("box = ..., size = ..."));
    EXPECT_THAT(complaint("external = true\ninternal = true"),
                AllOf(HasSubstr("exclude"), HasSubstr("car.toml:")));
    EXPECT_THAT(complaint("size = 1\nsize = 2"), HasSubstr("car.toml:2"));
    EXPECT_THAT(complaint("size = \n"), HasSubstr("car.toml:1"));
}

// Sizes in tables of their own are the same options under shorter names.
TEST(CaseFile, TakesSizesAsTables) {
    const Case tables = parseCase("layers = 2\n[size]\nsurface = 0.02\nmax = 0.5\nmin = 0.01\nbuffer-cells = 4\n"
                                  "curvature = 36\ngap-cells = 3\n"
                                  "[[size.part]]\npart = 'wheel.*'\nsize = 0.01\n"
                                  "[[size.part]]\npart = 'fin'\nsize = [0.01, 0.02, 0.01]\n"
                                  "[[size.box]]\nbox = [0, 0, 0, 1, 1, 1]\nsize = [1, 2, 3]\n"
                                  "[[size.sphere]]\ncentre = [1, 2, 3]\nradius = 2\nsize = 0.1\n"
                                  "[[size.cylinder]]\nfrom = [0, 0, 0]\nto = [1, 0, 0]\nradius = 0.1\nsize = 0.2\n"
                                  "[[size.band]]\npart = 'body'\ndistance = 0.2\nsize = 0.03\n"
                                  "[[size.point]]\nplace = [1, 1, 1]\nsize = 0.1\n"
                                  "[[size.segment]]\nfrom = [0, 0, 0]\nto = [1, 1, 1]\nsize = 0.1\n"
                                  "[[size.line]]\nthrough = [0, 0, 0]\ndirection = [1, 1, 1]\nsize = 0.1\n",
                                  "car.toml");
    const Case flat = parseCase(
        "layers = 2\nsize = 0.02\nmax-size = 0.5\nmin-size = 0.01\nbuffer-cells = 4\ncurvature = 36\ngap-cells = 3\n"
        "part-size = [{ part = 'wheel.*', size = 0.01 }, { part = 'fin', size = [0.01, 0.02, 0.01] }]\n"
        "box-size = [{ box = [0, 0, 0, 1, 1, 1], size = [1, 2, 3] }]\n"
        "sphere-size = [{ centre = [1, 2, 3], radius = 2, size = 0.1 }]\n"
        "cylinder-size = [{ from = [0, 0, 0], to = [1, 0, 0], radius = 0.1, size = 0.2 }]\n"
        "band-size = [{ part = 'body', distance = 0.2, size = 0.03 }]\n"
        "point-size = [{ place = [1, 1, 1], size = 0.1 }]\n"
        "segment-size = [{ from = [0, 0, 0], to = [1, 1, 1], size = 0.1 }]\n"
        "line-size = [{ through = [0, 0, 0], direction = [1, 1, 1], size = 0.1 }]\n",
        "car.toml");
    expectSame(tables.options, flat.options);
    EXPECT_EQ(tables.options.size.boxes.at(0).size, (Vec3{1, 2, 3}));
    EXPECT_EQ(tables.lines.at("max-size"), 4);
    EXPECT_EQ(tables.lines.at("part-size"), 9);
    expectSame(parseCase(formatCase(tables), "").options, tables.options);
}

// So may features; their files are relative to the case file, one text stands for a list of one.
TEST(CaseFile, TakesFeaturesAsTable) {
    const Case tables = parseCase("size = 1\n[feature]\nangle = 30\ncrease-angle = 2\nlines = ['a.obj', '/data/b.obj']\npart = 'door'\n"
                                  "[[feature.box]]\nbox = [0, 0, 0, 1, 1, 1]\nedges = 'all'\n"
                                  "[[feature.box]]\nbox = [0, 0, 0, 2, 1, 1]\nedges = 'none'\n",
                                  "cases/car.toml");
    const Case flat = parseCase("size = 1\nfeature-angle = 30\ncrease-angle = 2\nfeature-lines = ['a.obj', '/data/b.obj']\n"
                                "feature-part = ['door']\n"
                                "feature-box = [{ box = [0, 0, 0, 1, 1, 1], edges = 'all' },"
                                " { box = [0, 0, 0, 2, 1, 1], edges = 'none' }]\n",
                                "cases/car.toml");
    expectSame(tables.options, flat.options);
    EXPECT_THAT(tables.options.geometry.featureLines, ::testing::ElementsAre("cases/a.obj", "/data/b.obj"));
    EXPECT_EQ(tables.options.geometry.featureBoxes.at(0).edges, BoxEdges::all);
    EXPECT_EQ(tables.lines.at("feature-lines"), 5);
    EXPECT_EQ(tables.lines.at("feature-box"), 7);
    expectSame(parseCase(formatCase(tables), "").options, tables.options);
}

TEST(CaseFile, NamesFileLineAndKeyOfFeatures) {
    EXPECT_THAT(complaint("[feature]\nlins = 'a'"), AllOf(HasSubstr("car.toml:2, key feature.lins"), HasSubstr("write lines")));
    EXPECT_THAT(complaint("[feature]\nsize = 1"), AllOf(HasSubstr("car.toml:2"), HasSubstr("the table [feature]")));
    EXPECT_THAT(complaint("[feature]\nsurface = 1"), AllOf(HasSubstr("unknown key 'feature.surface'"), HasSubstr("car.toml:2")));
    EXPECT_THAT(complaint("feature-angle = 3\n[feature]\nangle = 4"), AllOf(HasSubstr("car.toml:3"), HasSubstr("line 1")));
    EXPECT_THAT(complaint("[feature]\npart = [1]"), AllOf(HasSubstr("key feature.part"), HasSubstr("a text in quotes")));
    EXPECT_THAT(complaint("[[feature.box]]\nbox = [0, 0, 0, 1, 1, 1]\nedges = 'some'"),
                AllOf(HasSubstr("car.toml:3, key feature.box"), HasSubstr("'some'"), HasSubstr("\"all\" or \"none\"")));
    EXPECT_THAT(complaint("[[feature.box]]\nbox = [0, 0, 0, 1, 1, 1]"), HasSubstr("edges = ..."));
    EXPECT_THAT(complaint("feature = 3"), HasSubstr("unknown key 'feature'"));
}

// Layers in a table of their own are the same as under their keys; of a part what is left out is 0.
TEST(CaseFile, ReadsLayersFromTheirTable) {
    const Case table = parseCase("[layer]\ncount = 5\nfirst = 0.1\nthickness = 1\ngrowth = 1.25\nunit = 'cell'\n"
                                 "[[layer.part]]\npart = 'wheel.*'\ncount = 2\ngrowth = 1.5\n"
                                 "[[layer.part]]\npart = 'body'\ncount = 'none'\n", "");
    const LayerOptions& l = table.options.layers;
    EXPECT_EQ(l.count, 5);
    EXPECT_EQ(l.first, 0.1);
    EXPECT_EQ(l.thickness, 1);
    EXPECT_EQ(l.growth, 1.25);
    EXPECT_EQ(l.unit, LayerUnit::cell);
    expectSameItems(l.parts, {{"wheel.*", 2, 0, 0, 1.5}, {"body", 0, 0, 0, 0}});
    const Case keys = parseCase("layers = 5\nfirst-layer = 0.1\nlayer-thickness = 1\ngrowth = 1.25\nlayer-unit = 'cell'\n"
                                "part-layers = [{ part = 'wheel.*', count = 2, growth = 1.5 }, { part = 'body', count = 0 }]", "");
    expectSame(keys.options, table.options);
    EXPECT_EQ(parseCase("[layer]\ny-plus = 1\nvelocity = 2\nviscosity = 3\nlength = 4", "").options.layers.length, 4);

    EXPECT_THAT(complaint("[layer]\nfirst = 1\nunit = 'mm'"), AllOf(HasSubstr("car.toml:3, key layer.unit"), HasSubstr("\"m\" or \"cell\"")));
    EXPECT_THAT(complaint("[[layer.part]]\npart = 'a'\ncount = 'some'"),
                AllOf(HasSubstr("car.toml:3, key layer.part"), HasSubstr("a whole number, or \"none\"")));
    EXPECT_THAT(complaint("[[layer.part]]\npart = 'a'\nfirst = 1"), AllOf(HasSubstr("car.toml:1"), HasSubstr("an entry is missing")));
    EXPECT_THAT(complaint("[[layer.part]]\npart = 'a'\ncount = 1\nheight = 1"), HasSubstr("unknown entry 'height'"));
    EXPECT_THAT(complaint("growth = 1\n[layer]\ngrowth = 2"), AllOf(HasSubstr("car.toml:3"), HasSubstr("line 1")));
}

// The fit's keys stand in [fit] too, under shorter names; twice is once too often.
TEST(CaseFile, FitTable) {
    const Case table = parseCase("size = 1\n[fit]\nseconds = 60\nclearance = 0.2\nsweeps = 3\n", "car.toml");
    EXPECT_EQ(table.options.fit.seconds, 60);
    EXPECT_EQ(table.options.fit.clearance, 0.2);
    EXPECT_EQ(table.options.fit.sweeps, 3);
    EXPECT_EQ(table.lines.at("fit-seconds"), 3);
    expectSame(parseCase("size = 1\nfit-seconds = 60\nclearance = 0.2\nsweeps = 3\n", "car.toml").options, table.options);
    EXPECT_THAT(complaint("fit-seconds = 1\n[fit]\nseconds = 2"), HasSubstr("are the same"));
}

TEST(CaseFile, NamesFileLineAndKeyInTables) {
    EXPECT_THAT(complaint("[size]\nsurfac = 1"), AllOf(HasSubstr("car.toml:2, key size.surfac"), HasSubstr("write surface")));
    EXPECT_THAT(complaint("[size]\nsurface = 1\nlayers = 2"), AllOf(HasSubstr("car.toml:3"), HasSubstr("before the first table")));
    EXPECT_THAT(complaint("max-size = 2\n[size]\nmax = 1"), AllOf(HasSubstr("car.toml:3, key size.max"), HasSubstr("line 1")));
    EXPECT_THAT(complaint("[size]\nsurface = 1\n[[size.band]]\npart = 'a'\nsize = 1\n"),
                AllOf(HasSubstr("car.toml:3, key size.band"), HasSubstr("an entry is missing"), HasSubstr("distance")));
    EXPECT_THAT(complaint("[[size.sphere]]\ncentre = [0, 0, 0]\nradius = 'x'\nsize = 1\n"),
                AllOf(HasSubstr("car.toml:3, key size.sphere"), HasSubstr("a number")));
    EXPECT_THAT(complaint("[[size.sphere]]\ncentre = [0, 0, 0]\nradius = 1\nsize = [1, 2]\n"),
                AllOf(HasSubstr("car.toml:4"), HasSubstr("a list of 3 numbers")));
    EXPECT_THAT(complaint("[layers]\ncount = 1"), HasSubstr("car.toml:1, key layers"));
}

// From a file: a missing one is a mistake of the command line, an empty one is an empty case.
TEST(CaseFile, ReadsFiles) {
    const auto folder = std::filesystem::temp_directory_path();
    EXPECT_THROW(readCaseFile((folder / "no such case.toml").string()), Error);
    EXPECT_THROW(readCaseFile(folder.string()), Error);
    const auto file = folder / "i2b_case_file_test.toml";
    std::ofstream(file) << "# nothing\n";
    EXPECT_EQ(readCaseFile(file.string()).lines.size(), 0u);
    std::ofstream(file) << "\nsize = 2\n";
    EXPECT_EQ(readCaseFile(file.string()).lines.at("size"), 2);
    std::filesystem::remove(file);
}

} // namespace
} // namespace i2b
