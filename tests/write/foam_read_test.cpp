#include "i2b/core/error.h"
#include "i2b/write/foam_read.h"
#include <cstring>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <functional>
#include <gmock/gmock.h>
#include <unistd.h>

namespace i2b::test {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr const char* cubePoints = "8((0 0 0)(1 0 0)(1 1 0)(0 1 0)(0 0 1)(1 0 1)(1 1 1)(0 1 1))";
constexpr const char* cubeFaces = "6(4(0 3 2 1)4(4 5 6 7)4(0 1 5 4)4(1 2 6 5)4(2 3 7 6)4(3 0 4 7))";

std::string header(const std::string& type, const std::string& more = "format ascii;") {
    return fmt::format("/* banner // with {{ */\nFoamFile\n{{\n version 2.0; {} class {};\n}}\n// * * * //\n",
                       more, type);
}

// A list as OpenFOAM writes it in binary: its length, then the values' bytes between brackets.
template <class T>
std::string bytesOf(const std::vector<T>& values, std::size_t perEntry = 1) {
    std::string bytes(values.size() * sizeof(T), '\0');
    if (!values.empty()) std::memcpy(bytes.data(), values.data(), bytes.size());
    return fmt::format("\n{}\n(", values.size() / perEntry) + bytes + ")\n";
}

class FoamRead : public testing::Test {
  protected:
    void SetUp() override {
        const std::string name = testing::UnitTest::GetInstance()->current_test_info()->name();
        folder_ = fs::temp_directory_path() / fmt::format("i2b_foam_read_{}_{}", name, getpid());
        fs::remove_all(folder_);
        fs::create_directories(folder_ / "constant/polyMesh");
        // A unit cube: one cell, six boundary faces.
        write("points", header("vectorField") + cubePoints);
        write("faces", header("faceList") + cubeFaces);
        write("owner", header("labelList") + "6{0}");
        write("neighbour", header("labelList") + "0()");
        write("boundary",
              header("polyBoundaryMesh") + "1(all{type wall; inGroups 1(wall); nFaces 6; startFace 0;})");
    }
    void TearDown() override { fs::remove_all(folder_); }

    void write(const char* name, const std::string& content) const {
        std::ofstream(folder_ / "constant/polyMesh" / name, std::ios::binary) << content;
    }
    void expectCube() const {
        const PolyMesh mesh = readFoam(folder_.string());
        EXPECT_EQ(mesh.cells, 1);
        EXPECT_EQ(mesh.points.size(), 8U);
        EXPECT_THAT(mesh.faceOffsets, ElementsAre(0, 4, 8, 12, 16, 20, 24));
        EXPECT_THAT(mesh.faceVertices,
                    ElementsAre(0, 3, 2, 1, 4, 5, 6, 7, 0, 1, 5, 4, 1, 2, 6, 5, 2, 3, 7, 6, 3, 0, 4, 7));
        EXPECT_THAT(mesh.owner, ElementsAre(0, 0, 0, 0, 0, 0));
        EXPECT_TRUE(mesh.neighbour.empty());
        EXPECT_EQ(mesh.points.at(6), (Vec3{1, 1, 1}));
        EXPECT_THAT(mesh.face(3), ElementsAre(1, 2, 6, 5));
        EXPECT_EQ(mesh.patches.at(0).type, "wall");
    }
    void expectError(const std::string& what, const std::string& where) const {
        try {
            readFoam(folder_.string());
            ADD_FAILURE() << "no error: " << what;
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::input);
            EXPECT_THAT(error.problem(), HasSubstr(what));
            EXPECT_THAT(error.where(), HasSubstr(where));
        }
    }

    fs::path folder_;
};

// Text with everything on one line, comments, uniform and empty lists; named by case or by polyMesh folder.
TEST_F(FoamRead, Text) {
    expectCube();
    const PolyMesh direct = readFoam((folder_ / "constant/polyMesh").string());
    EXPECT_EQ(direct.points, readFoam(folder_.string()).points);
}

