// Holds every figure against what checkMesh says of the same mesh, with all 17 digits of a double, which it
// prints where the case's writePrecision says so. OpenFOAM's programs need WM_PROJECT_DIR to point at their
// etc folder's parent, which Debian's package does not set.
#include "cell_mesh.h"
#include "checkmesh_figures.h"
#include "i2b/quality/quality_report.h"
#include "i2b/write/foam_read.h"
#include <cstdlib>
#include <filesystem>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <fstream>
#include <gmock/gmock.h>
#include <numbers>
#include <random>
#include <regex>
#include <sstream>
#include <unistd.h>

namespace i2b::test {
namespace {

namespace fs = std::filesystem;

bool hasProgram(const char* name) {
    return std::system(fmt::format("command -v {} >/dev/null 2>&1", name).c_str()) == 0;
}

void writeText(const fs::path& path, const std::string& text) {
    fs::create_directories(path.parent_path());
    std::ofstream(path) << text;
}

std::string readText(const fs::path& path) {
    std::ifstream in(path);
    std::stringstream text;
    text << in.rdbuf();
    return text.str();
}

std::string foamFile(const char* type, const char* object) {
    return fmt::format("FoamFile {{ version 2.0; format ascii; class {}; object {}; }}\n", type, object);
}

constexpr const char* cube = "((0 0 0) (1 0 0) (1 1 0) (0 1 0) (0 0 1) (1 0 1) (1 1 1) (0 1 1))";
constexpr const char* skewed =
    "((0 0 0) (1.2 0.1 0) (1.4 1 0.2) (0.1 1.1 0) (0.3 0 1.5) (1.3 0 1) (1 1.3 1) (0 1 1))";
constexpr const char* twoPatches = "low { type wall; faces ((0 3 2 1)); } rest { type patch; faces ((4 5 6 "
                                   "7) (0 1 5 4) (1 2 6 5) (2 3 7 6) (3 0 4 7)); }";

// A case in a folder of its own that goes away with the test.
class CheckMesh : public testing::Test {
  protected:
    void SetUp() override {
        if (!hasProgram("checkMesh") || !hasProgram("blockMesh"))
            GTEST_SKIP() << "OpenFOAM's checkMesh and blockMesh are not installed";
        if (std::getenv("WM_PROJECT_DIR") == nullptr) setenv("WM_PROJECT_DIR", "/usr/share/openfoam", 1);
        const std::string name = testing::UnitTest::GetInstance()->current_test_info()->name();
        folder_ = fs::temp_directory_path() / fmt::format("i2b_checkmesh_{}_{}", name, getpid());
        fs::remove_all(folder_);
        writeControl("ascii");
        writeText(folder_ / "system/fvSchemes",
                  foamFile("dictionary", "fvSchemes") + "gradSchemes {} divSchemes {} laplacianSchemes {}\n");
        writeText(folder_ / "system/fvSolution", foamFile("dictionary", "fvSolution"));
    }
    void TearDown() override {
        if (!folder_.empty() && !HasFailure()) fs::remove_all(folder_);
    }

    void writeControl(const char* format, bool compressed = false) const {
        writeText(
            folder_ / "system/controlDict",
            foamFile("dictionary", "controlDict") +
                fmt::format("startFrom startTime; startTime 0; stopAt endTime; endTime 1; deltaT 1;\n"
                            "writeControl timeStep; writeInterval 1; writeFormat {}; writePrecision 17;\n"
                            "writeCompression {};\n",
                            format, compressed ? "on" : "off"));
    }

    void run(const std::string& command) const {
        const std::string line = fmt::format("cd '{}' && {} > log 2>&1", folder_.string(), command);
        ASSERT_EQ(std::system(line.c_str()), 0) << command << "\n" << readText(folder_ / "log");
    }

    void blockMesh(const std::string& vertices, const std::string& blocks, const std::string& patches,
                   const std::string& edges = "") const {
        writeText(folder_ / "system/blockMeshDict",
                  foamFile("dictionary", "blockMeshDict") +
                      fmt::format("scale 1;\nvertices {};\nblocks ({});\nedges ({});\nboundary ({});\n"
                                  "mergePatchPairs ();\n",
                                  vertices, blocks, edges, patches));
        run("blockMesh");
    }

