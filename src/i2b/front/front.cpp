#include "i2b/front/front.h"
#include "i2b/core/checksum.h"
#include "i2b/front/join_faces.h"
#include <algorithm>
#include <fmt/format.h>
#include <limits>

namespace i2b {
namespace {

struct FacePiece { // the front faces of one node's cells
    std::vector<std::int32_t> owner, fans;
    std::vector<std::uint8_t> size, level;
};

void collectFaces(const LatticeMesh& mesh, int level, std::size_t node, LatticeMesh::Reader& reader, FacePiece& out) {
    const RankedMask& cells = mesh.cells(level);
    const Index3 o = toIndex(cells.leaf(node).origin());
    auto rank = static_cast<std::int32_t>(cells.leafFirst(node));
    constexpr auto noInternal = std::numeric_limits<std::int64_t>::max();
    bits::forEach(leafBits(&cells.leaf(node)), [&](int x, int y, int z) {
        const auto take = [&](const CellFace& face) {
            if (face.kind != FaceKind::front) return;
            out.owner.push_back(rank);
            out.size.push_back(face.vertices);
            out.level.push_back(face.level);
            out.fans.insert(out.fans.end(), face.fans.begin(), face.fans.begin() + face.vertices);
        };
        reader.faces(level, {o[0] + x, o[1] + y, o[2] + z}, take, noInternal);
        ++rank;
    });
}

// Where axes split on their own a vertex' level tells the smallest edge alone: looks at the cells around it.
void sizesPerAxis(Front& front, const LatticeMesh& mesh) {
    for (int l = 0; l < mesh.pointLevels(); ++l) {
        const RankedMask& points = mesh.frontPoints(l);
        parallelChunks(points.leafCount(), 16, [&](std::size_t begin, std::size_t end, std::size_t) {
            LatticeMesh::Reader reader(mesh);
            for (std::size_t i = begin; i < end; ++i) {
                std::int64_t slot = points.leafFirst(i);
                const Index3 o = toIndex(points.leaf(i).origin());
                bits::forEach(leafBits(&points.leaf(i)), [&](int x, int y, int z) {
                    LevelTriple finest;
                    reader.cellsAround(l, {o[0] + x, o[1] + y, o[2] + z}, [&](int level, const Index3&) { finest = finerOf(finest, mesh.levelOf(level)); });
                    const LatticeMesh::FrontPoint& p = mesh.frontPoint(slot++);
                    for (std::int32_t f = 0; f < vertexPattern(p.pattern).fans; ++f) {
                        front.size[static_cast<std::size_t>(p.firstFan + f)] = mesh.lattice().cellSize(finest);
                        front.h[static_cast<std::size_t>(p.firstFan + f)] = mesh.lattice().h(finest);
                    }
                });
            }
        });
    }
}

// From a vertex to the middle of the octants of one component, in edges of the cells around it.
Vec3 towardsComponent(const VertexPattern& pattern, std::uint8_t component) {
    Vec3 sum;
    double n = 0;
    for (int o = 0; o < 8; ++o) {
        if (pattern.component[static_cast<std::size_t>(o)] != component) continue;
        sum += {o & 1 ? 0.5 : -0.5, o & 2 ? 0.5 : -0.5, o & 4 ? 0.5 : -0.5};
        n += 1;
    }
    return n > 0 ? sum / n : sum;
}

void addVertices(Front& front, const LatticeMesh& mesh) {
    const auto n = static_cast<std::size_t>(mesh.fanCount());
    front.front.resize(n), front.corePoint.resize(n), front.h.resize(n), front.size.resize(n), front.inside.resize(n), front.direction.resize(n), front.outside.resize(n);
    for (int l = 0; l < mesh.pointLevels(); ++l) {
        mesh.frontPoints(l).forEach([&](std::int64_t slot, const Index3& v) {
            const LatticeMesh::FrontPoint& p = mesh.frontPoint(slot);
            const VertexPattern& pattern = vertexPattern(p.pattern);
            for (std::size_t f = 0; f < pattern.fans; ++f) {
                const std::size_t i = static_cast<std::size_t>(p.firstFan) + f;
                const std::uint8_t component = pattern.fanComponent[f];
                front.front[i] = mesh.lattice().corner(l, v);
                front.inside[i] = towardsComponent(pattern, component);
                front.corePoint[i] = component == 0 ? p.point : p.firstExtra + component - 1;
                front.h[i] = mesh.lattice().h(l);
                front.size[i] = mesh.lattice().cellSize(l);
                front.direction[i] = pattern.direction[f];
                front.outside[i] = p.outside;
            }
        });
    }
    if (!mesh.cubes()) sizesPerAxis(front, mesh);
    parallelFor(n, [&](std::size_t i) {
        const Vec3 s = front.size[i];
        front.inside[i] = front.front[i] + Vec3{front.inside[i].x * s.x, front.inside[i].y * s.y, front.inside[i].z * s.z};
    }, 2048);
}

// One after another, in the order of levels and cells.
Polygons putTogether(const std::vector<FacePiece>& pieces, Front& front) {
    std::vector<std::size_t> face(pieces.size()), side(pieces.size());
    for (std::size_t p = 0; p < pieces.size(); ++p) face[p] = pieces[p].owner.size(), side[p] = pieces[p].fans.size();
    const std::size_t faces = exclusiveScan(face), sides = exclusiveScan(side);
    Polygons polygons;
    polygons.start.resize(faces + 1), polygons.vertices.resize(sides);
    polygons.start.back() = sides;
    front.ownerCell.resize(faces), front.level.resize(faces);
    parallelFor(pieces.size(), [&](std::size_t p) {
        const FacePiece& piece = pieces[p];
        const auto first = static_cast<std::ptrdiff_t>(face[p]);
        std::copy(piece.owner.begin(), piece.owner.end(), front.ownerCell.begin() + first);
        std::copy(piece.level.begin(), piece.level.end(), front.level.begin() + first);
        std::copy(piece.fans.begin(), piece.fans.end(), polygons.vertices.begin() + static_cast<std::ptrdiff_t>(side[p]));
        std::size_t at = side[p];
        for (std::size_t i = 0; i < piece.size.size(); ++i) polygons.start[face[p] + i] = at, at += piece.size[i];
    }, 1);
    return polygons;
}

} // namespace

Front buildFront(const LatticeMesh& mesh, double thickness) {
    Front front;
    addVertices(front, mesh);
    std::vector<FacePiece> pieces;
    for (int l = 0; l < mesh.levels(); ++l) {
        constexpr std::size_t chunk = 32;
        const std::size_t nodes = mesh.cells(l).leafCount(), before = pieces.size();
        pieces.resize(before + (nodes + chunk - 1) / chunk);
        parallelChunks(nodes, chunk, [&](std::size_t begin, std::size_t end, std::size_t c) {
            LatticeMesh::Reader reader(mesh);
            for (std::size_t node = begin; node < end; ++node) collectFaces(mesh, l, node, reader, pieces[before + c]);
        });
    }
    const auto wallStart = [&](std::size_t i) {
        const Vec3 d{double(front.direction[i][0]), double(front.direction[i][1]), double(front.direction[i][2])};
        const Vec3 b = front.front[i] + d * (thickness * front.h[i]);
        return FrontMesh::Point{b.x, b.y, b.z};
    };
    front.mesh = joinFaces(front.front.size(), wallStart, putTogether(pieces, front), "the front is not manifold");
    front.part.assign(front.ownerCell.size(), 0);
    front.corePoints = static_cast<std::int32_t>(mesh.pointCount());
    front.pieces.assign(front.ownerCell.size(), 1);
    return front;
}

void assignParts(Front& front, const SurfaceIndex& index) {
    parallelFor(front.ownerCell.size(), [&](std::size_t f) {
        Vec3 centre;
        double n = 0;
        for (auto v : front.mesh.fv_range(FrontMesh::FaceHandle(static_cast<int>(f)))) {
            const auto& p = front.mesh.point(v);
            centre += {p[0], p[1], p[2]};
            n += 1;
        }
        const ClosestPoint hit = index.closest(centre / n);
        if (hit) front.part[f] = index.surface().partOf[hit.triangle];
    });
}

double Front::cornerAt(std::size_t vertex, std::size_t before, std::size_t next) const {
    const Vec3 up = normalized(front[vertex] - wall(vertex));
    const auto scaled = [&](const Vec3& p, const Vec3& q, const Vec3& r) { return dot(cross(normalized(q - p), normalized(r - p)), up); };
    return std::min(scaled(wall(vertex), wall(before), wall(next)), scaled(front[vertex], front[before], front[next]));
}

bool Front::staysWhole(std::size_t face) const { return std::binary_search(whole.begin(), whole.end(), ownerCell[face]); }

bool Front::areOnOneEdge(std::span<const std::int32_t> vertices) const {
    std::array<std::int32_t, 3> points{}; // of the lattice; on more than three there is a corner
    std::size_t n = 0;
    const auto add = [&](std::int32_t point) {
        if (std::find(points.begin(), points.begin() + static_cast<std::ptrdiff_t>(n), point) != points.begin() + static_cast<std::ptrdiff_t>(n)) return true;
        if (n == points.size()) return false;
        points[n++] = point;
        return true;
    };
    for (const std::int32_t v : vertices) {
        const auto i = static_cast<std::size_t>(v);
        if (i < firstInserted()) {
            if (!add(corePoint[i])) return false;
            continue;
        }
        for (const std::int32_t end : inserted[i - firstInserted()].ends) {
            if (!add(corePoint[static_cast<std::size_t>(end)])) return false;
        }
    }
    if (n < points.size()) return true;
    for (std::size_t middle = 0; middle < n; ++middle) {
        const auto [low, high] = std::minmax(points[(middle + 1) % 3], points[(middle + 2) % 3]);
        if (std::binary_search(hanging.begin(), hanging.end(), Hanging{points[middle], {low, high}})) return true;
    }
    return false;
}

std::string Front::validate() const {
    const std::size_t n = mesh.n_vertices(), m = mesh.n_faces();
    if (front.size() != n || corePoint.size() != n || h.size() != n || size.size() != n || inside.size() != n || direction.size() != n || outside.size() != n) {
        return "arrays per vertex differ in length";
    }
    if (ownerCell.size() != m || part.size() != m || level.size() != m || pieces.size() != m) return "arrays per face differ in length";
    for (auto v : mesh.vertices()) {
        if (mesh.is_isolated(v)) return fmt::format("vertex {} has no face", v.idx());
    }
    for (auto e : mesh.edges()) {
        if (!mesh.is_boundary(e)) continue;
        const auto he = mesh.halfedge_handle(e, 0);
        const auto a = static_cast<std::size_t>(mesh.from_vertex_handle(he).idx());
        const auto b = static_cast<std::size_t>(mesh.to_vertex_handle(he).idx());
        if ((outside[a] & outside[b]) == 0) {
            const Vec3& p = front[a];
            return fmt::format("open edge away from the domain's sides at ({} {} {})", p.x, p.y, p.z);
        }
    }
    for (std::size_t f = 1; f < m; ++f) {
        if (ownerCell[f] < ownerCell[f - 1]) return "faces are not ordered by owner cell";
    }
    return "";
}

std::uint64_t Front::checksum() const {
    Checksum sum;
    sum.add(std::span<const Vec3>(front));
    sum.add(std::span<const std::int32_t>(ownerCell));
    sum.add(std::span<const std::int32_t>(part));
    for (const Inserted& i : inserted) sum.bytes(&i, sizeof i);
    sum.add(std::span<const std::int32_t>(movedPoints));
    sum.add(std::span<const Vec3>(movedTo));
    for (auto v : mesh.vertices()) {
        const auto& p = mesh.point(v);
        sum.bytes(&p, sizeof p);
    }
    return sum.value();
}

} // namespace i2b