// Binary with the sizes of labels and scalars that the header names, faces in both forms.
TEST_F(FoamRead, BinaryOfEverySize) {
    const std::vector<std::int64_t> vertices{0, 3, 2, 1, 4, 5, 6, 7, 0, 1, 5, 4,
                                             1, 2, 6, 5, 2, 3, 7, 6, 3, 0, 4, 7};
    const std::vector<float> points{0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 0, 1, 1, 0, 1, 1, 1, 1, 0, 1, 1};
    const std::string wide = "format binary; arch \"LSB;label=64;scalar=32\";";
    const std::string narrow = "format binary; arch \"LSB;label=32;scalar=64\";";
    write("points", header("vectorField", wide) + bytesOf(points, 3));
    write("faces", header("faceCompactList", wide) + bytesOf<std::int64_t>({0, 4, 8, 12, 16, 20, 24}) +
                       bytesOf(vertices));
    write("owner", header("labelList", wide) + bytesOf(std::vector<std::int64_t>(6, 0)));
    write("neighbour", header("labelList", wide) + "\n0\n");
    expectCube();
    write("points",
          header("vectorField", narrow) + bytesOf(std::vector<double>(points.begin(), points.end()), 3));
    std::string faces = "6(";
    for (std::size_t f = 0; f < 6; ++f)
        faces += bytesOf(std::vector<std::int32_t>(vertices.begin() + std::ptrdiff_t(4 * f),
                                                   vertices.begin() + std::ptrdiff_t(4 * f + 4)));
    write("faces", header("faceList", narrow) + faces + ")");
    write("owner", header("labelList", narrow) + bytesOf(std::vector<std::int32_t>(6, 0)));
    expectCube();
}

// A patch may hold more than we know, with lists and dictionaries in it; zones come sorted.
TEST_F(FoamRead, BoundaryEntriesAndZones) {
    write("boundary",
          header("polyBoundaryMesh") +
              "2(a{type processor; nFaces 2; startFace 0; matchTolerance 1e-4; transform unknown; myProcNo 0;"
              " extra { list (1 (2 3)); deep { a b; } } inGroups (x y);}\n"
              "b { type symmetryPlane; startFace 2; nFaces 4; })");
    write("cellZones", header("regIOobject") + "1(fluid{type cellZone; cellLabels List<label> 1(0);})");
    const PolyMesh mesh = readFoam(folder_.string());
    ASSERT_EQ(mesh.patches.size(), 2U);
    EXPECT_EQ(mesh.patches[0].type, "processor");
    EXPECT_EQ(mesh.patches[1].name, "b");
    EXPECT_EQ(mesh.patches[1].start, 2);
    EXPECT_EQ(mesh.patches[1].count, 4);
    EXPECT_THAT(mesh.zones.at(0).cells, ElementsAre(0));
}

// Whatever is wrong with the files is an input error that says which file and where in it; nothing is read
// past the end, and no damaged size makes us ask for memory.
TEST_F(FoamRead, ErrorsNameFileAndPlace) {
    const auto with = [&](const char* name, const std::string& content, const std::string& what,
                          const std::string& where) {
        SCOPED_TRACE(content.substr(0, 200));
        SetUp();
        write(name, content);
        expectError(what, where);
    };
    with("points", "hello", "'FoamFile' expected", "points, line 1");
    with("points", header("vectorField") + "8((0 0 0)\n(1 0 x)", "a list of 8", "points, line 7");
    with("points", header("vectorField") + "2((0 0 0)\n(1 0 x0000000))",
         "a number expected, but found 'x0000000'", "points, line 8");
    with("points", header("vectorField") + "4000000000((0 0 0))", "cannot be in this file", "points, line 7");
    with("points", header("vectorField", "format binary;") + "\n1\n(1234567890123456789012345678",
         "')' expected", "points, byte");
    with("faces", header("faceList") + "6(4(0 3 2 1)", "the file ends too early", "faces");
    with("faces", header("faceList") + "6(4(0 3 2 9)4(4 5 6 7)4(0 1 5 4)4(1 2 6 5)4(2 3 7 6)4(3 0 4 7))",
         "a point that is not there", "polyMesh");
    with("faces", header("faceCompactList") + "3(0 4 2)4(0 1 2 3)", "offsets do not fit", "faces");
    with("owner", header("labelList") + "5{0}", "6 faces, but 5 owners", "polyMesh");
    with("owner", header("labelList") + "6(0 0 0 0 0 -7)", "label -7 is out of range", "owner, line 7");
    with("boundary", header("polyBoundaryMesh") + "1(all{type wall; nFaces 7; startFace 0;})",
         "patch all has 7 faces", "polyMesh");
    with("boundary", header("polyBoundaryMesh") + "1(all{type wall; nFaces 6; startFace 0;",
         "the file ends too early", "boundary");
    with("cellZones", header("regIOobject") + "1(z{type cellZone; cellLabels List<label> 1(3);})", "zone z",
         "polyMesh");
    SetUp();
    fs::remove(folder_ / "constant/polyMesh/owner");
    expectError("the file owner is missing", "polyMesh");
    fs::remove(folder_ / "constant/polyMesh/points");
    expectError("no OpenFOAM mesh", folder_.string());
}

} // namespace
} // namespace i2b::test