    // A mesh as text, faults and all.
    void writeMesh(const PolyMesh& mesh) const {
        const fs::path folder = folder_ / "constant/polyMesh";
        std::string points = foamFile("vectorField", "points") + fmt::format("{}\n(\n", mesh.points.size());
        for (const Vec3& p : mesh.points) points += fmt::format("({:.17g} {:.17g} {:.17g})\n", p.x, p.y, p.z);
        writeText(folder / "points", points + ")\n");
        std::string faces = foamFile("faceList", "faces") + fmt::format("{}\n(\n", mesh.faces());
        for (std::int32_t f = 0; f < mesh.faces(); ++f)
            faces += fmt::format("{}({})\n", mesh.face(f).size(), fmt::join(mesh.face(f), " "));
        writeText(folder / "faces", faces + ")\n");
        const auto labels = [&](const char* name, std::span<const std::int32_t> values) {
            writeText(folder / name,
                      foamFile("labelList", name) +
                          fmt::format("{}\n(\n{}\n)\n", values.size(), fmt::join(values, "\n")));
        };
        labels("owner", mesh.owner);
        labels("neighbour", mesh.neighbour);
        std::string boundary =
            foamFile("polyBoundaryMesh", "boundary") + fmt::format("{}\n(\n", mesh.patches.size());
        for (const Patch& p : mesh.patches)
            boundary += fmt::format("{} {{ type {}; inGroups 1(walls); nFaces {}; startFace {}; }}\n", p.name,
                                    p.type, p.count, p.start);
        writeText(folder / "boundary", boundary + ")\n");
    }

    // Moves every point by up to amplitude along each axis.
    void perturb(double amplitude) const {
        PolyMesh mesh = readFoam(folder_.string());
        std::mt19937 random(11);
        std::uniform_real_distribution<double> step(-amplitude, amplitude);
        for (Vec3& p : mesh.points)
            for (int k = 0; k < 3; ++k) p[k] += step(random);
        writeMesh(mesh);
    }

    // Returns our report for further questions.
    QualityReport expectSame() const {
        run("checkMesh -allTopology -allGeometry");
        const QualityReport report = measureQuality(readFoam(folder_.string()));
        compareWithCheckMesh(readText(folder_ / "log"), report);
        expectConsistentText(report);
        return report;
    }

    // The same of the limits of the mesh quality dictionary. Returns how many faces are beyond any.
    std::int64_t expectSameLimits(const DictionaryLimits& limits) const {
        writeText(folder_ / "system/meshQualityDict",
                  foamFile("dictionary", "meshQualityDict") +
                      fmt::format("maxNonOrtho {}; minVol {}; minTetQuality {}; maxConcave {}; minArea {};\n"
                                  "maxInternalSkewness {}; maxBoundarySkewness {}; minFaceWeight {}; minVolRatio {};\n"
                                  "minTwist {}; minTriangleTwist {}; minFaceFlatness {}; minDeterminant {};\n",
                                  limits.nonOrthogonality, limits.pyramidVolume, limits.tetQuality, limits.concavity,
                                  limits.faceArea, limits.internalSkewness, limits.boundarySkewness, limits.faceWeight,
                                  limits.volumeRatio, limits.twist, limits.triangleTwist, limits.flatness, limits.determinant));
        run("checkMesh -meshQuality");
        const QualityReport report = measureQuality(readFoam(folder_.string()), {}, limits);
        compareWithMeshQuality(readText(folder_ / "log"), report);
        return report.dictionaryFaces;
    }

