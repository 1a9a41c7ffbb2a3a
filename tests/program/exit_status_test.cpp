#include "i2b/core/error.h"
#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <gmock/gmock.h>
#include <sys/wait.h>
#include <unistd.h>

namespace i2b {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

struct Outcome {
    int status = -1;
    std::string text; // both streams
};

// Runs the real program in a folder of its own.
class ExitStatus : public ::testing::Test {
  protected:
    std::filesystem::path folder_ =
        std::filesystem::temp_directory_path() / ("i2b_exit_status_" + std::to_string(getpid()));
    void SetUp() override { std::filesystem::create_directories(folder_); }
    void TearDown() override { std::filesystem::remove_all(folder_); }

    Outcome run(const std::string& arguments) const {
        const std::string command =
            "cd '" + folder_.string() + "' && { '" I2B_PROGRAM "' " + arguments + "; } 2>&1";
        std::FILE* const pipe = popen(command.c_str(), "r");
        Outcome outcome;
        std::array<char, 4096> buffer{};
        for (std::size_t n; (n = std::fread(buffer.data(), 1, buffer.size(), pipe)) > 0;)
            outcome.text.append(buffer.data(), n);
        const int status = pclose(pipe);
        outcome.status = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
        return outcome;
    }
};

// 0: help and version.
TEST_F(ExitStatus, HelpSucceeds) {
    EXPECT_EQ(run("--help").status, 0);
    EXPECT_THAT(run("mesh --help").text, HasSubstr("--feature-angle"));
    EXPECT_THAT(run("--version").text, StartsWith("i2b "));
}

// 1: the input cannot be meshed, and the message names the file.
TEST_F(ExitStatus, MissingGeometryIsOne) {
    const Outcome inspect = run("inspect nowhere.stl");
    EXPECT_EQ(inspect.status, 1);
    EXPECT_THAT(inspect.text, HasSubstr("nowhere.stl"));
    EXPECT_EQ(run("check nowhere").status, 1);
    ASSERT_EQ(run("sample sphere -o sphere.stl").status, 0);
    const Outcome lines = run("mesh sphere.stl --size 0.2 --feature-lines nowhere.obj");
    EXPECT_EQ(lines.status, 1);
    EXPECT_THAT(lines.text, HasSubstr("nowhere.obj"));
    std::ofstream(folder_ / "empty.stl") << "";
    EXPECT_EQ(run("inspect empty.stl").status, 1);
}

// 2: the command line or the case file is wrong, and the message names option or file, line and key.
TEST_F(ExitStatus, WrongUseIsTwo) {
    EXPECT_EQ(run("").status, 2);
    EXPECT_THAT(run("mesh --sise 1 a.stl").text, HasSubstr("--sise"));
    EXPECT_EQ(run("mesh --sise 1 a.stl").status, 2);
    EXPECT_EQ(run("mesh a.stl").status, 2);
    EXPECT_THAT(run("mesh a.stl").text, AllOf(HasSubstr("size is missing"), HasSubstr("--size")));
    std::ofstream(folder_ / "car.toml") << "geometry = 'a.stl'\nsize = 1\ngrowth = 99\n";
    const Outcome car = run("mesh car.toml");
    EXPECT_EQ(car.status, 2);
    EXPECT_THAT(car.text, HasSubstr("car.toml:3, key growth"));
    EXPECT_EQ(run("sample nonsense -o a.stl").status, 2);
    EXPECT_EQ(run("sample box").status, 2);
    EXPECT_EQ(run("mesh no.toml").status, 2);
}

// A sample goes out and comes back in: the cube has 12 triangles and an extent of one metre, or of a
// millimetre.
TEST_F(ExitStatus, SampleIsInspected) {
    const Outcome sample = run("sample box -o box.stl");
    ASSERT_EQ(sample.status, 0) << sample.text;
    const Outcome inspect = run("inspect box.stl --scale 0.001");
    EXPECT_EQ(inspect.status, 0);
    EXPECT_THAT(inspect.text, HasSubstr("12"));
    EXPECT_THAT(run("sample").text, HasSubstr("engine"));
}

// --write-case prints a case file that the program takes, wherever it is asked for.
TEST_F(ExitStatus, WrittenCaseIsRead) {
    ASSERT_EQ(run("mesh a.stl --size 0.25 --write-case > a.toml").status, 0);
    EXPECT_EQ(run("mesh a.toml --write-case > b.toml").status, 0);
    std::ifstream a(folder_ / "a.toml"), b(folder_ / "b.toml");
    const std::string first{std::istreambuf_iterator<char>(a), {}},
        second{std::istreambuf_iterator<char>(b), {}};
    EXPECT_THAT(first, HasSubstr("size = 0.25"));
    EXPECT_EQ(first, second);
}

// 0: a mesh was written, in all formats, and what was written reads back as the mesh that was reported.
TEST_F(ExitStatus, MeshSucceeds) {
    ASSERT_EQ(run("sample sphere -o sphere.stl").status, 0);
    const Outcome mesh = run("mesh sphere.stl --size 0.2 --box -1 -1 -1 1 1 1 --out case --threads 2");
    ASSERT_EQ(mesh.status, 0) << mesh.text;
    EXPECT_THAT(mesh.text, HasSubstr("written to case"));
    for (const char* file :
         {"constant/polyMesh/points", "case.foam", "mesh.vtu", "wall.ply", "grid.vdb", "report.json"})
        EXPECT_TRUE(std::filesystem::exists(folder_ / "case" / file)) << file;
    const Outcome check = run("check case");
    EXPECT_EQ(check.status, 0) << check.text;
    EXPECT_THAT(check.text, AllOf(HasSubstr("non-orthogonality"), HasSubstr("sphere")));
    EXPECT_THAT(run("check case --geometry sphere.stl").text, HasSubstr("Fit to the geometry"));
    const Outcome patch = run("check case --geometry sphere.stl --patch 'sph.*'");
    EXPECT_EQ(patch.status, 0);
    EXPECT_THAT(patch.text, HasSubstr("Fit to the geometry"));
    const Outcome none = run("check case --geometry sphere.stl --patch ball");
    EXPECT_EQ(none.status, 2);
    EXPECT_THAT(none.text, AllOf(HasSubstr("'ball' (--patch)"), HasSubstr("sphere")));
}

// Quiet means quiet; regions lists a seed that mesh takes.
TEST_F(ExitStatus, RegionsAndQuiet) {
    ASSERT_EQ(run("sample sphere -o sphere.stl --quiet").status, 2); // sample has no such option
    ASSERT_EQ(run("sample sphere -o sphere.stl").status, 0);
    const Outcome regions = run("regions sphere.stl --size 0.2 --box -1 -1 -1 1 1 1");
    ASSERT_EQ(regions.status, 0) << regions.text;
    EXPECT_THAT(regions.text, HasSubstr("--seed "));
    const Outcome quiet = run("mesh sphere.stl --size 0.2 --box -1 -1 -1 1 1 1 --quiet --format report");
    EXPECT_EQ(quiet.status, 0);
    EXPECT_EQ(quiet.text, "");
}

// A duct without its inlet: where the flow must not reach is told with the opening on the way, 1; with its inlet it is meshed.
TEST_F(ExitStatus, LeaksAreTold) {
    ASSERT_EQ(run("sample tunnel -o parts").status, 0);
    const std::string rest = " parts/wall.stl parts/outlet.stl --size 0.04 --keep-out duct=1,0,0.15 --quiet --format report --out case";
    const Outcome open = run("mesh" + rest);
    EXPECT_EQ(open.status, 1) << open.text;
    EXPECT_THAT(open.text, AllOf(HasSubstr("the flow and 'duct' reach each other: an opening beside wall"), HasSubstr("the widest of 1 opening")));
    EXPECT_FALSE(std::filesystem::exists(folder_ / "case"));
    const Outcome air = run("mesh parts/wall.stl --size 0.04 --keep-out 1,0,2 --quiet --format report --out case");
    EXPECT_EQ(air.status, 1);
    EXPECT_THAT(air.text, AllOf(HasSubstr("nothing narrow is between them"), HasSubstr("give another place to keep out of")));
    const Outcome regions = run("regions" + rest);
    EXPECT_EQ(regions.status, 0) << regions.text;
    EXPECT_THAT(regions.text, HasSubstr("leak 0."));
    EXPECT_FALSE(std::filesystem::exists(folder_ / "case/leaks.ply")); // not asked for
    ASSERT_EQ(run("regions parts/wall.stl parts/outlet.stl --size 0.04 --keep-out duct=1,0,0.15 --quiet --format ply,report --out seen").status, 0);
    EXPECT_TRUE(std::filesystem::exists(folder_ / "seen/leaks.ply"));
    const Outcome closed = run("mesh parts/inlet.stl" + rest);
    EXPECT_EQ(closed.status, 0) << closed.text;
    EXPECT_EQ(closed.text, "");
}

// 130: Ctrl-C ends a long run soon, and leaves no trace of it.
TEST_F(ExitStatus, InterruptLeavesNothing) {
    ASSERT_EQ(run("sample engine -o engine.stl").status, 0);
    const Outcome stopped =
        run("mesh engine.stl --size 0.004 --out case & p=$!; sleep 1; kill -INT $p; wait $p");
    EXPECT_EQ(stopped.status, 130) << stopped.text;
    EXPECT_THAT(stopped.text, HasSubstr("interrupted"));
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_), {}), 1);
}

} // namespace
} // namespace i2b
