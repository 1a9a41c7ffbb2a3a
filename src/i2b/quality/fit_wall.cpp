#include "i2b/quality/fit_wall.h"
#include "i2b/core/collect.h"
#include "i2b/core/parallel.h"
#include "i2b/core/quantile.h"
#include <algorithm>
#include <tbb/parallel_sort.h>

namespace i2b {
namespace {

constexpr double smallestSize = 1e-100; // m, so that collapsed faces divide by something
constexpr double depth = 1.25; // edges of a wall face: a cell that begins as far behind it is none of its layers, and hardly bent to the wall
constexpr double upper = 0.75; // of a cell's edges are no longer than its size: those along which it is squeezed do not count
constexpr int mostLayers = 100;
constexpr std::size_t mostFaces = 1000; // of a cell with more the wall face alone tells a size: each of its faces would be held against all

bool isChosen(const Patch& patch, const std::vector<std::string>& names) {
    return names.empty() ? patch.type == "wall"
                         : std::find(names.begin(), names.end(), patch.name) != names.end();
}

void addEdges(const PolyMesh& mesh, std::int32_t face, std::vector<double>& lengths) {
    const auto points = mesh.face(face);
    const Vec3* from = &mesh.points[static_cast<std::size_t>(points.back())];
    for (const std::int32_t v : points) {
        const Vec3* to = &mesh.points[static_cast<std::size_t>(v)];
        lengths.push_back(norm(*to - *from));
        from = to;
    }
}

Vec3 middleOf(const PolyMesh& mesh, std::int32_t face) {
    Vec3 sum;
    const auto points = mesh.face(face);
    for (const std::int32_t v : points) sum += mesh.points[static_cast<std::size_t>(v)];
    return (1.0 / static_cast<double>(points.size())) * sum;
}

// From a wall face inwards, cell by cell, to the first one that is none of its layers.
class WayIn {
  public:
    WayIn(const PolyMesh& mesh, const Rows& cellFaces) : mesh_(mesh), cellFaces_(cellFaces) {}

    // m, of that cell; where the way ends before it, as in a gap between two walls, of the last one.
    double sizeBehind(std::int32_t wallFace, const Vec3& area) {
        lengths_.clear();
        addEdges(mesh_, wallFace, lengths_);
        const double enough = depth * median(lengths_);
        const Vec3 inwards = -normalized(area);
        const double start = dot(middleOf(mesh_, wallFace), inwards);
        const int most = norm2(inwards) > 0 ? mostLayers : 0; // a collapsed face has no way in
        std::int32_t face = wallFace, cell = mesh_.owner[static_cast<std::size_t>(face)];
        for (int step = 0; step < most && cellFaces_[cell].size() <= mostFaces; ++step) {
            const std::int32_t next = opposite(cell, face, inwards);
            if (next < 0 || next >= mesh_.internalFaces()) break;
            const auto f = static_cast<std::size_t>(next);
            cell = mesh_.owner[f] == cell ? mesh_.neighbour[f] : mesh_.owner[f];
            face = next;
            if (dot(middleOf(mesh_, face), inwards) - start >= enough) break;
        }
        if (cellFaces_[cell].size() > mostFaces) return median(lengths_); // of the wall face
        lengths_.clear();
        for (const std::int32_t f : cellFaces_[cell]) addEdges(mesh_, f, lengths_);
        return quantile(lengths_, upper);
    }

  private:
    // Of the cell's faces that have no point of this one the innermost, or -1.
    std::int32_t opposite(std::int32_t cell, std::int32_t face, const Vec3& inwards) const {
        const auto points = mesh_.face(face);
        std::int32_t best = -1;
        for (const std::int32_t f : cellFaces_[cell]) {
            const auto other = mesh_.face(f);
            if (std::find_first_of(points.begin(), points.end(), other.begin(), other.end()) != points.end()) continue;
            if (best < 0 || dot(middleOf(mesh_, f) - middleOf(mesh_, best), inwards) > 0) best = f;
        }
        return best;
    }