    // With the usual limits; with strict ones, and with each of these alone, so that none hides behind another. Returns how
    // many of the latter some face is beyond.
    int expectSameLimits() const {
        expectSameLimits(DictionaryLimits{});
        const DictionaryLimits off{180, -1e30, -1e30, 180, -1, -1, -1, -1, -1, -1, -1, -1, -1};
        const DictionaryLimits strict{25, 4e-6, 0.3, 5, 5e-4, 0.4, 0.5, 0.45, 0.7, 0.97, 0.995, 0.9, 0.6};
        expectSameLimits(strict);
        int reached = 0;
        for (double DictionaryLimits::*limit :
             {&DictionaryLimits::nonOrthogonality, &DictionaryLimits::pyramidVolume, &DictionaryLimits::tetQuality,
              &DictionaryLimits::concavity, &DictionaryLimits::faceArea, &DictionaryLimits::internalSkewness,
              &DictionaryLimits::boundarySkewness, &DictionaryLimits::faceWeight, &DictionaryLimits::volumeRatio,
              &DictionaryLimits::twist, &DictionaryLimits::triangleTwist, &DictionaryLimits::flatness,
              &DictionaryLimits::determinant}) {
            DictionaryLimits alone = off;
            alone.*limit = strict.*limit;
            if (limit == &DictionaryLimits::internalSkewness) alone.boundarySkewness = 1e9; // of the pair one asks for both
            if (limit == &DictionaryLimits::boundarySkewness) alone.internalSkewness = 1e9;
            reached += expectSameLimits(alone) > 0 ? 1 : 0;
        }
        return reached;
    }

    // The ids in a set that checkMesh wrote.
    std::vector<std::int32_t> writtenSet(const char* name) const {
        const std::string text = readText(folder_ / "constant/polyMesh/sets" / name);
        std::vector<std::int32_t> ids;
        std::istringstream in(text.substr(text.find('(', text.find("// * *")) + 1));
        for (std::int32_t id = 0; in >> id;) ids.push_back(id);
        std::sort(ids.begin(), ids.end());
        return ids;
    }

    // Members of each set, not only their number.
    void expectSameSets(const QualityReport& report) const {
        for (const QualityCheck& check : report.checks) {
            std::vector<std::int32_t> theirs = writtenSet(check.name.c_str());
            EXPECT_EQ(theirs.size(), static_cast<std::size_t>(check.count)) << check.name;
            theirs.resize(std::min(theirs.size(), check.ids.size()));
            EXPECT_EQ(check.ids, theirs) << check.name;
        }
    }

    // The text's verdicts are the report's.
    static void expectConsistentText(const QualityReport& report) {
        const std::string text = formatQuality(report, 17);
        const std::regex fails("FAILS");
        EXPECT_EQ(std::distance(std::sregex_iterator(text.begin(), text.end(), fails), {}),
                  report.failedChecks);
        EXPECT_THAT(text, testing::ContainsRegex(report.ok() ? std::string("\nall checks pass\n$")
                                                             : fmt::format("\n{} of [0-9]+ checks fail\n$",
                                                                           report.failedChecks)));
    }

