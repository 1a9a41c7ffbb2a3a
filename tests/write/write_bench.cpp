// Writes a structured mesh of n^3 hexahedra in every mesh format and prints seconds, size and speed.
#include "i2b/core/memory.h"
#include "i2b/write/foam_write.h"
#include "i2b/write/ply_write.h"
#include "i2b/write/vtu_write.h"
#include "write/ball_sample.h"
#include "write/mesh_samples.h"
#include <chrono>
#include <fmt/format.h>

using namespace i2b;

namespace {

std::uint64_t bytesUnder(const std::filesystem::path& path) {
    if (!std::filesystem::is_directory(path)) return std::filesystem::file_size(path);
    std::uint64_t sum = 0;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(path))
        if (entry.is_regular_file()) sum += entry.file_size();
    return sum;
}

template <class Body>
void measure(const char* name, const std::filesystem::path& path, const Body& body) {
    const auto start = std::chrono::steady_clock::now();
    body();
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    const double megabytes = static_cast<double>(bytesUnder(path)) / 1e6;
    fmt::print("{:<18}{:8.3f} s {:9.1f} MB {:8.0f} MB/s   peak {} MB\n", name, seconds, megabytes,
               megabytes / seconds, peakResidentBytes() / 1000000);
}

} // namespace

int main(int argc, char** argv) {
    const int n = argc > 1 ? std::atoi(argv[1]) : 100;
    const test::TempFolder temp;
    const std::filesystem::path folder = argc > 2 ? argv[2] : temp.path();
    PolyMesh mesh = test::boxMesh({n, n, n}, 0.01);
    const auto cells = static_cast<std::size_t>(mesh.cells);
    // Points off the lattice, as fitted ones are: otherwise the text is short and compresses like none.
    std::uint64_t state = 1;
    for (Vec3& p : mesh.points)
        for (int axis = 0; axis < 3; ++axis) {
            state = state * 6364136223846793005u + 1442695040888963407u;
            p[axis] += 1e-3 * static_cast<double>(state >> 11) * 0x1p-53;
        }
    mesh.cellLevel.assign(cells, 3);
    mesh.cellLayer.assign(cells, 0);
    std::vector<CellData> data{{"volume", std::vector<float>(cells)}};
    for (std::size_t c = 0; c < cells; ++c) data[0].values[c] = static_cast<float>(c);
    const Context context;
    fmt::print("{} cells, {} faces, peak before {} MB\n", mesh.cells, mesh.faces(),
               peakResidentBytes() / 1000000);
    for (const bool ascii : {false, true}) {
        const auto target = folder / (ascii ? "ascii" : "binary");
        measure(ascii ? "foam text" : "foam binary", target, [&] {
            AtomicFolder atomic(target);
            writeFoam(mesh, atomic, {.ascii = ascii, .note = {}}, context);
            atomic.commit();
        });
    }
    measure("vtu compressed", folder / "a.vtu", [&] { writeVtu(mesh, buildCellFaces(mesh), data, folder / "a.vtu", {}, context); });
    measure("vtu raw", folder / "b.vtu",
            [&] { writeVtu(mesh, buildCellFaces(mesh), data, folder / "b.vtu", {.compress = false}, context); });
    measure("ply all patches", folder / "a.ply", [&] {
        writePly(mesh, folder / "a.ply", context, {"bottom", "sides"});
    });

    const test::Ball ball(6);
    fmt::print(
        "ball: {} cells, {} cut\n",
        [&] {
            std::uint64_t cells = 0;
            for (const auto& level : ball.grid.levels) cells += level.cells->activeVoxelCount();
            return cells;
        }(),
        ball.cut.levels.back()->activeVoxelCount());
    measure("vdb", folder / "a.vdb", [&] { ball.write(folder / "a.vdb"); });
    measure("vdb masks alone", folder / "b.vdb",
            [&] { ball.write(folder / "b.vdb", {.caseName = {}, .version = {}, .values = false}); });
}