    const PolyMesh& mesh_;
    const Rows& cellFaces_;
    std::vector<double> lengths_;
};

// Per face how many corners those before it have, and of all.
std::vector<std::size_t> cornersBefore(const PolyMesh& mesh, const std::vector<std::int32_t>& faces) {
    std::vector<std::size_t> before(faces.size() + 1, 0);
    parallelFor(faces.size(), [&](std::size_t i) { before[i] = mesh.face(faces[i]).size(); }, 4096);
    exclusiveScan(before);
    return before;
}

// Of each face the size of the cell behind it; of each node the median of the faces around it; of each face that of
// its nodes. start: cornersBefore() of the faces.
void measureSizes(const PolyMesh& mesh, const Rows& cellFaces, const std::vector<std::size_t>& start, Wall& wall) {
    struct Around {
        std::int32_t node;
        double size; // of a face
        bool operator<(const Around& o) const { return node != o.node ? node < o.node : size < o.size; }
    };
    std::vector<Around> around(start.back());
    parallelChunks(wall.faces.size(), 512, [&](std::size_t begin, std::size_t end, std::size_t) {
        WayIn way(mesh, cellFaces);
        for (std::size_t i = begin; i < end; ++i) {
            const auto face = mesh.face(wall.faces[i]);
            const double size = std::max(way.sizeBehind(wall.faces[i], wall.shapes[i].area), smallestSize);
            for (std::size_t k = 0; k < face.size(); ++k) around[start[i] + k] = {face[k], size};
        }
    });
    tbb::parallel_sort(around);
    const RawVector<std::size_t> first = collect<std::size_t>(around.size(), [&](std::size_t i, const auto& put) {
        if (i == 0 || around[i - 1].node != around[i].node) put(i);
    });
    wall.nodes.resize(first.size()), wall.nodeH.resize(first.size());
    parallelFor(first.size(), [&](std::size_t n) {
        const std::size_t end = n + 1 < first.size() ? first[n + 1] : around.size();
        wall.nodes[n] = around[first[n]].node;
        wall.nodeH[n] = around[first[n] + (end - first[n] - 1) / 2].size;
    }, 4096);
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

Wall collectWall(const PolyMesh& mesh, const Rows& cellFaces, const std::vector<std::string>& patches, const std::function<bool(std::int32_t)>& isWanted) {
    Wall wall;
    for (const Patch& patch : mesh.patches)
        if (isChosen(patch, patches))
            for (std::int32_t f = patch.start; f < patch.start + patch.count; ++f) wall.faces.push_back(f);
    std::sort(wall.faces.begin(), wall.faces.end());
    if (isWanted) {
        const RawVector<std::int32_t> wanted = collect<std::int32_t>(wall.faces.size(), [&](std::size_t i, const auto& put) {
            if (isWanted(wall.faces[i])) put(wall.faces[i]);
        }, 1024);
        wall.faces.assign(wanted.begin(), wanted.end());
    }
    const std::vector<std::size_t> start = cornersBefore(mesh, wall.faces);
    wall.edges.resize(start.back());
    parallelFor(wall.faces.size(), [&](std::size_t i) {
        const auto face = mesh.face(wall.faces[i]);
        for (std::size_t k = 0; k < face.size(); ++k) {
            const auto [a, b] = std::minmax(face[k], face[(k + 1) % face.size()]);
            wall.edges[start[i] + k] = {a, b, static_cast<std::int32_t>(i)};
        }
    }, 1024);
    tbb::parallel_sort(wall.edges);
    wall.shapes.resize(wall.faces.size());
    parallelFor(wall.faces.size(), [&](std::size_t i) { wall.shapes[i] = measureFace(mesh, wall.faces[i]); });
    measureSizes(mesh, cellFaces, start, wall);
    return wall;
}

} // namespace i2b
