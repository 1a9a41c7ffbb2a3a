#include "i2b/front/lattice_mesh.h"
#include "i2b/carve/vertices.h"
#include "i2b/core/error.h"
#include <fmt/format.h>

namespace i2b {

LatticeMesh::LatticeMesh(const CellGrid& grid, const KeptCells& kept) : grid_(grid) {
    const std::vector<Mask::Ptr> active = activeVertices(grid, kept.levels);
    const std::vector<Mask::Ptr> front = frontVertices(grid, kept.levels, active);
    std::int64_t slots = 0;
    for (std::size_t l = 0; l < grid.levels.size(); ++l) {
        cells_.emplace_back(kept.levels[l], cellCount_);
        points_.emplace_back(active[l], pointCount_);
        frontPoints_.emplace_back(front[l], slots);
        cellCount_ += cells_[l].size();
        pointCount_ += points_[l].size();
        slots += frontPoints_[l].size();
    }
    if (pointCount_ >= std::numeric_limits<std::int32_t>::max() / 4) {
        throw Error(ErrorKind::input, fmt::format("{} cells are more than a mesh of 32-bit labels can hold", cellCount_),
                    "", "give a larger --size");
    }
    front_.resize(static_cast<std::size_t>(slots));
    std::vector<std::int32_t> fans(front_.size()), extras(front_.size());
    for (std::size_t l = 0; l < grid.levels.size(); ++l) {
        const RankedMask& ranked = frontPoints_[l];
        parallelChunks(ranked.leafCount(), 16, [&](std::size_t begin, std::size_t end, std::size_t) {
            VertexLookup lookup(grid, kept.levels);
            RankedMask::Reader points(points_[l]);
            for (std::size_t i = begin; i < end; ++i) {
                auto slot = static_cast<std::size_t>(ranked.leafFirst(i));
                const Index3 o = toIndex(ranked.leaf(i).origin());
                bits::forEach(leafBits(&ranked.leaf(i)), [&](int x, int y, int z) {
                    const Index3 v{o[0] + x, o[1] + y, o[2] + z};
                    const VertexView view = lookup.view(static_cast<int>(l), v);
                    FrontPoint& p = front_[slot];
                    p.pattern = view.kept;
                    p.outside = static_cast<std::uint8_t>(view.outside);
                    p.point = static_cast<std::int32_t>(points.rank(v));
                    fans[slot] = vertexPattern(p.pattern).fans;
                    extras[slot] = vertexPattern(p.pattern).components - 1;
                    ++slot;
                });
            }
        });
    }
    fanCount_ = exclusiveScan(fans);
    extraPoints_ = exclusiveScan(extras);
    parallelFor(front_.size(), [&](std::size_t s) {
        front_[s].firstFan = fans[s];
        front_[s].firstExtra = static_cast<std::int32_t>(pointCount_ + extras[s]);
    });
}

std::vector<Vec3> LatticeMesh::latticePoints() const {
    std::vector<Vec3> positions(static_cast<std::size_t>(pointCount()));
    for (int l = 0; l < levels(); ++l) {
        points(l).forEach([&](std::int64_t rank, const Index3& v) {
            positions[static_cast<std::size_t>(rank)] = lattice().corner(l, v);
        });
    }
    parallelFor(front_.size(), [&](std::size_t s) {
        const FrontPoint& p = front_[s];
        for (int k = 1; k < vertexPattern(p.pattern).components; ++k) {
            positions[static_cast<std::size_t>(p.firstExtra + k - 1)] = positions[static_cast<std::size_t>(p.point)];
        }
    });
    return positions;
}

LatticeMesh::Reader::Reader(const LatticeMesh& mesh) : mesh_(mesh) {
    for (std::size_t l = 0; l < mesh.cells_.size(); ++l) {
        kept_.emplace_back(mesh.cells_[l]);
        points_.emplace_back(mesh.points_[l]);
        frontPoints_.emplace_back(mesh.frontPoints_[l]);
        cells_.emplace_back(*mesh.grid_.levels[l].cells);
    }
}

// Finds the faces of cell c in one direction: one, or four where the cells across are finer.
int LatticeMesh::Reader::neighbours(int level, const Index3& c, int direction) {
    const auto axis = static_cast<std::size_t>(direction >> 1);
    const int side = direction & 1;
    const auto l = static_cast<std::size_t>(level);
    Index3 n = c, low = c;
    n[axis] += side ? 1 : -1;
    low[axis] += side;
    CellFace& face = found_[0];
    face = CellFace{};
    if (n[axis] < 0 || n[axis] >= mesh_.lattice().cells(level)[axis]) {
        face.kind = FaceKind::side;
        face.side = static_cast<std::uint8_t>(direction);
    } else if (const std::int64_t rank = kept_[l].rank(n); rank >= 0) {
        face.other = rank;
    } else if (cells_[l].isValueOn(toCoord(n))) {
        face.kind = FaceKind::front;
    } else {
        const Index3 p{n[0] >> 1, n[1] >> 1, n[2] >> 1};
        if (level > 0 && cells_[l - 1].isValueOn(toCoord(p))) {
            face.other = kept_[l - 1].rank(p);
            face.kind = face.other >= 0 ? FaceKind::internal : FaceKind::front;
        } else { // finer
            for (int i = 0; i < 4; ++i) {
                Index3 child{2 * n[0], 2 * n[1], 2 * n[2]}, corner{2 * low[0], 2 * low[1], 2 * low[2]};
                child[axis] += side ? 0 : 1;
                child[(axis + 1) % 3] += i & 1, corner[(axis + 1) % 3] += i & 1;
                child[(axis + 2) % 3] += i >> 1, corner[(axis + 2) % 3] += i >> 1;
                CellFace& part = found_[static_cast<std::size_t>(i)];
                part = CellFace{};
                part.other = kept_[l + 1].rank(child);
                part.kind = part.other >= 0 ? FaceKind::internal : FaceKind::front;
                fill(part, level + 1, corner, static_cast<int>(axis), side);
            }
            return 4;
        }
    }
    fill(face, level, low, static_cast<int>(axis), side);
    return 1;
}

// The polygon with its low corner at low on the face's level, mid-edge vertices included.
void LatticeMesh::Reader::fill(CellFace& face, int faceLevel, const Index3& low, int axis, int side) {
    face.level = static_cast<std::uint8_t>(faceLevel);
    const auto b = static_cast<std::size_t>((axis + 1) % 3), c = static_cast<std::size_t>((axis + 2) % 3);
    constexpr std::array<std::array<int, 2>, 4> ring{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}}; // about +axis
    const bool finer = faceLevel + 1 < mesh_.levels();
    for (std::size_t i = 0; i < 4; ++i) {
        const std::size_t k = side ? i : (4 - i) % 4, next = side ? (i + 1) % 4 : (7 - i) % 4;
        Index3 v = low, mid{2 * low[0], 2 * low[1], 2 * low[2]};
        v[b] += ring[k][0], v[c] += ring[k][1];
        mid[b] += ring[k][0] + ring[next][0], mid[c] += ring[k][1] + ring[next][1];
        addVertex(face, faceLevel, v, faceLevel, low, axis, side);
        if (finer && points_[std::size_t(faceLevel) + 1].has(mid)) {
            addVertex(face, faceLevel + 1, mid, faceLevel, low, axis, side);
        }
    }
}