    fs::path folder_;
};

// A plane cavity: empty patches take out a direction, points are all on the boundary, so edges are counted. A
// Cartesian mesh shows round-off in openness and skewness, which must agree as well.
TEST_F(CheckMesh, PlaneCavity) {
    blockMesh(
        "((0 0 0) (0.1 0 0) (0.1 0.1 0) (0 0.1 0) (0 0 0.01) (0.1 0 0.01) (0.1 0.1 0.01) (0 0.1 0.01))",
        "hex (0 1 2 3 4 5 6 7) (20 20 1) simpleGrading (1 1 1)",
        "lid { type wall; faces ((3 7 6 2)); } walls { type wall; faces ((0 4 7 3) (2 6 5 1) (1 5 4 0)); }"
        "sides { type empty; faces ((0 3 2 1) (4 5 6 7)); }");
    const QualityReport r = expectSame();
    EXPECT_THAT(r.geometricDirections, testing::ElementsAre(1, 1, 0));
    EXPECT_GT(r.statistics.edges, 0);
}

// Graded, sheared and with a curved edge, in three dimensions: every average is a true average.
TEST_F(CheckMesh, GradedAndSheared) {
    blockMesh(skewed, "hex (0 1 2 3 4 5 6 7) (20 24 18) simpleGrading (3 0.5 ((0.5 0.5 4) (0.5 0.5 0.25)))",
              twoPatches, "arc 0 1 (0.5 -0.2 0)");
    const QualityReport r = expectSame();
    EXPECT_GT(r.maxNonOrthogonality, 10);
    expectSameSets(r);
    EXPECT_GE(expectSameLimits(), 4);
}

// The same mesh in each way OpenFOAM writes it: binary, and compressed.
TEST_F(CheckMesh, BinaryAndCompressed) {
    for (const auto& [format, compressed] : {std::pair("binary", false), std::pair("ascii", true)}) {
        writeControl(format, compressed);
        fs::remove_all(folder_ / "constant");
        blockMesh(skewed, "hex (0 1 2 3 4 5 6 7) (9 8 7) simpleGrading (2 1 1)", twoPatches);
        EXPECT_EQ(fs::exists(folder_ / "constant/polyMesh/points.gz"), compressed);
        expectSame();
    }
}

// An empty direction that the edges do not keep to.
TEST_F(CheckMesh, MisalignedEdges) {
    blockMesh(skewed, "hex (0 1 2 3 4 5 6 7) (6 7 5) simpleGrading (1 1 1)",
              "low { type wall; faces ((0 3 2 1)); } sides { type empty; faces ((4 5 6 7)); }");
    EXPECT_GT(expectSame().misalignedEdges, 0);
}

// Points moved at random: a little (nothing fails), more, and so far that nearly every check fails and most
// cells are turned over. Sets must have the same members.
TEST_F(CheckMesh, Perturbed) {
    for (const double amplitude : {0.003, 0.02, 0.3}) {
        blockMesh(cube, "hex (0 1 2 3 4 5 6 7) (18 19 20) simpleGrading (1 2 1)", twoPatches);
        perturb(amplitude);
        const QualityReport r = expectSame();
        expectSameSets(r);
        const int reached = expectSameLimits();
        if (amplitude > 0.1) {
            EXPECT_GE(r.failedChecks, 8);
            EXPECT_EQ(reached, 12); // all but flatness, which no face can be below
        }
    }
}

// Cells as thin as sheets, edges shorter than a millionth of the mesh: high aspect ratios, short edges, near
// points.
TEST_F(CheckMesh, ThinCells) {
    blockMesh(cube, "hex (0 1 2 3 4 5 6 7) (5 5 40) simpleGrading (1 1 1e7)", twoPatches);
    const QualityReport r = expectSame();
    EXPECT_GT(r.highAspectRatioCells, 0);
    EXPECT_GT(r.shortEdgePoints, 0);
    expectSameSets(r);
    EXPECT_GE(expectSameLimits(), 5);
}

// Two blocks that touch nowhere.
TEST_F(CheckMesh, SeveralRegions) {
    const std::string second = " (3 0 0) (4 0 0) (4 1 0) (3 1 0) (3 0 1) (4 0 1) (4 1 1) (3 1 1))";
    const std::string first = std::string(cube).substr(0, std::string(cube).size() - 1);
    blockMesh(first + second,
              "hex (0 1 2 3 4 5 6 7) (4 4 4) simpleGrading (1 1 1) "
              "hex (8 9 10 11 12 13 14 15) (3 4 4) simpleGrading (1 1 1)",
              "low { type wall; faces ((0 3 2 1) (8 11 10 9)); }");
    EXPECT_EQ(expectSame().regions.size(), 2U);
}

// Faults of topology, each in a mesh of a few cells: what blockMesh cannot make.
TEST_F(CheckMesh, FaultsByHand) {
    const auto hold = [&](const PolyMesh& mesh, const char* set) {
        SCOPED_TRACE(set);
        fs::remove_all(folder_ / "constant");
        writeMesh(mesh);
        const QualityReport report = expectSame();
        EXPECT_NE(findCheck(report, set), nullptr);
        expectSameSets(report);
        expectSameLimits(DictionaryLimits{});
    };
    hold(levelJump(), "concaveCells");
    hold(cubesAtCorner(), "multiRegionPoints");
    hold(cubesAtEdge(), "nonManifoldPoints");
    hold(cubesWithBaffle(), "edgeFaces");
    PolyMesh mesh = levelJump(); // faces out of order
    std::swap(mesh.neighbour[0], mesh.neighbour[1]);
    std::swap_ranges(mesh.faceVertices.begin(), mesh.faceVertices.begin() + 4, mesh.faceVertices.begin() + 4);
    hold(mesh, "upperTriangularFace");
    mesh = columnOf({square(0), square(1), square(2)}); // a point of no face
    mesh.points.push_back({0.5, 0.5, 3});
    hold(mesh, "unusedPoints");
    mesh = columnOf({square(0), square(1), square(2)}); // one boundary face less
    mesh.owner.pop_back();
    mesh.faceOffsets.pop_back();
    mesh.faceVertices.resize(mesh.faceOffsets.back());
    --mesh.patches[0].count;
    hold(mesh, "zipUpCells");
    mesh = columnOf({square(0), square(1), square(2)}); // two corners of a face exchanged
    std::swap(mesh.faceVertices[0], mesh.faceVertices[1]);
    hold(mesh, "edgeFaces");
    mesh = columnOf({square(0), square(1), square(1)}); // a cell of no height
    hold(mesh, "zeroVolumeCells");
}

// Outlines of faces in disorder: pairs that share two, three or four points in every kind of sequence.
TEST_F(CheckMesh, ShuffledOutlines) {
    std::mt19937 random(3);
    std::int64_t odd = 0;
    for (int trial = 0; trial < 12; ++trial) {
        PolyMesh mesh = levelJump();
        if (trial % 2 == 1) { // hexagonal prisms on each other, with points to spare
            std::vector<Vec3> points;
            std::vector<CellLoops> cells;
            for (int level = 0; level < 4; ++level)
                for (int i = 0; i < 6; ++i)
                    points.push_back({std::cos(i * std::numbers::pi / 3), std::sin(i * std::numbers::pi / 3),
                                      double(level)});
            for (std::int32_t base = 0; base < 18; base += 6) {
                CellLoops prism{{base + 5, base + 4, base + 3, base + 2, base + 1, base},
                                {base + 6, base + 7, base + 8, base + 9, base + 10, base + 11}};
                for (std::int32_t i = 0; i < 6; i += 2) // two sides in one face
                    prism.push_back({base + i, base + i + 1, base + (i + 2) % 6, base + 6 + (i + 2) % 6,
                                     base + 7 + i, base + 6 + i});
                cells.push_back(prism);
            }
            mesh = meshOfCells(std::move(points), cells);
        }
        for (std::int32_t f = 0; f < mesh.faces(); ++f)
            if (random() % 3 == 0)
                std::shuffle(mesh.faceVertices.begin() + mesh.faceOffsets[std::size_t(f)],
                             mesh.faceVertices.begin() + mesh.faceOffsets[std::size_t(f) + 1], random);
        SCOPED_TRACE(trial);
        fs::remove_all(folder_ / "constant");
        writeMesh(mesh);
        const QualityReport report = expectSame();
        expectSameSets(report);
        odd += report.nonConsecutiveFaces;
    }
    EXPECT_GT(odd, 50);
}

// A wedge of five degrees around an axis: prisms at the axis, a geometric direction less than solution
// directions.
TEST_F(CheckMesh, Wedge) {
    const double y = std::tan(2.5 * std::numbers::pi / 180);
    blockMesh(
        fmt::format("((0 0 0) (1 {0:.17g} 0) (1 {0:.17g} 1) (0 0 1) (1 -{0:.17g} 0) (1 -{0:.17g} 1))", y),
        "hex (0 4 1 0 3 5 2 3) (10 1 12) simpleGrading (2 1 1)",
        "front { type wedge; faces ((0 4 5 3)); } back { type wedge; faces ((0 1 2 3)); }"
        "outer { type wall; faces ((4 1 2 5)); } ends { type patch; faces ((0 4 1 0) (3 5 2 3)); }"
        "axis { type empty; faces ((0 0 3 3)); }");
    const QualityReport r = expectSame();
    EXPECT_EQ(r.statistics.prisms, 12);
    EXPECT_EQ(r.wedges.size(), 2U);
    expectSameLimits();
}

// Polyhedra, hanging nodes, layers and zones as another mesher makes them: a sphere in a box.
TEST_F(CheckMesh, SnappySphere) {
    if (!hasProgram("snappyHexMesh")) GTEST_SKIP() << "OpenFOAM's snappyHexMesh is not installed";
    std::string stl = "solid sphere\n";
    const auto at = [](int i, int j) {
        const double a = i * std::numbers::pi / 12, b = j * std::numbers::pi / 12;
        return fmt::format("{:.9g} {:.9g} {:.9g}", 0.3 * std::sin(a) * std::cos(b),
                           0.3 * std::sin(a) * std::sin(b), 0.3 * std::cos(a));
    };
    const auto triangle = [&](const std::string& a, const std::string& b, const std::string& c) {
        stl += fmt::format(
            "facet normal 0 0 0\nouter loop\nvertex {}\nvertex {}\nvertex {}\nendloop\nendfacet\n", a, b, c);
    };
    for (int i = 0; i < 12; ++i)
        for (int j = 0; j < 24; ++j) {
            if (i < 11) triangle(at(i, j), at(i + 1, j), at(i + 1, (j + 1) % 24));
            if (i > 0) triangle(at(i, j), at(i + 1, (j + 1) % 24), at(i, (j + 1) % 24));
        }
    writeText(folder_ / "constant/triSurface/sphere.stl", stl + "endsolid sphere\n");
    writeText(folder_ / "system/snappyHexMeshDict", foamFile("dictionary", "snappyHexMeshDict") + R"(
castellatedMesh true; snap true; addLayers true; mergeTolerance 1e-6;
geometry { sphere.stl { type triSurfaceMesh; name sphere; }
           ball { type searchableSphere; centre (0.6 0.6 0.6); radius 0.2; } }
castellatedMeshControls { maxLocalCells 100000; maxGlobalCells 200000; minRefinementCells 0; nCellsBetweenLevels 1;
  features (); refinementSurfaces { sphere { level (2 3); }
    ball { level (1 1); faceZone ball; cellZone ball; cellZoneInside inside; } }
  resolveFeatureAngle 30; refinementRegions {}; locationInMesh (-0.71 -0.72 -0.73); allowFreeStandingZoneFaces true; }
snapControls { nSmoothPatch 3; tolerance 2; nSolveIter 10; nRelaxIter 5; }
addLayersControls { relativeSizes true; layers { sphere { nSurfaceLayers 2; } } expansionRatio 1.2;
  finalLayerThickness 0.3; minThickness 0.1; nGrow 0; featureAngle 60; nRelaxIter 3; nSmoothSurfaceNormals 1;
  nSmoothNormals 3; nSmoothThickness 10; maxFaceThicknessRatio 0.5; maxThicknessToMedialRatio 0.3;
  minMedianAxisAngle 90; nBufferCellsNoExtrude 0; nLayerIter 20; }
meshQualityControls { maxNonOrtho 65; maxBoundarySkewness 20; maxInternalSkewness 4; maxConcave 80; minVol 1e-13;
  minTetQuality 1e-15; minArea -1; minTwist 0.02; minDeterminant 0.001; minFaceWeight 0.05; minVolRatio 0.01;
  minTriangleTwist -1; nSmoothScale 4; errorReduction 0.75; }
)");
    blockMesh("((-1 -1 -1) (1 -1 -1) (1 1 -1) (-1 1 -1) (-1 -1 1) (1 -1 1) (1 1 1) (-1 1 1))",
              "hex (0 1 2 3 4 5 6 7) (12 12 12) simpleGrading (1 1 1)", twoPatches);
    run("snappyHexMesh -overwrite");
    fs::remove(folder_ / "constant/polyMesh/faceZones"); // PolyMesh has none
    fs::remove(folder_ / "constant/polyMesh/pointZones");
    const QualityReport r = expectSame();
    EXPECT_GT(r.statistics.polyhedra, 0);
    EXPECT_EQ(r.zones.size(), 1U);
    expectSameSets(r);
    EXPECT_GE(expectSameLimits(), 9);
    perturb(0.01); // polyhedra and layers that are distorted
    expectSameSets(expectSame());
    EXPECT_GE(expectSameLimits(), 9);
}

} // namespace
} // namespace i2b::test
