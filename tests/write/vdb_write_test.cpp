#include "i2b/core/error.h"
#include "i2b/write/vdb_write.h"
#include "write/ball_sample.h"
#include "write/mesh_samples.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <openvdb/tools/VolumeToMesh.h>
#include <tbb/global_control.h>

namespace i2b {
namespace {

using openvdb::Coord;
using test::Ball, test::contents, test::TempFolder;

template <class Grid>
typename Grid::Ptr load(const std::filesystem::path& path, const std::string& name) {
    openvdb::io::File file(path.string());
    file.open(false);
    return openvdb::gridPtrCast<Grid>(file.readGrid(name));
}

std::string python(const std::filesystem::path& folder, const std::string& text) {
    test::put(folder / "script.py", text);
    return test::shell("/usr/bin/python3 " + (folder / "script.py").string()).text;
}

// Every finest voxel of level, region, cut and kept holds what its leaf cell has, the centres lie where the
// cells' do, and nothing is set outside the domain. Cells of one to sixteen finest ones along an edge.
TEST(VdbWrite, ValuesOfEveryCell) {
    for (const int refine : {1, 2, 4}) {
        const TempFolder temp;
        const Ball ball(refine);
        ball.write(temp / "grid.vdb");
        const auto level = load<openvdb::FloatGrid>(temp / "grid.vdb", "level");
        const auto region = load<openvdb::FloatGrid>(temp / "grid.vdb", "region");
        const auto cut = load<openvdb::BoolGrid>(temp / "grid.vdb", "cut");
        const auto kept = load<openvdb::BoolGrid>(temp / "grid.vdb", "kept");
        ASSERT_TRUE(level && region && cut && kept);
        std::uint64_t volume = 0, cutVolume = 0, keptVolume = 0;
        for (std::size_t l = 0; l < ball.grid.levels.size(); ++l) {
            const int shift = refine - static_cast<int>(l);
            for (auto cell = ball.grid.levels[l].cells->cbeginValueOn(); cell; ++cell) {
                const Coord c = cell.getCoord();
                const bool isCut = ball.cut.levels[l]->isValueOn(c),
                           isKept = ball.kept.levels[l]->isValueOn(c);
                const std::uint64_t voxels = std::uint64_t(1) << (3 * shift);
                volume += voxels, cutVolume += isCut ? voxels : 0, keptVolume += isKept ? voxels : 0;
                for (const int last : {0, (1 << shift) - 1}) { // both ends of the cell
                    const Coord v((c.x() << shift) + last, (c.y() << shift) + last, (c.z() << shift) + last);
                    ASSERT_EQ(level->tree().getValue(v), static_cast<float>(l));
                    ASSERT_EQ(cut->tree().isValueOn(v), isCut);
                    ASSERT_EQ(kept->tree().getValue(v), isKept);
                    ASSERT_EQ(region->tree().getValue(v), isCut ? -1.f : isKept ? 0.f : 1.f);
                }
            }
        }
        EXPECT_EQ(level->activeVoxelCount(), volume);
        EXPECT_EQ(volume, std::uint64_t(512) << (3 * refine));
        EXPECT_EQ(cut->activeVoxelCount(), cutVolume);
        EXPECT_EQ(kept->activeVoxelCount(), keptVolume);
        const auto centre = level->indexToWorld(Coord(0));
        EXPECT_DOUBLE_EQ(centre.x(), -4 + 0.5 / (1 << refine));
    }
}

// The masks by level hold the very cells, each on its own lattice.
TEST(VdbWrite, CellMasksByLevel) {
    const TempFolder temp;
    const Ball ball(2);
    ball.write(temp / "grid.vdb");
    for (std::size_t l = 0; l < 3; ++l) {
        const auto mask = load<openvdb::BoolGrid>(temp / "grid.vdb", "cells_L" + std::to_string(l));
        EXPECT_EQ(mask->activeVoxelCount(), ball.grid.levels[l].cells->activeVoxelCount());
        for (auto cell = ball.grid.levels[l].cells->cbeginValueOn(); cell; ++cell)
            ASSERT_TRUE(mask->tree().isValueOn(cell.getCoord()));
        EXPECT_DOUBLE_EQ(mask->voxelSize().x(), 1.0 / (1 << l));
        EXPECT_DOUBLE_EQ(mask->indexToWorld(Coord(0)).z(), -4 + 0.5 / (1 << l));
    }
}

// The level set is the ball: every band voxel has the exact distance with the fluid's sign, all of the inside
// is negative, and the surface drawn from it has the sphere's place everywhere.
TEST(VdbWrite, SurfaceIsTheBall) {
    const TempFolder temp;
    const Ball ball(4);
    ball.write(temp / "grid.vdb");
    const auto surface = load<openvdb::FloatGrid>(temp / "grid.vdb", "surface");
    EXPECT_EQ(surface->getGridClass(), openvdb::GRID_LEVEL_SET);
    const float width = surface->background();
    EXPECT_FLOAT_EQ(width, 3 * 0.0625f);
    EXPECT_GT(surface->activeVoxelCount(), 10000u);
    for (auto v = surface->cbeginValueOn(); v; ++v) {
        const auto p = surface->indexToWorld(v.getCoord());
        const double exact = p.length() - Ball::radius;
        ASSERT_NEAR(*v, exact, 1e-5) << p;
        ASSERT_LT(std::abs(*v), width);
    }
    for (const double x : {0.0, 0.3, 0.9, 1.3, 3.9}) {
        const float value =
            surface->tree().getValue(Coord::round(surface->worldToIndex(openvdb::Vec3d(x, 0, 0))));
        EXPECT_EQ(value > 0, x > Ball::radius) << x;
    }
    std::vector<openvdb::Vec3s> points;
    std::vector<openvdb::Vec4I> quads;
    openvdb::tools::volumeToMesh(*surface, points, quads);
    ASSERT_GT(points.size(), 1000u);
    for (const auto& p : points) ASSERT_NEAR(p.length(), Ball::radius, 0.005);
    const auto distance = load<openvdb::FloatGrid>(temp / "grid.vdb", "distance");
    for (auto v = distance->cbeginValueOn(); v; ++v) {
        const double exact = distance->indexToWorld(v.getCoord()).length() - Ball::radius;
        ASSERT_GE(exact, -1e-6);
        ASSERT_NEAR(*v, exact, 1e-5);
    }
    EXPECT_GT(distance->activeVoxelCount(), 5000u);
}

// A band on a lattice coarser or finer than the cut cells has the same signs.
TEST(VdbWrite, BandOnOtherLevels) {
    const TempFolder temp;
    const Ball ball(3);
    EXPECT_EQ(bandLevel(ball.cut), 3);
    for (const int level : {2, 3}) {
        ball.write(temp / "grid.vdb", {.caseName = {}, .version = {}, .bandLevel = level});
        const auto surface = load<openvdb::FloatGrid>(temp / "grid.vdb", "surface");
        EXPECT_DOUBLE_EQ(surface->voxelSize().x(), 1.0 / (1 << level));
        for (auto v = surface->cbeginValueOn(); v; ++v)
            ASSERT_NEAR(*v, surface->indexToWorld(v.getCoord()).length() - Ball::radius, 1e-5);
    }
}

// Large cells and uniform blocks are tiles: a domain of 1024^3 finest cells takes few leaf nodes and little
// disk.
TEST(VdbWrite, CoarseCellsAreTiles) {
    const TempFolder temp;
    CellGrid grid;
    grid.lattice = {{0, 0, 0}, {1, 1, 1}, {8, 8, 8}, 7};
    for (int l = 0; l <= 7; ++l) {
        const auto level = static_cast<std::uint8_t>(l);
        grid.levels.push_back({{level, level, level}, std::make_shared<Mask>()});
    }
    for (int i = 0; i < 8; ++i)
        for (int j = 0; j < 8; ++j)
            for (int k = 0; k < 8; ++k) grid.levels[0].cells->setValueOn(Coord(i, j, k));
    // One corner cell down to the finest: 7 of its 8 children stay at each level.
    for (std::size_t l = 1; l <= 7; ++l) {
        grid.levels[l - 1].cells->setValueOff(Coord(0));
        for (int i = 0; i < 8; ++i) grid.levels[l].cells->setValueOn(Coord(i >> 2, i >> 1 & 1, i & 1));
    }
    writeVdb({grid, nullptr, nullptr, nullptr, {}}, temp / "grid.vdb", {}, Context());
    const auto level = load<openvdb::FloatGrid>(temp / "grid.vdb", "level");
    EXPECT_EQ(level->activeVoxelCount(), std::uint64_t(1) << 30);
    EXPECT_EQ(level->tree().leafCount(), 1u);
    EXPECT_EQ(level->tree().getValue(Coord(0)), 7.f);
    EXPECT_EQ(level->tree().getValue(Coord(4, 0, 0)), 5.f);
    EXPECT_EQ(level->tree().getValue(Coord(1023)), 0.f);
    EXPECT_FALSE(level->tree().isValueOn(Coord(1024, 0, 0)));
    EXPECT_LT(std::filesystem::file_size(temp / "grid.vdb"), 200000u);
}

// Axes that differ: masks with their own name and transform, and no grids that would need one lattice for
// all.
TEST(VdbWrite, AnisotropicLevels) {
    const TempFolder temp;
    CellGrid grid;
    grid.lattice = {{0, 0, 0}, {1, 2, 4}, {2, 2, 2}, 2};
    grid.levels.push_back({{2, 1, 0}, std::make_shared<Mask>()});
    grid.levels[0].cells->setValueOn(Coord(1, 1, 1));
    writeVdb({grid, nullptr, nullptr, nullptr, {}}, temp / "grid.vdb", {}, Context());
    const auto mask = load<openvdb::BoolGrid>(temp / "grid.vdb", "cells_L2_1_0");
    EXPECT_EQ(mask->voxelSize(), openvdb::Vec3d(0.25, 1, 4));
    EXPECT_EQ(mask->indexToWorld(Coord(1, 1, 1)), openvdb::Vec3d(0.375, 1.5, 6));
}

// A grid too large for values has masks by level instead, and the file says so.
TEST(VdbWrite, LargeGridsHaveMasks) {
    const TempFolder temp;
    const Ball ball(2);
    ball.write(temp / "grid.vdb", {.caseName = {}, .version = {}, .mostValueCells = 10});
    openvdb::io::File file((temp / "grid.vdb").string());
    file.open(false);
    EXPECT_THAT(file.getMetadata()->metaValue<std::string>("masks"), testing::HasSubstr("masks by level"));
    for (const char* name : {"level", "region", "cut", "kept"}) EXPECT_FALSE(file.hasGrid(name)) << name;
    EXPECT_TRUE(file.hasGrid("surface"));
    for (std::size_t l = 0; l < 3; ++l) {
        std::uint64_t painted = 0;
        for (const RegionPiece& piece : ball.regions.pieces[l])
            if (ball.regions.table[static_cast<std::size_t>(piece.region)].painted)
                for (const std::uint64_t word : piece.mask) painted += static_cast<std::uint64_t>(std::popcount(word));
        const auto count = [&](const char* name) -> std::uint64_t {
            const std::string full = std::string(name) + "_L" + std::to_string(l);
            return file.hasGrid(full) ? load<openvdb::BoolGrid>(temp / "grid.vdb", full)->activeVoxelCount() : 0;
        };
        EXPECT_EQ(count("painted"), painted);
        EXPECT_EQ(count("cut"), ball.cut.levels[l]->activeVoxelCount());
        EXPECT_EQ(count("kept"), ball.kept.levels[l]->activeVoxelCount());
    }
}

// Blosc and the metadata are in the file as promised.
TEST(VdbWrite, MetadataAndCompression) {
    const TempFolder temp;
    Ball(1).write(
        temp / "grid.vdb",
        {.caseName = "ball", .version = "0.1.0", .surfaceSize = 0.5, .minSize = 0.25, .maxSize = 1, .texts = {{"region0", "volume 2 parts a"}}});
    openvdb::io::File file((temp / "grid.vdb").string());
    file.open(false);
    EXPECT_TRUE(file.compression() & openvdb::io::COMPRESS_BLOSC);
    const auto meta = file.getMetadata();
    EXPECT_EQ(meta->metaValue<std::string>("case"), "ball");
    EXPECT_EQ(meta->metaValue<std::string>("version"), "0.1.0");
    EXPECT_EQ(meta->metaValue<double>("size_surface"), 0.5);
    EXPECT_EQ(meta->metaValue<std::int32_t>("levels"), 2);
    EXPECT_EQ(meta->metaValue<std::string>("region0"), "volume 2 parts a");
}

// Debian's pyopenvdb, which knows float, bool and vector grids only, reads every grid.
TEST(VdbWrite, PyopenvdbReadsAllGrids) {
    const TempFolder temp;
    if (python(temp.path(), "import pyopenvdb\nprint('here')") != "here\n")
        GTEST_SKIP() << "python3-openvdb is not installed";
    const Ball ball(2);
    ball.write(temp / "grid.vdb", {.caseName = "ball", .version = "0.1.0", .texts = {{"region0", "volume 2 parts a"}}});
    const std::string text = python(
        temp.path(), "import pyopenvdb as vdb, json\n"
                     "grids, meta = vdb.readAll('" +
                         (temp / "grid.vdb").string() +
                         "')\n"
                         "print(json.dumps({'meta': meta['case'], 'region': meta['region0'], 'grids': {g.name: [type(g).__name__, "
                         "g.activeVoxelCount(), g.gridClass] for g in grids}}))\n");
    const auto json = nlohmann::json::parse(text);
    EXPECT_EQ(json["meta"], "ball");
    EXPECT_EQ(json["region"], "volume 2 parts a");
    EXPECT_EQ(json["grids"].size(), 9u);
    for (const char* name : {"level", "region", "surface", "distance"})
        EXPECT_EQ(json["grids"][name][0], "FloatGrid") << name;
    for (const char* name : {"cut", "kept", "cells_L0", "cells_L1", "cells_L2"})
        EXPECT_EQ(json["grids"][name][0], "BoolGrid") << name;
    EXPECT_EQ(json["grids"]["level"][1], 512 * 64);
    EXPECT_EQ(json["grids"]["surface"][2], "level set");
}

// The same bytes on one thread and on three, and from one run to the next (OpenVDB's own UUID is random).
TEST(VdbWrite, SameBytesOnAnyNumberOfThreads) {
    const TempFolder temp;
    const Ball ball(4);
    for (const std::size_t threads : {1, 3}) {
        const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
        ball.write(temp / std::to_string(threads));
    }
    EXPECT_GT(contents(temp / "1").size(), 50000u);
    EXPECT_TRUE(contents(temp / "1") == contents(temp / "3"));
    Ball(3).write(temp / "other");
    EXPECT_NE(contents(temp / "1").substr(21, 36), contents(temp / "other").substr(21, 36));
}

// A place that takes no file, or no bytes, is an input error, not a silently short file.
TEST(VdbWrite, FailuresAreErrors) {
    const TempFolder temp;
    EXPECT_THROW(Ball(1).write(temp / "none/grid.vdb"), Error);
    if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "this system has no /dev/full";
    try {
        Ball(1).write("/dev/full");
        FAIL() << "/dev/full took data";
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::input);
        EXPECT_THAT(error.what(), testing::HasSubstr("disk is full"));
    }
    Context context;
    context.cancel();
    const Ball ball(1);
    EXPECT_THROW(writeVdb({ball.grid, &ball.cut, &ball.regions, &ball.kept, &Ball::distance}, temp / "c.vdb",
                          {}, context),
                 Cancelled);
}

} // namespace
} // namespace i2b
