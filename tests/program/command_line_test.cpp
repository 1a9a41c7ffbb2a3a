#include "i2b/core/error.h"
#include "i2b/program/case_file.h"
#include "i2b/program/command_line.h"
#include "i2b/program/options.h"
#include <filesystem>
#include <fstream>
#include <gmock/gmock.h>
#include <unistd.h>

namespace i2b {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

using Arguments = std::vector<std::string>;

std::string complaint(const Arguments& arguments) {
    try {
        parseCommandLine(arguments);
    } catch (const Error& error) {
        EXPECT_EQ(error.exitStatus(), 2);
        return error.what();
    }
    return "accepted";
}

struct CaseOnDisk {
    std::string path = (std::filesystem::temp_directory_path() /
                        ("i2b_command_line_test_" + std::to_string(getpid()) + ".toml"))
                           .string();
    explicit CaseOnDisk(const std::string& text) { std::ofstream(path) << text; }
    ~CaseOnDisk() { std::filesystem::remove(path); }
};

// Every option arrives in its field, through each of the ways of writing it.
TEST(CommandLine, SetsEveryOption) {
    const CommandLine line = parseCommandLine({"mesh",
                                               "a.stl",
                                               "b.obj",
                                               "--size",
                                               "0.01",
                                               "--max-size=1",
                                               "--min-size",
                                               "5e-3",
                                               "--scale",
                                               "0.001",
                                               "--box",
                                               "-1",
                                               "-2",
                                               "-.5",
                                               "1",
                                               "2",
                                               "3",
                                               "--internal",
                                               "--layers",
                                               "3",
                                               "--first-layer",
                                               "1e-4",
                                               "--growth",
                                               "1.3",
                                               "--feature-angle",
                                               "30",
                                               "--threads",
                                               "2",
                                               "--format",
                                               "openfoam,vtu",
                                               "--ascii",
                                               "--out",
                                               "here",
                                               "--quiet",
                                               "--part-size",
                                               "wheel=0.2",
                                               "--part-size",
                                               "fin.*=0.1",
                                               "--box-size",
                                               "0",
                                               "0",
                                               "0",
                                               "1",
                                               "1",
                                               "1",
                                               ".5",
                                               "--buffer-cells",
                                               "4",
                                               "--clearance",
                                               "0.2",
                                               "--sweeps",
                                               "6",
                                               "--fit-seconds",
                                               "90"});
    const Options& o = line.given.options;
    EXPECT_EQ(line.command, Command::mesh);
    EXPECT_THAT(o.geometry.files, ElementsAre("a.stl", "b.obj"));
    EXPECT_EQ(o.size.surface, 0.01);
    EXPECT_EQ(o.size.max, 1);
    EXPECT_EQ(o.size.min, 0.005);
    EXPECT_EQ(o.geometry.scale, 0.001);
    EXPECT_EQ(o.domain.box, (Box{{-1, -2, -0.5}, {1, 2, 3}}));
    EXPECT_EQ(o.domain.flow, Flow::internal);
    EXPECT_EQ(o.layers.count, 3);
    EXPECT_EQ(o.layers.first, 1e-4);
    EXPECT_EQ(o.layers.growth, 1.3);
    EXPECT_EQ(o.geometry.featureAngle, 30);
    EXPECT_EQ(o.threads, 2);
    EXPECT_THAT(o.output.formats, ElementsAre("openfoam", "vtu"));
    EXPECT_TRUE(o.output.ascii);
    EXPECT_EQ(o.output.folder, "here");
    EXPECT_TRUE(line.given.quiet);
    ASSERT_EQ(o.size.parts.size(), 2u);
    EXPECT_EQ(o.size.parts[1].part, "fin.*");
    EXPECT_EQ(o.size.parts[1].size, sameSize(0.1));
    ASSERT_EQ(o.size.boxes.size(), 1u);
    EXPECT_EQ(o.size.boxes[0].size, sameSize(0.5));
    EXPECT_EQ(o.size.bufferCells, 4);
    EXPECT_EQ(o.fit.clearance, 0.2);
    EXPECT_EQ(o.fit.sweeps, 6);
    EXPECT_EQ(o.fit.seconds, 90);
    EXPECT_TRUE(validate(o).empty());
}

// Places with a size, in one number or three; a part's name before them; nothing behind is swallowed.
TEST(CommandLine, TakesPlacesWithSizes) {
    const CommandLine line = parseCommandLine(
        {"grid", "--sphere-size", "0", "0", "1", "2", "0.1", "a.stl", "--sphere-size=1,1,1,2,0.1,0.2,0.3", "--band-size",
         "body|fin{1,2}", "0.2", "0.03", "b.stl", "--band-size", "wheel", "0.1", "1", "2", "3", "--cylinder-size", "0",
         "0", "0", "1", "0", "-1", "0.5", "0.1", "--point-size", "1", "2", "3", "0.5", "--segment-size", "0", "0", "0",
         "1", "1", "1", "0.2", "--line-size", "0", "0", "0", "1", "0", "0", "1", "2", "3", "--curvature", "36",
         "--gap-cells", "3", "--box-size", "0", "0", "0", "1", "1", "1", "4", "5", "6", "--part-size", "fin=1,2,3"});
    const SizeOptions& size = line.given.options.size;
    EXPECT_THAT(line.given.options.geometry.files, ElementsAre("a.stl", "b.stl"));
    ASSERT_EQ(size.spheres.size(), 2u);
    EXPECT_EQ(size.spheres[0].centre, (Vec3{0, 0, 1}));
    EXPECT_EQ(size.spheres[0].radius, 2);
    EXPECT_EQ(size.spheres[0].size, sameSize(0.1));
    EXPECT_EQ(size.spheres[1].size, (Vec3{0.1, 0.2, 0.3}));
    ASSERT_EQ(size.bands.size(), 2u);
    EXPECT_EQ(size.bands[0].part, "body|fin{1,2}");
    EXPECT_EQ(size.bands[0].distance, 0.2);
    EXPECT_EQ(size.bands[1].size, (Vec3{1, 2, 3}));
    ASSERT_EQ(size.cylinders.size(), 1u);
    EXPECT_EQ(size.cylinders[0].to, (Vec3{1, 0, -1}));
    EXPECT_EQ(size.cylinders[0].radius, 0.5);
    ASSERT_EQ(size.points.size(), 1u);
    EXPECT_EQ(size.points[0].place, (Vec3{1, 2, 3}));
    ASSERT_EQ(size.segments.size(), 1u);
    ASSERT_EQ(size.lines.size(), 1u);
    EXPECT_EQ(size.lines[0].size, (Vec3{1, 2, 3}));
    EXPECT_EQ(size.curvature, 36);
    EXPECT_EQ(size.gapCells, 3);
    EXPECT_EQ(size.boxes.at(0).size, (Vec3{4, 5, 6}));
    EXPECT_EQ(size.parts.at(0).size, (Vec3{1, 2, 3}));
    EXPECT_THAT(complaint({"mesh", "a.stl", "--sphere-size", "1", "2", "3"}), HasSubstr("3 numbers where 5 are needed"));
    EXPECT_THAT(complaint({"mesh", "a.stl", "--band-size", "body", "1"}), HasSubstr("1 numbers where 2 are needed"));
    EXPECT_THAT(complaint({"mesh", "a.stl", "--band-size"}), HasSubstr("--band-size"));
}

// Names may hold commas, the word ends a box, nothing behind is swallowed; each replaces the case file's list.
TEST(CommandLine, TakesFeatures) {
    const CaseOnDisk file("geometry = 'a.stl'\n[feature]\nlines = 'l.obj'\npart = ['p', 'q']\n"
                          "[[feature.box]]\nbox = [0, 0, 0, 1, 1, 1]\nedges = 'all'\n");
    const Arguments features{"--feature-lines", "e 1.obj", "--feature-lines=f,g.obj", "--feature-part", "fin{1,2}",
                             "--feature-part", "body", "--feature-box", "-1", "0", "0", "1", "1", ".5", "none"};
    Arguments arguments{"mesh"};
    arguments.insert(arguments.end(), features.begin(), features.end());
    arguments.insert(arguments.end(), {"a.stl", "--feature-box=0,0,0,1,1,1,all", "b.stl"});
    const CommandLine line = parseCommandLine(arguments);
    const GeometryOptions& g = line.given.options.geometry;
    EXPECT_THAT(g.files, ElementsAre("a.stl", "b.stl"));
    EXPECT_THAT(g.featureLines, ElementsAre("e 1.obj", "f,g.obj"));
    EXPECT_THAT(g.featureParts, ElementsAre("fin{1,2}", "body"));
    ASSERT_EQ(g.featureBoxes.size(), 2u);
    EXPECT_EQ(g.featureBoxes[0].box, (Box{{-1, 0, 0}, {1, 1, 0.5}}));
    EXPECT_EQ(g.featureBoxes[0].edges, BoxEdges::none);
    EXPECT_EQ(g.featureBoxes[1].edges, BoxEdges::all);
    EXPECT_EQ(parseCase(formatCase(line.given), "").options.geometry.featureParts, g.featureParts);
    arguments = {"mesh", file.path};
    arguments.insert(arguments.end(), features.begin(), features.end());
    const GeometryOptions over = parseCommandLine(arguments).given.options.geometry;
    EXPECT_THAT(over.featureLines, ElementsAre("e 1.obj", "f,g.obj"));
    EXPECT_THAT(over.featureParts, ElementsAre("fin{1,2}", "body"));
    EXPECT_EQ(over.featureBoxes.size(), 1u);
    EXPECT_EQ(parseCommandLine({"inspect", "a.stl", "--feature-part", "b"}).given.options.geometry.featureParts.size(), 1u);
    EXPECT_THAT(complaint({"mesh", "--feature-box", "0", "0", "0", "1", "1", "1", "a.stl"}),
                AllOf(HasSubstr("--feature-box"), HasSubstr("'a.stl' is neither all nor none")));
    EXPECT_THAT(complaint({"mesh", "a.stl", "--feature-box", "0", "0", "1"}), HasSubstr("neither all nor none"));
    EXPECT_THAT(complaint({"mesh", "a.stl", "--feature-box=0,0,1,all"}), HasSubstr("3 numbers where 6 are needed"));
}

// Rules for parts, of which the name may hold commas and "=" itself; the command line's heights replace the case file's.
TEST(CommandLine, TakesLayers) {
    const CommandLine line = parseCommandLine(
        {"mesh", "--part-layers", "wheel.*=3", "--part-layers=fin{1,2}=4,growth=1.3,first=1e-3", "a.stl", "--part-layers", "body=none",
         "--part-layers", "a(?=b),c=2,thickness=.5", "--layers", "5", "--layer-thickness", "0.4", "--layer-unit", "cell", "b.stl"});
    const LayerOptions& l = line.given.options.layers;
    EXPECT_THAT(line.given.options.geometry.files, ElementsAre("a.stl", "b.stl"));
    EXPECT_EQ(l.count, 5);
    EXPECT_EQ(l.thickness, 0.4);
    EXPECT_EQ(l.unit, LayerUnit::cell);
    ASSERT_EQ(l.parts.size(), 4u);
    const auto rule = [&](std::size_t i) { return std::tuple(l.parts[i].part, l.parts[i].count, l.parts[i].first, l.parts[i].thickness, l.parts[i].growth); };
    EXPECT_EQ(rule(0), std::tuple("wheel.*", 3, 0, 0, 0));
    EXPECT_EQ(rule(1), std::tuple("fin{1,2}", 4, 1e-3, 0, 1.3));
    EXPECT_EQ(rule(2), std::tuple("body", 0, 0, 0, 0));
    EXPECT_EQ(rule(3), std::tuple("a(?=b),c", 2, 0, 0.5, 0));
    EXPECT_EQ(parseCase(formatCase(line.given), "").options.layers.parts.size(), 4u);
    for (const char* text : {"wheel", "=3", "wheel=x", "wheel=2.5", "wheel=2,height=3", "wheel=2,first=x", "first=3,"})
        EXPECT_THAT(complaint({"mesh", "a.stl", "--part-layers", text}), HasSubstr("--part-layers")) << text;
    EXPECT_THAT(complaint({"mesh", "a.stl", "--layer-unit", "mm"}), HasSubstr("'mm' is neither m nor cell"));

    const CaseOnDisk plate("geometry = 'a.stl'\nsize = 1\ny-plus = 30\nvelocity = 40\nviscosity = 1.5e-5\nlength = 4\n");
    EXPECT_TRUE(validate(parseCommandLine({"mesh", plate.path, "--first-layer", "0.001"}).given.options).empty());
    EXPECT_EQ(parseCommandLine({"mesh", plate.path, "--y-plus", "1"}).given.options.layers.velocity, 40);
    const CaseOnDisk height("geometry = 'a.stl'\nsize = 1\nfirst-layer = 0.001\n");
    EXPECT_TRUE(validate(parseCommandLine({"mesh", height.path, "--y-plus", "1", "--velocity", "40", "--viscosity", "1e-5", "--length", "4"}).given.options).empty());
}

// `regions` writes only where the command line itself says so.
TEST(CommandLine, KnowsWhetherOutWasGiven) {
    const CaseOnDisk file("geometry = 'a.stl'\nsize = 1\nout = 'here'\n");
    EXPECT_FALSE(parseCommandLine({"regions", file.path}).outGiven);
    EXPECT_TRUE(parseCommandLine({"regions", file.path, "--out", "there"}).outGiven);
}

// Every setting is an option of the three commands, so that nothing can be said only in a case file.
TEST(CommandLine, HelpNamesEverySetting) {
    for (const char* command : {"mesh", "grid", "regions"}) {
        const CommandLine line = parseCommandLine({command, "--help"});
        EXPECT_EQ(line.command, Command::help);
        for (const Setting& setting : settings().subspan(1)) // the first, geometry, is positional
            EXPECT_THAT(line.text, HasSubstr("--" + std::string(setting.key)));
    }
}

// Seeds in both forms, negative, named, and with the geometry behind them: no number or file is taken for
// another.
TEST(CommandLine, SeedsDoNotSwallowFiles) {
    const CommandLine line = parseCommandLine(
        {"regions", "--seed", "0", "-1", "-.25", "body.stl", "--keep-out", "1", "2", "-3", "--seed", "air=-1,2,3e-1", "fin.stl", "--keep-out=room=0,0,1"});
    EXPECT_EQ(line.command, Command::regions);
    EXPECT_THAT(line.given.options.geometry.files, ElementsAre("body.stl", "fin.stl"));
    const std::vector<Seed>& seeds = line.given.options.domain.seeds;
    ASSERT_EQ(seeds.size(), 2u);
    EXPECT_EQ(seeds[0].name, "");
    EXPECT_EQ(seeds[0].place, (Vec3{0, -1, -0.25}));
    EXPECT_EQ(seeds[1].name, "air");
    EXPECT_EQ(seeds[1].place, (Vec3{-1, 2, 0.3}));
    const std::vector<Seed>& keepOut = line.given.options.domain.keepOut;
    ASSERT_EQ(keepOut.size(), 2u);
    EXPECT_EQ(keepOut[0].place, (Vec3{1, 2, -3}));
    EXPECT_EQ(keepOut[1].name, "room");
}

// A negative number is a value (for validate() to judge), never an unknown option.
TEST(CommandLine, NegativeNumbersAreValues) {
    EXPECT_EQ(parseCommandLine({"mesh", "a.stl", "--size", "-1"}).given.options.size.surface, -1);
    EXPECT_EQ(parseCommandLine({"mesh", "a.stl", "--size", "-.5"}).given.options.size.surface, -0.5);
}

// The command line wins over the case file; what it does not name stays; a list replaces the file's.
TEST(CommandLine, OverridesTheCaseFile) {
    const CaseOnDisk file("geometry = 'a.stl'\nsize = 1\nlayers = 4\nexternal = true\nascii = true\n"
                          "part-size = [{ part = 'w', size = 1 }]\n");
    const CommandLine line = parseCommandLine(
        {"mesh", file.path, "--size", "2", "--seed", "1,2,3", "--part-size", "v=3", "--ascii=false"});
    const Options& o = line.given.options;
    EXPECT_EQ(o.size.surface, 2);
    EXPECT_EQ(o.layers.count, 4);
    EXPECT_EQ(o.domain.flow, Flow::automatic);
    EXPECT_FALSE(o.output.ascii);
    ASSERT_EQ(o.size.parts.size(), 1u);
    EXPECT_EQ(o.size.parts[0].part, "v");
    EXPECT_EQ(line.given.lines.count("size"), 0u);
    EXPECT_EQ(line.given.lines.at("layers"), 3);
    EXPECT_TRUE(validate(o).empty());
    const CommandLine internal = parseCommandLine({"mesh", file.path, "--internal"});
    EXPECT_EQ(internal.given.options.domain.flow, Flow::internal);
}

// What is wrong on the command line is named together with the option.
TEST(CommandLine, RefusesMistakes) {
    EXPECT_THAT(complaint({"mesh", "a.stl", "--sise", "1"}),
                AllOf(HasSubstr("--sise"), HasSubstr("i2b mesh --help")));
    EXPECT_THAT(complaint({"mesh", "a.stl", "--size", "big"}),
                AllOf(HasSubstr("'big'"), HasSubstr("--size")));
    EXPECT_THAT(complaint({"mesh", "a.stl", "--layers", "1.5"}), HasSubstr("--layers"));
    EXPECT_THAT(complaint({"mesh", "a.stl", "--size"}), HasSubstr("--size"));
    EXPECT_THAT(complaint({"mesh", "a.stl", "--box", "1", "2", "3"}),
                HasSubstr("3 numbers where 6 are needed"));
    EXPECT_THAT(complaint({"mesh", "a.stl", "--seed", "1", "2"}), HasSubstr("2 numbers where 3 are needed"));
    EXPECT_THAT(complaint({"mesh", "a.stl", "--seed", "air=1,2"}), HasSubstr("2 numbers where 3 are needed"));
    EXPECT_THAT(complaint({"mesh", "a.stl", "--part-size", "wheel"}), HasSubstr("PART=D"));
    EXPECT_THAT(complaint({"mesh", "a.toml", "b.stl"}), HasSubstr("together"));
    EXPECT_THAT(complaint({"mesh", "no such.toml"}), HasSubstr("no such.toml"));
    EXPECT_THAT(complaint({"mesh", "a.stl", "--external", "--internal"}), HasSubstr("--internal"));
    EXPECT_THAT(complaint({"inspect", "a.toml"}), HasSubstr("no geometry"));
    EXPECT_NE(complaint({"inspect"}), "accepted");
    EXPECT_NE(complaint({"check"}), "accepted");
    EXPECT_NE(complaint({"paint"}), "accepted");
    EXPECT_NE(complaint({}), "accepted");
}

// The other commands take what they need.
TEST(CommandLine, ReadsInspectCheckAndSample) {
    const CommandLine inspect = parseCommandLine({"inspect", "a.stl", "b.stl", "--scale", "0.001"});
    EXPECT_EQ(inspect.command, Command::inspect);
    EXPECT_THAT(inspect.given.options.geometry.files, ElementsAre("a.stl", "b.stl"));
    EXPECT_EQ(inspect.given.options.geometry.scale, 0.001);
    const CommandLine check =
        parseCommandLine({"check", "case", "--geometry", "a.stl", "b.stl", "--threads", "1"});
    EXPECT_EQ(check.caseFolder, "case");
    EXPECT_THAT(check.given.options.geometry.files, ElementsAre("a.stl", "b.stl"));
    EXPECT_EQ(check.given.options.threads, 1);
    EXPECT_THAT(check.patches, ElementsAre());
    EXPECT_THAT(parseCommandLine({"check", "--geometry", "a.stl", "--patch", "w{1,2}", "--patch", "b", "case"}).patches,
                ElementsAre("w{1,2}", "b"));
    EXPECT_THAT(complaint({"check", "case", "--patch", "b"}), HasSubstr("--geometry"));
    const CommandLine sample = parseCommandLine({"sample", "engine", "-o", "engine.stl"});
    EXPECT_EQ(sample.command, Command::sample);
    EXPECT_EQ(sample.sample, "engine");
    EXPECT_EQ(sample.sampleFile, "engine.stl");
}

// Limits come from a case file, of which nothing else counts, and the command line wins over it.
TEST(CommandLine, LimitsOfCheck) {
    const CaseOnDisk file("geometry = 'a.stl'\nsize = 1\n[quality]\nmin-twist = 0.05\nmin-determinant = 0.01\n");
    const CommandLine line = parseCommandLine({"check", "case", "--case", file.path, "--min-determinant", "-1"});
    EXPECT_EQ(line.given.options.quality.twist, 0.05);
    EXPECT_EQ(line.given.options.quality.determinant, -1);
    EXPECT_TRUE(line.given.options.geometry.files.empty());
    EXPECT_EQ(line.given.options.size.surface, 0);
}

// --write-case prints the case of this very command line.
TEST(CommandLine, WriteCaseKeepsTheCommandLine) {
    const CommandLine line =
        parseCommandLine({"mesh", "a.stl", "--size", "0.3", "--seed", "0,0,1", "--write-case"});
    EXPECT_TRUE(line.writeCase);
    const Case back = parseCase(formatCase(line.given), "");
    EXPECT_EQ(back.options.size.surface, 0.3);
    EXPECT_THAT(back.options.geometry.files, ElementsAre("a.stl"));
    ASSERT_EQ(back.options.domain.seeds.size(), 1u);
}

} // namespace
} // namespace i2b
