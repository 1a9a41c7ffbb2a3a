// Real files, where they are: the numbers are those that their own sources state.
#include "geometry_files.h"
#include <gmock/gmock.h>
#include <set>
#include <tbb/global_control.h>

namespace i2b::test {
namespace {

const std::string examples = "/usr/share/doc/openfoam-examples/examples/resources/geometry/";

void expectFigures(const std::vector<std::string>& files, std::size_t triangles, std::size_t parts,
                   double scale = 1) {
    for (const std::string& file : files)
        if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is not here";
    std::set<std::uint64_t> sums;
    for (const std::size_t threads : {1u, 3u}) {
        const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
        const auto r = read(files, scale);
        ASSERT_FALSE(r.error) << r.error->what();
        EXPECT_EQ(r.surface.triangles.size(), triangles);
        EXPECT_EQ(r.surface.parts.size(), parts);
        for (const Part& part : r.surface.parts)
            EXPECT_THAT(part.name, testing::MatchesRegex("[A-Za-z_][A-Za-z0-9_.-]*"));
        sums.insert(r.surface.checksum());
    }
    EXPECT_EQ(sums.size(), 1u) << "the same on 1 and 3 threads";
}

// Proves: all triangles and parts of the car in three files.
TEST(ReadReal, DrivAer) {
    expectFigures({realFile("drivaer-body.obj.gz"), realFile("drivaer-frontWheels.obj.gz"),
                   realFile("drivaer-rearWheels.obj.gz")},
                  417114, 3);
}

// Proves: an assembly with a group for every solid.
TEST(ReadReal, Engine) { expectFigures({realFile("engine-2cyl.obj.gz")}, 121496, 115, 0.001); }

// Proves: group names with colons and percent signs become words and stay apart.
TEST(ReadReal, MotorBike) { expectFigures({examples + "motorBike.obj.gz"}, 331653, 67); }

// Proves: an ASCII STL with several solids (4 of 4 keep their names).
TEST(ReadReal, Flange) {
    const std::string file = examples + "flange.stl.gz";
    if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is not here";
    const auto r = read({file});
    ASSERT_FALSE(r.error) << r.error->what();
    EXPECT_THAT(partNames(r.surface), testing::ElementsAre("patch1", "patch2", "patch3", "patch4"));
}

} // namespace
} // namespace i2b::test
