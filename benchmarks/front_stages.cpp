// The front as surfaces to look at: as the cells leave it, after the fit has smoothed it and made room, and its image
// on the geometry, the wall.
//
//     front_stages GEOMETRY.stl SIZE FOLDER      (external flow; SIZE in metres)
//
// writes FOLDER/front-start.ply, front-smoothed.ply and front-wall.ply.
#include "i2b/core/error.h"
#include "i2b/fit/fit.h"
#include "i2b/front/front.h"
#include "i2b/program/generate.h"
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <iostream>

namespace {

using namespace i2b;

// points: per vertex of the front, m. Faces turned so that they look out of the geometry.
void writeSurface(const Front& front, const std::vector<Vec3>& points, const std::filesystem::path& file) {
    std::ofstream out(file);
    out << "ply\nformat ascii 1.0\nelement vertex " << points.size()
        << "\nproperty double x\nproperty double y\nproperty double z\nelement face " << front.mesh.n_faces()
        << "\nproperty list uchar int vertex_indices\nend_header\n";
    for (const Vec3& p : points) out << fmt::format("{} {} {}\n", p.x, p.y, p.z);
    for (const auto face : front.mesh.faces()) {
        std::vector<int> corners;
        for (const auto v : front.mesh.fv_ccw_range(face)) corners.push_back(v.idx());
        out << corners.size();
        for (auto v = corners.rbegin(); v != corners.rend(); ++v) out << ' ' << *v;
        out << '\n';
    }
    if (!out.flush()) throw Error(ErrorKind::input, "cannot write " + file.string(), "", "choose another folder");
}

std::vector<Vec3> wallPoints(const Front& front) {
    std::vector<Vec3> points;
    for (const auto v : front.mesh.vertices()) {
        const auto& p = front.mesh.point(v);
        points.push_back({p[0], p[1], p[2]});
    }
    return points;
}

void run(const std::string& geometry, double size, const std::filesystem::path& folder) {
    Options options;
    options.geometry.files = {geometry};
    options.size.surface = size;
    Context context;
    const auto grid = generateGrid(options, context, Road::mesh);
    const LatticeMesh lattice(grid->grid, grid->kept);
    Front front = buildFront(lattice, startThickness);
    std::filesystem::create_directories(folder);
    writeSurface(front, front.front, folder / "front-start.ply");
    const FeatureGraph features = buildFeatureGraph(grid->surface, featureOptions(options.geometry, grid->featureLines));
    fitFront(front, lattice, *grid->index, features, options.fit, context);
    writeSurface(front, front.front, folder / "front-smoothed.ply");
    writeSurface(front, wallPoints(front), folder / "front-wall.ply");
    std::cout << fmt::format("front: {} faces, {} vertices\n", front.mesh.n_faces(), front.mesh.n_vertices());
}

} // namespace

int main(int argc, char** argv) try {
    if (argc != 4)
        throw i2b::Error(i2b::ErrorKind::usage, "three arguments are needed", "command line",
                         "write front_stages GEOMETRY.stl SIZE FOLDER");
    run(argv[1], std::stod(argv[2]), argv[3]);
    return 0;
} catch (const std::exception& e) {
    std::cerr << "front_stages: " << e.what() << '\n';
    return 2;
}
