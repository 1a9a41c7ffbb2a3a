#include "i2b/quality/fit_wall.h"
#include "i2b/core/parallel.h"
#include <algorithm>
#include <tbb/parallel_sort.h>

namespace i2b {
namespace {

constexpr double smallestSize = 1e-100; // m, so that collapsed faces divide by something
constexpr double strip = 5; // times its median edge is the longest of a face without width, as at the rim of a sheet: its length counts

bool isChosen(const Patch& patch, const std::vector<std::string>& names) {
    return names.empty() ? patch.type == "wall"
                         : std::find(names.begin(), names.end(), patch.name) != names.end();
}

// The lower one of two: a node pulled away lengthens half the edges around it, and must not be judged by
// those.
double median(std::vector<double>& values) {
    if (values.empty()) return 0;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>((values.size() - 1) / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

// Of each face the median of its edges, of strips the longest; of each node the median of the faces around it; of each face that of
// its nodes.
void measureSizes(const PolyMesh& mesh, Wall& wall) {
    struct Around {
        std::int32_t node;
        double size; // of a face
        bool operator<(const Around& o) const { return node != o.node ? node < o.node : size < o.size; }
    };
    std::vector<std::size_t> start(wall.faces.size());
    for (std::size_t i = 0; i < start.size(); ++i) start[i] = mesh.face(wall.faces[i]).size();
    std::vector<Around> around(exclusiveScan(start));
    parallelFor(wall.faces.size(), [&](std::size_t i) {
        const auto face = mesh.face(wall.faces[i]);
        std::vector<double> lengths;
        for (std::size_t k = 0; k < face.size(); ++k)
            lengths.push_back(norm(mesh.points[static_cast<std::size_t>(face[(k + 1) % face.size()])] -
                                   mesh.points[static_cast<std::size_t>(face[k])]));
        const double longest = *std::max_element(lengths.begin(), lengths.end()), middle = median(lengths);
        const double size = std::max(longest > strip * middle ? longest : middle, smallestSize);
        for (std::size_t k = 0; k < face.size(); ++k) around[start[i] + k] = {face[k], size};
    });
    tbb::parallel_sort(around);
    for (std::size_t i = 0, end = 0; i < around.size(); i = end) {
        for (end = i; end < around.size() && around[end].node == around[i].node; ++end) {
        }
        wall.nodes.push_back(around[i].node);
        wall.nodeH.push_back(around[i + (end - i - 1) / 2].size);
    }
    wall.faceH.resize(wall.faces.size());
    parallelFor(wall.faces.size(), [&](std::size_t i) {
        std::vector<double> sizes;
        for (const std::int32_t v : mesh.face(wall.faces[i])) sizes.push_back(wall.nodeH[nodePlace(wall, v)]);
        wall.faceH[i] = median(sizes);
    });
}

} // namespace

std::size_t nodePlace(const Wall& wall, std::int32_t point) {
    return static_cast<std::size_t>(std::lower_bound(wall.nodes.begin(), wall.nodes.end(), point) - wall.nodes.begin());
}

Wall collectWall(const PolyMesh& mesh, const std::vector<std::string>& patches) {
    Wall wall;
    for (const Patch& patch : mesh.patches)
        if (isChosen(patch, patches))
            for (std::int32_t f = patch.start; f < patch.start + patch.count; ++f) wall.faces.push_back(f);
    std::sort(wall.faces.begin(), wall.faces.end());
    for (std::size_t i = 0; i < wall.faces.size(); ++i) {
        const auto face = mesh.face(wall.faces[i]);
        for (std::size_t k = 0; k < face.size(); ++k) {
            const auto [a, b] = std::minmax(face[k], face[(k + 1) % face.size()]);
            wall.edges.push_back({a, b, static_cast<std::int32_t>(i)});
        }
    }
    tbb::parallel_sort(wall.edges);
    wall.shapes.resize(wall.faces.size());
    parallelFor(wall.faces.size(), [&](std::size_t i) { wall.shapes[i] = measureFace(mesh, wall.faces[i]); });
    measureSizes(mesh, wall);
    return wall;
}

} // namespace i2b