void LatticeMesh::Reader::addVertex(CellFace& face, int level, const Index3& at, int faceLevel, const Index3& low,
                                    int axis, int side) {
    Index3 v = at;
    const Index3 fine{2 * v[0], 2 * v[1], 2 * v[2]};
    std::int64_t point = -1;
    if (level + 1 < mesh_.levels()) point = points_[std::size_t(level) + 1].rank(fine);
    if (point >= 0) {
        v = fine;
        ++level;
    } else {
        point = points_[std::size_t(level)].rank(v);
    }
    const std::int64_t slot = frontPoints_[std::size_t(level)].rank(v);
    const std::size_t i = face.vertices++;
    face.points[i] = static_cast<std::int32_t>(point);
    if (slot < 0) return;
    // The octant of the cell beside the vertex, on the face's side of it.
    const int shift = level - faceLevel;
    int octant = side ? 0 : 1 << axis;
    for (int k = 1; k < 3; ++k) {
        const auto a = static_cast<std::size_t>((axis + k) % 3);
        if (v[a] != (low[a] + 1) << shift) octant |= 1 << a;
    }
    const FrontPoint& front = mesh_.front_[static_cast<std::size_t>(slot)];
    const VertexPattern& pattern = vertexPattern(front.pattern);
    const std::uint8_t component = pattern.component[static_cast<std::size_t>(octant)];
    if (component > 0 && component != noFan) face.points[i] = front.firstExtra + component - 1;
    if (face.kind == FaceKind::front) {
        const int across = octant & ~(1 << axis);
        face.fans[i] = front.firstFan + pattern.fan[static_cast<std::size_t>(quarterFace(axis, across))];
    }
}

} // namespace i2b
