#include "i2b/write/foam_write.h"
#include "write/mesh_samples.h"
#include <cstdlib>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

namespace i2b {
namespace {

namespace fs = std::filesystem;
using test::contents, test::Ran, test::shell, test::TempFolder;

void writeCase(const PolyMesh& mesh, const fs::path& target, bool ascii) {
    AtomicFolder folder(target);
    writeFoam(mesh, folder, {.ascii = ascii, .note = {}}, Context());
    folder.commit();
}

// The environment OpenFOAM's programs want; empty where it is not installed.
std::string openfoam() {
    if (std::getenv("WM_PROJECT_DIR")) return " ";
    if (!fs::exists("/usr/share/openfoam/etc/controlDict")) return "";
    return "WM_PROJECT_DIR=/usr/share/openfoam ";
}

bool hasProgram(const std::string& name) { return shell("command -v " + name).status == 0; }

PolyMesh zonedBox() {
    PolyMesh mesh = test::boxMesh({4, 3, 2});
    mesh.zones = {{"left zone", {0, 1, 4, 5}}, {"rest", {2, 3}}, {"none", {}}};
    return mesh;
}

class FoamWrite : public testing::TestWithParam<bool> {};

// OpenFOAM's own checkMesh reads the case, text and binary, and finds the cells, their kinds, zones and total
// volume.
TEST_P(FoamWrite, CheckMeshAcceptsTheCase) {
    if (openfoam().empty() || !hasProgram("checkMesh")) GTEST_SKIP() << "OpenFOAM is not installed";
    const TempFolder temp;
    writeCase(zonedBox(), temp / "box", GetParam());
    const Ran box = shell(openfoam() + "checkMesh -case " + (temp / "box").string());
    EXPECT_EQ(box.status, 0);
    EXPECT_THAT(box.text,
                testing::AllOf(testing::HasSubstr("Mesh OK."), testing::ContainsRegex("hexahedra: +24"),
                               testing::ContainsRegex("Total volume = 24\\."),
                               testing::ContainsRegex("cell zones: +3")));
    writeCase(test::zooMesh(), temp / "zoo", GetParam());
    const Ran zoo = shell(openfoam() + "checkMesh -case " + (temp / "zoo").string());
    EXPECT_EQ(zoo.status, 0);
    // OpenFOAM calls the prism with two triangles a prism.
    EXPECT_THAT(zoo.text,
                testing::AllOf(
                    testing::ContainsRegex("hexahedra: +1"), testing::ContainsRegex("prisms: +1"),
                    testing::ContainsRegex("pyramids: +1"), testing::ContainsRegex("tetrahedra: +1"),
                    testing::ContainsRegex("polyhedra: +1"), testing::ContainsRegex("Total volume = 3\\.")));
}

// VTK's reader of OpenFOAM cases, ParaView's, reads both forms.
TEST_P(FoamWrite, VtkOpensTheCase) {
    if (shell("/usr/bin/python3 -c 'import vtkmodules'").status != 0)
        GTEST_SKIP() << "python3-vtk9 is not installed";
    const TempFolder temp;
    writeCase(zonedBox(), temp / "box", GetParam());
    test::put(temp / "read.py",
              "import sys\nfrom vtkmodules.vtkIOGeometry import vtkOpenFOAMReader\n"
              "r = vtkOpenFOAMReader(); r.SetFileName(sys.argv[1]); r.ReadZonesOn(); r.UpdateInformation()\n"
              "r.EnableAllPatchArrays(); r.Update(); o = r.GetOutput(); it = o.NewIterator(); n = []\n"
              "it.InitTraversal()\n"
              "while not it.IsDoneWithTraversal(): n.append(it.GetCurrentDataObject().GetNumberOfCells()); "
              "it.GoToNextItem()\n"
              "print(sorted(n))\n");
    const Ran ran =
        shell("/usr/bin/python3 " + (temp / "read.py").string() + " " + (temp / "box/case.foam").string());
    // Zones of 0, 2 and 4 cells, patches of 12 and 40 faces, 24 cells.
    EXPECT_THAT(ran.text, testing::HasSubstr("[0, 2, 4, 12, 24, 40]"));
}

// The minimal system/ holds what a flow solver needs: potentialFoam runs on the case with fields of the
// user's.
TEST_P(FoamWrite, PotentialFoamRuns) {
    if (openfoam().empty() || !hasProgram("potentialFoam")) GTEST_SKIP() << "OpenFOAM is not installed";
    const TempFolder temp;
    writeCase(test::boxMesh({4, 4, 4}), temp / "box", GetParam());
    test::put(
        temp / "box/0/U",
        "FoamFile{version 2.0; format ascii; class volVectorField; object U;}\ndimensions [0 1 -1 0 0 0 0];\n"
        "internalField uniform (0 0 0);\nboundaryField{bottom{type slip;} sides{type freestream; "
        "freestreamValue uniform (1 0 0);}}\n");
    test::put(
        temp / "box/0/p",
        "FoamFile{version 2.0; format ascii; class volScalarField; object p;}\ndimensions [0 2 -2 0 0 0 0];\n"
        "internalField uniform 0;\nboundaryField{bottom{type zeroGradient;} sides{type fixedValue; value "
        "uniform 0;}}\n");
    const Ran ran = shell(openfoam() + "potentialFoam -case " + (temp / "box").string());
    EXPECT_EQ(ran.status, 0) << ran.text;
    EXPECT_THAT(ran.text, testing::HasSubstr("Interpolated velocity error"));
}

// The same bytes on one thread and on three.
TEST_P(FoamWrite, SameBytesOnAnyNumberOfThreads) {
    const TempFolder temp;
    PolyMesh mesh = test::boxMesh({40, 41, 42}, 0.1);
    mesh.zones = {{"a", {1, 2}}};
    for (const std::size_t threads : {1, 3}) {
        const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
        writeCase(mesh, temp / std::to_string(threads), GetParam());
    }
    for (const char* name : {"points", "faces", "owner", "neighbour", "boundary", "cellZones"}) {
        const std::string one = contents(temp / "1" / "constant/polyMesh" / name);
        EXPECT_GT(one.size(), 200u) << name;
        EXPECT_EQ(one, contents(temp / "3" / "constant/polyMesh" / name)) << name;
    }
}

INSTANTIATE_TEST_SUITE_P(Forms, FoamWrite, testing::Bool(),
                         [](const auto& p) { return p.param ? "text" : "binary"; });

// Text gives back the same doubles, to the last bit, and the counts in the owner's note are right.
TEST(FoamWriteText, ShortestDigitsAndNote) {
    const TempFolder temp;
    PolyMesh mesh = test::boxMesh({1, 1, 1});
    mesh.points[1].x = 0.1 + 0.2;
    mesh.points[2].y = -1e-300;
    writeCase(mesh, temp / "c", true);
    const std::string points = contents(temp / "c/constant/polyMesh/points");
    EXPECT_THAT(points, testing::HasSubstr("(0.30000000000000004 0 0)\n"));
    EXPECT_THAT(points, testing::HasSubstr("-1e-300"));
    EXPECT_THAT(contents(temp / "c/constant/polyMesh/owner"),
                testing::HasSubstr("\"nPoints:8  nCells:1  nFaces:6  nInternalFaces:0\""));
    EXPECT_THAT(contents(temp / "c/constant/polyMesh/faces"), testing::HasSubstr("6\n(\n4(2 3 1 0)\n"));
}

// The user's own system files are not touched by a second run.
TEST(FoamWriteText, KeepsTheUsersDictionaries) {
    const TempFolder temp;
    test::put(temp / "c/system/controlDict", "mine");
    writeCase(test::boxMesh({1, 1, 1}), temp / "c", false);
    EXPECT_EQ(contents(temp / "c/system/controlDict"), "mine");
    EXPECT_THAT(contents(temp / "c/system/fvSolution"), testing::HasSubstr("potentialFlow"));
}

// Names become words that OpenFOAM reads, and stay distinct.
TEST(FoamNames, AreWordsAndDistinct) {
    EXPECT_THAT(foamNames({"wall", "a b", "a_b", "1st", "", "x{y;}"}),
                testing::ElementsAre("wall", "a_b", "a_b_2", "_1st", "_", "x_y__"));
}

} // namespace
} // namespace i2b
