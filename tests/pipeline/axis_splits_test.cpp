// Proves: OpenFOAM's checkMesh finds nothing wrong with the topology, the volumes and the orientation of meshes on grids
// whose cells split along axes of their own choice at random, with walls at random and one or three layers.
#include "carve/kept_checks.h"
#include "i2b/assemble/assemble.h"
#include "i2b/fit/fit.h"
#include "i2b/write/atomic_folder.h"
#include "i2b/write/foam_write.h"
#include <cstdlib>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <gtest/gtest.h>
#include <sstream>
#include <unistd.h>

namespace i2b::test {
namespace {

namespace fs = std::filesystem;

PolyMesh meshOf(const CarvedAtRandom& c, int layers) {
    const LatticeMesh lattice(c.grid, c.kept);
    Front front = buildFront(lattice, startThickness);
    LayerOptions options;
    options.count = layers;
    const LayerStack stack = makeLayers(front, options);
    const std::vector<Part> parts{{"wall", "", 1}};
    return assemble({lattice, c.kept, front, stack, parts});
}

std::string checkMesh(const PolyMesh& mesh, const fs::path& folder) {
    AtomicFolder out(folder);
    writeFoam(mesh, out, {.ascii = false, .caseFiles = true, .note = {}}, Context());
    out.commit();
    const fs::path log = folder / "check.log";
    if (std::system(fmt::format("checkMesh -case '{}' -allTopology > '{}' 2>&1", folder.string(), log.string()).c_str()) != 0) return "";
    std::ifstream in(log);
    std::stringstream text;
    text << in.rdbuf();
    return text.str();
}

class AxisSplits : public testing::TestWithParam<unsigned> {};

TEST_P(AxisSplits, HaveATopologyThatCheckMeshTakes) {
    if (std::system("command -v checkMesh > /dev/null") != 0) GTEST_SKIP() << "OpenFOAM's checkMesh is not installed";
    if (!std::getenv("WM_PROJECT_DIR")) setenv("WM_PROJECT_DIR", "/usr/share/openfoam", 1);
    const unsigned seed = GetParam();
    const fs::path folder = fs::temp_directory_path() / fmt::format("i2b_axis_splits_{}_{}", seed, getpid());
    const CarvedAtRandom c(seed, {6, 5, 7}, 2 + static_cast<int>(seed % 3), 1, 0.05 * (seed % 4), true);
    ASSERT_TRUE(std::any_of(c.grid.levels.begin(), c.grid.levels.end(), [](const CellLevel& l) { return !l.level.same(); }));
    const std::string log = checkMesh(meshOf(c, seed % 2 ? 1 : 3), folder);
    for (const char* line : {"Point usage OK.", "Upper triangular ordering OK.", "Face vertices OK.", "Topological cell zip-up check OK.",
                             "Face-face connectivity OK.", "Number of regions: 1 (OK).", "Cell volumes OK.", "Face pyramids OK."}) {
        EXPECT_NE(log.find(line), std::string::npos) << "seed " << seed << ": " << line << '\n' << log;
    }
    fs::remove_all(folder);
}

INSTANTIATE_TEST_SUITE_P(Seeds, AxisSplits, testing::Range(1u, 13u));

} // namespace
} // namespace i2b::test
