#include "i2b/assemble/mesh_topology.h"
#include "i2b/core/error.h"
#include "i2b/write/ply_write.h"
#include "i2b/write/vtu_cells.h"
#include "i2b/write/vtu_write.h"
#include "write/mesh_samples.h"
#include <cstring>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <numeric>
#include <tbb/global_control.h>

namespace i2b {
namespace {

using test::contents, test::Ran, test::shell, test::TempFolder;

bool hasVtk() { return shell("/usr/bin/python3 -c 'import vtkmodules'").status == 0; }

// What VTK finds in a .vtu or .ply file, as JSON.
constexpr const char* reader = R"py(
import sys, json
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader
from vtkmodules.vtkIOPLY import vtkPLYReader
from vtkmodules.vtkFiltersVerdict import vtkCellSizeFilter
from vtkmodules.vtkFiltersCore import vtkMassProperties, vtkTriangleFilter
path = sys.argv[1]
r = vtkXMLUnstructuredGridReader() if path.endswith('.vtu') else vtkPLYReader()
r.SetFileName(path)
r.Update()
g = r.GetOutput()
def column(a): return [a.GetTuple1(i) for i in range(a.GetNumberOfTuples())]
out = {'cells': g.GetNumberOfCells(), 'points': g.GetNumberOfPoints()}
if path.endswith('.vtu'):
    s = vtkCellSizeFilter()
    s.SetInputData(g)
    s.Update()
    out['volumes'] = column(s.GetOutput().GetCellData().GetArray('Volume'))
    out['types'] = [g.GetCellType(i) for i in range(min(100, g.GetNumberOfCells()))]
    out['faces'] = [g.GetCell(i).GetNumberOfFaces() for i in range(min(100, g.GetNumberOfCells()))]
    d = g.GetCellData()
    out['data'] = {d.GetArrayName(i): column(d.GetArray(i)) for i in range(d.GetNumberOfArrays())}
    d = g.GetPointData()
    out['pointData'] = {d.GetArrayName(i): column(d.GetArray(i)) for i in range(d.GetNumberOfArrays())}
else:
    t = vtkTriangleFilter()
    t.SetInputData(g)
    m = vtkMassProperties()
    m.SetInputConnection(t.GetOutputPort())
    m.Update()
    out['area'] = m.GetSurfaceArea()
    p = g.GetPoints()
    # Signed volume of the cone from the origin: positive where normals point away from it.
    v = 0.0
    for i in range(g.GetNumberOfCells()):
        c = [g.GetPoint(g.GetCell(i).GetPointId(j)) for j in range(g.GetCell(i).GetNumberOfPoints())]
        for j in range(1, len(c) - 1):
            a, b, e = c[0], c[j], c[j + 1]
            v += (a[0] * (b[1] * e[2] - b[2] * e[1]) + a[1] * (b[2] * e[0] - b[0] * e[2]) + a[2] * (b[0] * e[1] - b[1] * e[0])) / 6
    out['volume'] = v
print(json.dumps(out))
)py";

nlohmann::json readBack(const std::filesystem::path& path) {
    const auto script = path.parent_path() / "read.py";
    test::put(script, reader);
    const Ran ran = shell("/usr/bin/python3 " + script.string() + " " + path.string());
    EXPECT_EQ(ran.status, 0) << ran.text;
    return nlohmann::json::parse(ran.text);
}

// Every third boundary face becomes two triangles, so that its cell is a polyhedron of the same volume.
PolyMesh splitEveryThirdFace(const PolyMesh& mesh) {
    PolyMesh result = mesh;
    result.faceOffsets = {0};
    result.faceVertices.clear();
    result.owner.clear();
    const auto add = [&](std::initializer_list<std::int32_t> vertices, std::int32_t owner) {
        result.faceVertices.insert(result.faceVertices.end(), vertices);
        result.faceOffsets.push_back(static_cast<std::uint32_t>(result.faceVertices.size()));
        result.owner.push_back(owner);
    };
    std::int32_t patchEnd = mesh.internalFaces();
    for (std::size_t p = 0, f = 0; f < mesh.owner.size(); ++f) {
        const auto v = mesh.face(static_cast<std::int32_t>(f));
        const bool boundary = f >= mesh.neighbour.size();
        if (boundary && static_cast<std::int32_t>(f) == mesh.patches[p].start + mesh.patches[p].count) ++p;
        if (boundary && f % 3 == 0) {
            add({v[0], v[1], v[2]}, mesh.owner[f]);
            add({v[0], v[2], v[3]}, mesh.owner[f]);
            ++result.patches[p].count;
        } else {
            add({v[0], v[1], v[2], v[3]}, mesh.owner[f]);
        }
    }
    for (Patch& patch : result.patches) patch.start = patchEnd, patchEnd += patch.count;
    return result;
}

// Each topology is recognised, with the points in an order that gives a positive volume: apex and base where
// VTK wants them.
TEST(VtuCells, RecognisesShapes) {
    const PolyMesh mesh = test::zooMesh();
    const Rows faces = buildCellFaces(mesh);
    const auto shape = [&](std::int32_t c) { return shapeOf(mesh, faces[c], c); };
    EXPECT_EQ(shape(0).type, VtkCell::hexahedron);
    EXPECT_EQ(shape(1).type, VtkCell::wedge);
    EXPECT_EQ(shape(2).type, VtkCell::pyramid);
    EXPECT_EQ(shape(2).points[4], 10);
    EXPECT_EQ(shape(3).type, VtkCell::tetra);
    EXPECT_EQ(shape(4).type, VtkCell::polyhedron);
    std::vector<std::int32_t> points;
    cellPoints(mesh, faces[4], points);
    EXPECT_EQ(points, (std::vector<std::int32_t>{0, 3, 4, 7, 12, 13, 14, 15, 16, 17}));
    // The hexahedron's base seen from inside, and the points above its own.
    const auto h = shape(0).points;
    const auto p = [&](std::size_t i) { return mesh.points[static_cast<std::size_t>(h[i])]; };
    EXPECT_GT(dot(cross(p(1) - p(0), p(3) - p(0)), p(4) - p(0)), 0.5);
    for (std::size_t i = 0; i < 4; ++i) EXPECT_DOUBLE_EQ(norm(p(i + 4) - p(i)), 1);
}

// VTK reads the file back, compressed or not: types, numbers of faces, each cell's own volume, and the data
// given.
TEST(VtuWrite, VtkReadsBackWhatWasWritten) {
    if (!hasVtk()) GTEST_SKIP() << "python3-vtk9 is not installed";
    const TempFolder temp;
    PolyMesh mesh = test::zooMesh();
    mesh.cellLevel = {1, 2, 3, 4, 5};
    mesh.cellLayer = {0, 1, 0, 2, 0};
    mesh.cellRegion = {0, 0, 7, -1, 300};
    const std::vector<std::int32_t> some{1, 4};
    const std::vector<CellData> data{{"skew<ness>\"&", {0.5f, 1.5f, 2.5f, 3.5f, 4.5f}}, {"some", {7, 8}, &some}};
    for (const bool compress : {true, false}) {
        writeVtu(mesh, buildCellFaces(mesh), data, temp / "mesh.vtu", {.compress = compress}, Context());
        const auto read = readBack(temp / "mesh.vtu");
        EXPECT_EQ(read["cells"], 5);
        EXPECT_EQ(read["points"], 18);
        EXPECT_EQ(read["types"], (std::vector<int>{12, 13, 14, 10, 42}));
        EXPECT_EQ(read["faces"], (std::vector<int>{6, 5, 5, 4, 7}));
        const auto volumes = read["volumes"].get<std::vector<double>>();
        EXPECT_THAT(volumes, testing::Pointwise(testing::DoubleNear(1e-12),
                                                std::vector<double>{1, 0.5, 1. / 3, 1. / 6, 1}));
        EXPECT_EQ(read["data"]["level"], (std::vector<int>{1, 2, 3, 4, 5}));
        EXPECT_EQ(read["data"]["layer"], (std::vector<int>{0, 1, 0, 2, 0}));
        EXPECT_EQ(read["data"]["region"], (std::vector<int>{0, 0, 7, -1, 300}));
        EXPECT_EQ(read["data"]["patch"], (std::vector<int>{0, 0, 0, 0, 0}));
        EXPECT_EQ(read["data"]["skew<ness>\"&"], (std::vector<double>{0.5, 1.5, 2.5, 3.5, 4.5}));
        EXPECT_EQ(read["data"]["some"], (std::vector<double>{0, 7, 0, 0, 8}));
    }
}

// Values of a few points come back as one value a point, 0 where none was given, over many blocks.
TEST(VtuWrite, ValuesOfSomePoints) {
    if (!hasVtk()) GTEST_SKIP() << "python3-vtk9 is not installed";
    const TempFolder temp;
    const PolyMesh mesh = test::boxMesh({80, 30, 27}); // more points than one block holds
    std::vector<std::int32_t> points;
    std::vector<float> distance;
    std::vector<std::uint8_t> cause;
    std::vector<double> expected(mesh.points.size(), 0), expectedCause(mesh.points.size(), 0);
    for (std::size_t p = 7; p < mesh.points.size(); p += 1000) {
        points.push_back(static_cast<std::int32_t>(p));
        distance.push_back(0.25f * static_cast<float>(points.size()));
        cause.push_back(static_cast<std::uint8_t>(points.size() % 10));
        expected[p] = double(distance.back());
        expectedCause[p] = cause.back();
    }
    const std::vector<PointData> values{{"off_geometry", points, std::span<const float>(distance)},
                                        {"off_cause", points, std::span<const std::uint8_t>(cause)}};
    for (const bool compress : {true, false}) {
        writeVtu(mesh, buildCellFaces(mesh), {}, temp / "mesh.vtu", {.compress = compress}, Context(), values);
        const auto read = readBack(temp / "mesh.vtu");
        EXPECT_EQ(read["pointData"]["off_geometry"].get<std::vector<double>>(), expected);
        EXPECT_EQ(read["pointData"]["off_cause"].get<std::vector<double>>(), expectedCause);
        EXPECT_EQ(read["cells"], 64800);
    }
    distance.pop_back();
    const std::vector<PointData> shorter{{"off_geometry", points, std::span<const float>(distance)}};
    EXPECT_THROW(writeVtu(mesh, buildCellFaces(mesh), {}, temp / "short.vtu", {}, Context(), shorter), Error);
}

// Lists that run across many compressed blocks come back whole, hexahedra and polyhedra mixed.
TEST(VtuWrite, ManyBlocks) {
    if (!hasVtk()) GTEST_SKIP() << "python3-vtk9 is not installed";
    const TempFolder temp;
    const PolyMesh mesh = splitEveryThirdFace(test::boxMesh({30, 30, 30}, 0.5));
    writeVtu(mesh, buildCellFaces(mesh), {}, temp / "mesh.vtu", {}, Context());
    const auto read = readBack(temp / "mesh.vtu");
    const auto volumes = read["volumes"].get<std::vector<double>>();
    EXPECT_EQ(volumes.size(), 27000u);
    EXPECT_NEAR(*std::min_element(volumes.begin(), volumes.end()), 0.125, 1e-12);
    const auto types = read["types"].get<std::vector<int>>();
    EXPECT_GT(std::count(types.begin(), types.end(), 42), 20);
    EXPECT_GT(std::count(types.begin(), types.end(), 12), 20);
    EXPECT_NEAR(std::accumulate(volumes.begin(), volumes.end(), 0.0), 3375, 1e-8);
    const auto patch = read["data"]["patch"].get<std::vector<int>>();
    EXPECT_EQ(std::count(patch.begin(), patch.end(), 0), 900);
}

// The same bytes on one thread and on three.
TEST(VtuWrite, SameBytesOnAnyNumberOfThreads) {
    const TempFolder temp;
    const PolyMesh mesh = test::boxMesh({40, 41, 42}, 0.1);
    const std::vector<CellData> data{
        {"volume", std::vector<float>(static_cast<std::size_t>(mesh.cells), 0.001f)}};
    for (const std::size_t threads : {1, 3}) {
        const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
        writeVtu(mesh, buildCellFaces(mesh), data, temp / (std::to_string(threads) + ".vtu"), {}, Context());
        writePly(mesh, temp / (std::to_string(threads) + ".ply"), Context());
    }
    EXPECT_GT(contents(temp / "1.vtu").size(), 100000u);
    EXPECT_EQ(contents(temp / "1.vtu"), contents(temp / "3.vtu"));
    EXPECT_EQ(contents(temp / "1.ply"), contents(temp / "3.ply"));
}

// Data that is not one value a cell is a fault of the caller, and says which.
TEST(VtuWrite, RefusesDataOfTheWrongLength) {
    const TempFolder temp;
    const auto attempt = [&] {
        writeVtu(test::zooMesh(), buildCellFaces(test::zooMesh()), {{"short", {1, 2}}}, temp / "mesh.vtu", {}, Context());
    };
    EXPECT_THROW(attempt(), Error);
    EXPECT_FALSE(std::filesystem::exists(temp / "mesh.vtu"));
}

// The wall as polygons: all of the wall patch, nothing else, normals into the fluid, the part of each face.
TEST(PlyWrite, WallPolygonsWithParts) {
    const TempFolder temp;
    const PolyMesh mesh = test::zooMesh();
    writePly(mesh, temp / "wall.ply", Context());
    const std::string text = contents(temp / "wall.ply");
    EXPECT_THAT(text, testing::HasSubstr("comment part 0 body\nelement vertex 18\n"));
    std::size_t body = 18 * 24;
    for (std::int32_t f = mesh.internalFaces(); f < mesh.faces(); ++f)
        body += 1 + 4 * mesh.face(f).size() + 4;
    EXPECT_EQ(text.size() - (text.find("end_header\n") + 11), body);
    if (!hasVtk()) GTEST_SKIP() << "python3-vtk9 is not installed";
    const auto read = readBack(temp / "wall.ply");
    EXPECT_EQ(read["cells"], mesh.faces() - mesh.internalFaces());
    EXPECT_NEAR(read["volume"].get<double>(), -3, 1e-6); // a solid around the fluid: normals inwards
}

// Values of points are properties of the vertices, in the order given; VTK still reads the surface.
TEST(PlyWrite, ValuesOfPoints) {
    const TempFolder temp;
    const PolyMesh mesh = test::zooMesh();
    const std::vector<std::int32_t> points{0, 17};
    const std::vector<float> distance{0.5f, 1.5f};
    const std::vector<std::uint8_t> cause{3, 4};
    writePly(mesh, temp / "wall.ply", Context(), {},
             {{"off_geometry", points, std::span(distance)}, {"off_cause", points, std::span(cause)}});
    const std::string text = contents(temp / "wall.ply");
    EXPECT_THAT(text, testing::HasSubstr("property double z\nproperty float off_geometry\nproperty uchar off_cause\nelement face"));
    const std::size_t start = text.find("end_header\n") + 11;
    for (std::size_t v = 0; v < 18; ++v) {
        float d = -1;
        std::memcpy(&d, text.data() + start + 29 * v + 24, sizeof d);
        const auto c = static_cast<int>(static_cast<unsigned char>(text[start + 29 * v + 28]));
        EXPECT_EQ(d, v == 0 ? 0.5f : v == 17 ? 1.5f : 0.0f);
        EXPECT_EQ(c, v == 0 ? 3 : v == 17 ? 4 : 0);
    }
    if (!hasVtk()) GTEST_SKIP() << "python3-vtk9 is not installed";
    const auto read = readBack(temp / "wall.ply");
    EXPECT_NEAR(read["volume"].get<double>(), -3, 1e-6);
}

// Two patches by name: points are shared, parts numbered in the order of the patches.
TEST(PlyWrite, NamedPatches) {
    const TempFolder temp;
    const PolyMesh mesh = test::boxMesh({2, 2, 2});
    writePly(mesh, temp / "a.ply", Context(), {"sides", "bottom"});
    const std::string text = contents(temp / "a.ply");
    EXPECT_THAT(text, testing::HasSubstr("comment part 0 bottom\ncomment part 1 sides\nelement vertex 26\n"));
    EXPECT_THAT(text, testing::HasSubstr("element face 24\n"));
    std::int32_t part = -1;
    std::memcpy(&part, text.data() + text.size() - 4, 4);
    EXPECT_EQ(part, 1);
    writePly(mesh, temp / "b.ply", Context());
    EXPECT_THAT(contents(temp / "b.ply"), testing::HasSubstr("element vertex 9\n"));
}

} // namespace
} // namespace i2b
