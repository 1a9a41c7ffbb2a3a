// Proves, on the built-in geometries and on real dirty ones: the program ends with a mesh for which checkMesh
// -allTopology says "Mesh OK", the figures of our own check are checkMesh's to the last digit, the mesh is the same on
// one thread and on two, every wall face has its layers, and a flow solver takes the mesh as it is.
#include "i2b/quality/quality_report.h"
#include "i2b/write/foam_read.h"
#include "quality/checkmesh_figures.h"
#include <array>
#include <cstdlib>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <gtest/gtest.h>
#include <sstream>
#include <unistd.h>

namespace i2b {
namespace {

namespace fs = std::filesystem;

struct Case {
    const char* name;
    const char* sample;   // a built-in geometry, or null
    const char* files;    // else real files, separated by spaces: shared/ or openfoam/ and the name, or tutorials/ and the path among OpenFOAM's examples
    const char* options;
};

const std::array<Case, 20> cases{{
    {"Engine2Cyl", nullptr, "shared/engine-2cyl.obj.gz", "--scale 0.001 --size 0.004"},
    {"MotorBike", nullptr, "openfoam/motorBike.obj.gz", "--size 0.02 --box -5 -4 0 15 4 8 --max-size 1"},
    {"MotorBikeLayers", nullptr, "openfoam/motorBike.obj.gz", "--size 0.03125 --layers 5"},
    {"DrivAer", nullptr, "shared/drivaer-body.obj.gz shared/drivaer-frontWheels.obj.gz shared/drivaer-rearWheels.obj.gz",
     "--size 0.03125 --box -10 -5 0 30 5 8 --max-size 1"},
    {"DrivAerHalfLayers", nullptr,
     "shared/drivaer-body.obj.gz shared/drivaer-frontWheels.obj.gz shared/drivaer-rearWheels.obj.gz",
     "--size 0.0625 --box -10 0 0 30 5 8 --max-size 1 --layers 3"},
    {"DrivAerHalfPerAxis", nullptr,
     "shared/drivaer-body.obj.gz shared/drivaer-frontWheels.obj.gz shared/drivaer-rearWheels.obj.gz",
     "--size 0.0625 --box -10 0 0 30 5 8 --max-size 1 --box-size 3 0 0 10 1.2 1.4 0.5 0.125 0.0625 "
     "--box-size -10 0 0 -1 2 0.3 1 0.5 0.0625"},
    {"MissilePerAxis", "missile", nullptr, "--size 0.04 --part-size '.*=0.04,0.02,0.02' --box-size 0 -1 -1 2 0 1 0.16 0.08 0.04"},
    {"Engine", "engine", nullptr, "--size 0.012"},
    {"EngineJacket", "engine", nullptr, "--size 0.004 --seed 0.152 0.053 0.40"},
    {"Missile", "missile", nullptr, "--size 0.02 --layers 2"},
    {"EngineLayers", "engine", nullptr, "--size 0.0138 --layers 5"},
    {"EngineLayersByPart", "engine", nullptr,
     "--size 0.012 --layers 4 --first-layer 0.0005 --growth 1.2 --part-layers '.*head.*=none' --part-layers 'exhaust.*=2,first=0.001' "
     "--part-layers 'oil_pan=6'"},
    {"EngineLayersByPartSmaller", "engine", nullptr, // a wall face there is too skew for checkMesh, not for the dictionary
     "--size 0.0105 --layers 4 --first-layer 0.0005 --growth 1.2 --part-layers '.*head.*=none' --part-layers 'exhaust.*=2,first=0.001' "
     "--part-layers 'oil_pan=6'"},
    {"DrivAerHalfLayersByPart", nullptr,
     "shared/drivaer-body.obj.gz shared/drivaer-frontWheels.obj.gz shared/drivaer-rearWheels.obj.gz",
     "--size 0.0625 --box -10 0 0 30 5 8 --max-size 1 --layers 5 --y-plus 100 --velocity 40 --viscosity 1.5e-5 --length 4.6 "
     "--part-layers '.*Wheels=2'"},
    {"ShipHullHalf", nullptr, "openfoam/DTC-scaled.stl.gz", "--size 0.04 --box -16 -12 -10 18 0 4 --layers 3"},
    {"CycloneThroughTheBox", nullptr, "openfoam/cyclone.stl.gz", "--size 0.03 --seed 0,0,0 --box -.55 -.52 -1.05 .55 .52 1.1 --layers 3"},
    {"SleeveWithMembrane", nullptr, "openfoam/membrane-boundaries.stl.gz openfoam/membrane-membrane.stl.gz", "--size 0.08 --seed -2.3,0,0 --layers 3"},
    {"Buildings", nullptr, "tutorials/incompressible/simpleFoam/windAroundBuildings/constant/triSurface/buildings.obj.gz",
     "--size 3 --box -100 -100 0 400 300 200 --layers 3"},
    {"Terrain", nullptr, "tutorials/incompressible/simpleFoam/turbineSiting/constant/triSurface/terrain.stl.gz",
     "--size 20 --box 581321 4785280 900 582290 4786330 2000 --layers 3"},
    {"StirredVesselOfTwoZones", nullptr,
     "tutorials/multiphase/interFoam/RAS/mixerVesselAMI/constant/triSurface/vessel.stl.gz tutorials/multiphase/interFoam/RAS/mixerVesselAMI/constant/triSurface/sparger.stl.gz "
     "tutorials/multiphase/interFoam/RAS/mixerVesselAMI/constant/triSurface/stirrer.stl.gz tutorials/multiphase/interFoam/RAS/mixerVesselAMI/constant/triSurface/shaft.stl.gz "
     "tutorials/multiphase/interFoam/RAS/mixerVesselAMI/constant/triSurface/rotating.stl.gz",
     "--size 0.016 --seed outer=.2,0,.9 --seed inner=.1,0,.4 --layers 2"},
}};

std::string textOf(const fs::path& path) {
    std::ifstream in(path);
    std::stringstream text;
    text << in.rdbuf();
    return text.str();
}

void PrintTo(const Case& c, std::ostream* out) { *out << c.options; }

class CaseFolder : public testing::Test {
  protected:
    void SetUp() override {
        folder_ = fs::temp_directory_path() / fmt::format("i2b_case_{}_{}", testing::UnitTest::GetInstance()->current_test_info()->line(), getpid());
        fs::create_directories(folder_);
        if (!std::getenv("WM_PROJECT_DIR")) setenv("WM_PROJECT_DIR", "/usr/share/openfoam", 1);
    }
    void TearDown() override {
        if (!HasFailure()) fs::remove_all(folder_);
    }
    int run(const std::string& command, const char* log) const {
        return std::system(fmt::format("cd '{}' && {} > {} 2>&1", folder_.string(), command, log).c_str());
    }
    // The geometry's files, quoted; empty where one is missing.
    std::string geometry(const Case& c) const {
        if (c.sample) {
            EXPECT_EQ(run(fmt::format("'{}' sample {} -o parts", I2B_PROGRAM, c.sample), "sample.log"), 0);
            return "parts/*.stl";
        }
        const char* const shared = std::getenv("I2B_GEOMETRY_DIR");
        std::istringstream names(c.files);
        std::string all;
        for (std::string name; names >> name;) {
            const fs::path examples = "/usr/share/doc/openfoam-examples/examples";
            const fs::path place = name.starts_with("shared/")      ? fs::path(shared ? shared : I2B_GEOMETRY_DIR_DEFAULT)
                                   : name.starts_with("tutorials/") ? examples
                                                                    : examples / "resources/geometry";
            const fs::path file = fs::weakly_canonical(place / name.substr(name.find('/') + 1));
            if (!fs::exists(file)) return "";
            all += fmt::format("'{}' ", file.string());
        }
        return all;
    }
    fs::path folder_;
};

class Cases : public CaseFolder, public testing::WithParamInterface<Case> {};

std::string checksumOf(const fs::path& report) {
    const std::string text = textOf(report);
    const std::size_t at = text.find("\"checksum\"");
    return at == std::string::npos ? "" : text.substr(at, 32);
}

TEST_P(Cases, EndWithAMeshThatOpenFoamTakes) {
    const std::string files = geometry(GetParam());
    if (files.empty()) GTEST_SKIP() << "the geometry of this case is not on this machine";
    const std::string mesh = fmt::format("'{}' mesh {} {} --quiet --format openfoam,report", I2B_PROGRAM, files, GetParam().options);
    ASSERT_EQ(run(mesh + " --threads 2 --out case", "mesh.log"), 0) << textOf(folder_ / "mesh.log");
    ASSERT_EQ(run(mesh + " --threads 1 --out again", "again.log"), 0) << textOf(folder_ / "again.log");
    EXPECT_EQ(checksumOf(folder_ / "case/report.json"), checksumOf(folder_ / "again/report.json"));
    EXPECT_NE(checksumOf(folder_ / "case/report.json"), "");

    const PolyMesh polyMesh = readFoam((folder_ / "case").string());
    EXPECT_EQ(polyMesh.validate(), "");
    const QualityReport report = measureQuality(polyMesh);
    EXPECT_EQ(report.negativeVolumeCells, 0);
    EXPECT_EQ(report.wrongOrientedFaces, 0);
    EXPECT_EQ(report.openCells, 0);
    EXPECT_EQ(report.dictionaryFaces, 0);

    if (std::system("command -v checkMesh > /dev/null") != 0) GTEST_SKIP() << "OpenFOAM's checkMesh is not installed";
    ASSERT_EQ(run("checkMesh -case case -allTopology", "topology.log"), 0);
    EXPECT_NE(textOf(folder_ / "topology.log").find("Mesh OK."), std::string::npos) << textOf(folder_ / "topology.log");
    ASSERT_EQ(run("sed -i 's/writePrecision.*/writePrecision 17;/' case/system/controlDict && checkMesh -case case -allTopology -allGeometry", "check.log"), 0);
    test::compareWithCheckMesh(textOf(folder_ / "check.log"), report);
}

// The potential flow around the car, on the mesh as it was written.
TEST_F(CaseFolder, CarriesAPotentialFlow) {
    const Case& car = cases[2];
    if (std::system("command -v potentialFoam > /dev/null") != 0) GTEST_SKIP() << "OpenFOAM's potentialFoam is not installed";
    const std::string files = geometry(car);
    if (files.empty()) GTEST_SKIP() << "the geometry of this case is not on this machine";
    ASSERT_EQ(run(fmt::format("'{}' mesh {} {} --quiet --format openfoam --out case", I2B_PROGRAM, files, car.options), "mesh.log"), 0);
    fs::create_directories(folder_ / "case/0");
    std::ofstream(folder_ / "case/0/U") << "FoamFile { version 2.0; format ascii; class volVectorField; object U; }\n"
                                           "dimensions [0 1 -1 0 0 0 0]; internalField uniform (0 0 0);\n"
                                           "boundaryField { xMin { type fixedValue; value uniform (20 0 0); }\n"
                                           "xMax { type zeroGradient; } \".*\" { type slip; } }\n";
    std::ofstream(folder_ / "case/0/p") << "FoamFile { version 2.0; format ascii; class volScalarField; object p; }\n"
                                           "dimensions [0 2 -2 0 0 0 0]; internalField uniform 0;\n"
                                           "boundaryField { xMax { type fixedValue; value uniform 0; }\n"
                                           "\".*\" { type zeroGradient; } }\n";
    ASSERT_EQ(run("potentialFoam -case case", "flow.log"), 0) << textOf(folder_ / "flow.log");
    const std::string log = textOf(folder_ / "flow.log");
    // Each corrector starts from a smaller residual; the last one must begin close to the solution.
    const std::size_t last = log.rfind("Initial residual = ");
    ASSERT_NE(last, std::string::npos) << log;
    EXPECT_LT(std::atof(log.c_str() + last + 19), 1e-4) << log;
    EXPECT_NE(log.find("End"), std::string::npos);
}

INSTANTIATE_TEST_SUITE_P(Real, Cases, testing::ValuesIn(cases), [](const auto& info) { return std::string(info.param.name); });

} // namespace
} // namespace i2b
