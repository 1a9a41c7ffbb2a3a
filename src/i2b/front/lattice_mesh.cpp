#include "i2b/front/lattice_mesh.h"
#include "i2b/carve/vertices.h"
#include "i2b/core/error.h"
#include <fmt/format.h>

namespace i2b {

LatticeMesh::LatticeMesh(const CellGrid& grid, const KeptCells& kept) : grid_(grid), kept_(kept) {
    const std::vector<Mask::Ptr> active = activeVertices(grid, kept.levels);
    const std::vector<Mask::Ptr> front = frontVertices(grid, kept.levels, active);
    std::int64_t slots = 0;
    for (const Mask::Ptr& cells : kept.levels) {
        cells_.emplace_back(cells, cellCount_);
        cellCount_ += cells_.back().size();
    }
    for (std::size_t l = 0; l < active.size(); ++l) {
        points_.emplace_back(active[l], pointCount_);
        frontPoints_.emplace_back(front[l], slots);
        pointCount_ += points_[l].size();
        slots += frontPoints_[l].size();
    }
    if (pointCount_ >= std::numeric_limits<std::int32_t>::max() / 4) {
        throw Error(ErrorKind::input, fmt::format("{} cells are more than a mesh of 32-bit labels can hold", cellCount_),
                    "", "give a larger --size");
    }
    front_.resize(static_cast<std::size_t>(slots));
    std::vector<std::int32_t> fans(front_.size()), extras(front_.size());
    for (std::size_t l = 0; l < frontPoints_.size(); ++l) {
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

RawVector<Vec3> LatticeMesh::latticePoints(std::size_t room) const {
    RawVector<Vec3> positions;
    positions.reserve(static_cast<std::size_t>(pointCount()) + room);
    positions.resize(static_cast<std::size_t>(pointCount()));
    for (int l = 0; l < pointLevels(); ++l) {
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

Vec3 LatticeMesh::latticePoint(std::int32_t point) const {
    std::int64_t own = point;
    if (own >= pointCount_) { // of the last vertex whose further points begin no later
        const auto after = std::upper_bound(front_.begin(), front_.end(), point, [](std::int32_t n, const FrontPoint& p) { return n < p.firstExtra; });
        own = (after - 1)->point;
    }
    int level = pointLevels() - 1;
    while (points(level).first() > own || points(level).size() == 0) --level;
    return lattice().corner(level, points(level).at(own));
}

LatticeMesh::Reader::Reader(const LatticeMesh& mesh)
    : mesh_(mesh), touching_(touchingLevels(mesh.grid_)), lookup_(mesh.grid_, mesh.kept_.levels), isCubes_(mesh.cubes()),
      spots_(spotsAlong * spotsAlong * spotsAlong) {
    for (const RankedMask& cells : mesh.cells_) kept_.emplace_back(cells);
    for (const CellLevel& level : mesh.grid_.levels) cells_.emplace_back(*level.cells);
    for (const RankedMask& points : mesh.points_) points_.emplace_back(points);
    for (const RankedMask& points : mesh.frontPoints_) frontPoints_.emplace_back(points);
}

// What was looked up stays good as long as cells of the same node follow each other.
void LatticeMesh::Reader::enter(int level, const Index3& c) {
    const Index3 at{c[0] >> 3, c[1] >> 3, c[2] >> 3};
    if (level == nodeLevel_ && at == nodeAt_) return;
    ++node_;
    nodeLevel_ = level;
    nodeAt_ = at;
    origin_ = {32 * at[0], 32 * at[1], 32 * at[2]};
    hasFiner_ = mayHaveFiner(level, at);
}

// Most nodes are far from any finer cell: their faces have four vertices, and nobody need look for more.
bool LatticeMesh::Reader::mayHaveFiner(int level, const Index3& node) {
    if (!isCubes_) return true;
    const auto finer = static_cast<std::size_t>(mesh_.levelOf(level).finest() + 1);
    if (finer >= points_.size()) return false;
    for (int i = 0; i < 27; ++i) { // the nodes of points in it, and those that begin on its upper sides
        const Index3 at{2 * node[0] + i / 9, 2 * node[1] + i / 3 % 3, 2 * node[2] + i % 3};
        if (points_[finer].leafIndex({8 * at[0], 8 * at[1], 8 * at[2]}) >= 0) return true;
    }
    return false;
}

// Finds the faces of cell c in one direction: one, or up to four where the cells across are finer along the face; none
// that nobody asked for.
int LatticeMesh::Reader::neighbours(int level, const Index3& c, int direction) {
    const auto axis = static_cast<std::size_t>(direction >> 1);
    const int side = direction & 1;
    Index3 n = c;
    n[axis] += side ? 1 : -1;
    CellFace& face = found_[0];
    face = CellFace{};
    if (n[axis] < 0 || n[axis] >= mesh_.lattice().cells(mesh_.levelOf(level))[axis]) {
        face.kind = FaceKind::side;
        face.side = static_cast<std::uint8_t>(direction);
    } else if (const std::int64_t rank = kept_[static_cast<std::size_t>(level)].rank(n); rank >= 0) {
        if (rank <= above_) return 0;
        face.other = rank;
    } else if (hasCell(level, n)) {
        face.kind = FaceKind::front;
    } else {
        return piecesAcross(level, c, axis, side);
    }
    Piece piece{{4 * c[0], 4 * c[1], 4 * c[2]}, {4 * c[0] + 4, 4 * c[1] + 4, 4 * c[2] + 4}, static_cast<int>(axis), side};
    piece.low[axis] = piece.high[axis] = 4 * (c[axis] + side);
    face.level = static_cast<std::uint8_t>(mesh_.levelOf(level).finest());
    fill(face, level, piece);
    return 1;
}

// The face in quarters, each of which belongs to one cell across; quarters of the same cell make one piece.
int LatticeMesh::Reader::piecesAcross(int level, const Index3& c, std::size_t axis, int side) {
    const LevelTriple& own = mesh_.levelOf(level);
    const std::size_t b = (axis + 1) % 3, d = (axis + 2) % 3;
    int count = 0;
    unsigned covered = 0;
    for (int q = 0; q < 4; ++q) {
        if (covered >> q & 1) continue;
        Index3 at{2 * c[0], 2 * c[1], 2 * c[2]};
        at[axis] += side ? 2 : -1;
        at[b] += q & 1, at[d] += q >> 1;
        for (std::size_t m : touching_[static_cast<std::size_t>(level)]) {
            const LevelTriple& theirs = mesh_.levelOf(static_cast<int>(m));
            const Index3 n = ancestor(at, halvedLevel(own), theirs);
            if (!hasCell(static_cast<int>(m), n)) continue;
            const int nb = theirs[b] > own[b] ? 1 : 2, nd = theirs[d] > own[d] ? 1 : 2; // quarters covered
            for (int j = 0; j < nd; ++j) {
                for (int i = 0; i < nb; ++i) covered |= 1u << (q + i + 2 * j);
            }
            Piece piece{{4 * c[0], 4 * c[1], 4 * c[2]}, {}, static_cast<int>(axis), side};
            piece.low[axis] += 4 * side;
            piece.low[b] += 2 * (q & 1), piece.low[d] += 2 * (q >> 1);
            piece.high = piece.low;
            piece.high[b] += 2 * nb, piece.high[d] += 2 * nd;
            const std::int64_t other = kept_[m].rank(n);
            if (other >= 0 && other <= above_) break;
            CellFace& face = found_[static_cast<std::size_t>(count++)];
            face = CellFace{};
            face.other = other;
            face.kind = face.other >= 0 ? FaceKind::internal : FaceKind::front;
            face.level = static_cast<std::uint8_t>(std::max(own.finest(), theirs.finest()));
            fill(face, level, piece);
            break;
        }
    }
    return count;
}

// The polygon about +axis or -axis, with the vertices on the middle of its edges.
void LatticeMesh::Reader::fill(CellFace& face, int level, const Piece& piece) {
    const auto b = static_cast<std::size_t>((piece.axis + 1) % 3), d = static_cast<std::size_t>((piece.axis + 2) % 3);
    constexpr std::array<std::array<int, 2>, 4> ring{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}}; // about +axis
    const auto corner = [&](std::size_t k) {
        Index3 v = piece.low;
        if (ring[k][0]) v[b] = piece.high[b];
        if (ring[k][1]) v[d] = piece.high[d];
        return v;
    };
    for (std::size_t i = 0; i < 4; ++i) {
        const std::size_t k = piece.side ? i : (4 - i) % 4, next = piece.side ? (i + 1) % 4 : (7 - i) % 4;
        const Index3 v = corner(k), w = corner(next);
        addVertex(face, level, piece, v);
        if (!hasFiner_) continue;
        addVertex(face, level, piece, {(v[0] + w[0]) / 2, (v[1] + w[1]) / 2, (v[2] + w[2]) / 2});
    }
}

// Cells that have a point for a corner touch the cell, so their finest level is at most one away from the cell's.
LatticeMesh::Reader::Spot LatticeMesh::Reader::findPoint(const Index3& at, const LevelTriple& quarter, int finest) {
    Index3 v{};
    for (int l = std::min(hasFiner_ ? finest + 1 : finest, mesh_.pointLevels() - 1); l >= std::max(finest - 1, 0); --l) {
        bool whole = true;
        for (std::size_t a = 0; a < 3; ++a) {
            const int shift = l - quarter[a];
            whole = whole && (shift >= 0 || (at[a] & ((1 << -shift) - 1)) == 0);
            v[a] = shift >= 0 ? at[a] << shift : at[a] >> -shift;
        }
        if (!whole) continue;
        if (const std::int64_t point = points_[static_cast<std::size_t>(l)].rank(v); point >= 0) {
            return {node_, static_cast<std::int32_t>(point), static_cast<std::int32_t>(frontPoints_[static_cast<std::size_t>(l)].rank(v))};
        }
    }
    return {node_, -1, -1};
}

LatticeMesh::Reader::Spot LatticeMesh::Reader::spotAt(int level, const Index3& at) {
    const auto look = [&] {
        const LevelTriple& own = mesh_.levelOf(level);
        return findPoint(at, halvedLevel(halvedLevel(own)), own.finest());
    };
    const int x = at[0] - origin_[0], y = at[1] - origin_[1], z = at[2] - origin_[2];
    if ((x | y | z) & 1) return look(); // few, where cells are finer across a face
    Spot& spot = spots_[static_cast<std::size_t>((x / 2 * spotsAlong + y / 2) * spotsAlong + z / 2)];
    if (spot.node != node_) spot = look();
    return spot;
}

std::int32_t LatticeMesh::Reader::pointAt(const Spot& spot, int octant) const {
    if (spot.front < 0) return spot.point;
    const FrontPoint& front = mesh_.front_[static_cast<std::size_t>(spot.front)];
    const std::uint8_t component = vertexPattern(front.pattern).component[static_cast<std::size_t>(octant)];
    return component > 0 && component != noFan ? front.firstExtra + component - 1 : spot.point;
}

bool LatticeMesh::Reader::corners(int level, const Index3& c, std::array<std::int32_t, 8>& points) {
    enter(level, c);
    if (hasFiner_) return false;
    for (int k = 0; k < 8; ++k) {
        const Spot spot = spotAt(level, {4 * (c[0] + (k & 1)), 4 * (c[1] + (k >> 1 & 1)), 4 * (c[2] + (k >> 2))});
        points[static_cast<std::size_t>(k)] = pointAt(spot, ~k & 7);
    }
    return true;
}

// The cells of nodes that have cells on both sides along an axis, too.
LeafBits LatticeMesh::Reader::deepCells(int level, std::size_t node) {
    const RankedMask& cells = mesh_.cells(level);
    const Index3 o = toIndex(cells.leaf(node).origin());
    const auto bitsAt = [&](int dx, int dy, int dz) {
        const Index3 at{o[0] + 8 * dx, o[1] + 8 * dy, o[2] + 8 * dz};
        const std::int32_t leaf = std::min({at[0], at[1], at[2]}) < 0 ? -1 : kept_[static_cast<std::size_t>(level)].leafIndex(at);
        return leaf < 0 ? LeafBits{} : leafBits(&cells.leaf(static_cast<std::size_t>(leaf)));
    };
    const auto eroded = [](const LeafBits& before, const LeafBits& own, const LeafBits& next, int axis) {
        const LeafBits up = bits::neighbourUp(own, next, axis), down = bits::neighbourDown(own, before, axis);
        LeafBits both{};
        for (std::size_t x = 0; x < 8; ++x) both[x] = own[x] & up[x] & down[x];
        return both;
    };
    const auto alongZ = [&](int dx, int dy) { return eroded(bitsAt(dx, dy, -1), bitsAt(dx, dy, 0), bitsAt(dx, dy, 1), 2); };
    const auto alongYZ = [&](int dx) { return eroded(alongZ(dx, -1), alongZ(dx, 0), alongZ(dx, 1), 1); };
    return eroded(alongYZ(-1), alongYZ(0), alongYZ(1), 0);
}

void LatticeMesh::Reader::lookUp(int level, const Index3& c, std::array<Upper, 3>& upper) {
    enter(level, c);
    std::array<std::int32_t, 8> point{}; // by bits x, y, z
    for (int k = 1; k < 8; ++k) point[static_cast<std::size_t>(k)] = spotAt(level, {4 * (c[0] + (k & 1)), 4 * (c[1] + (k >> 1 & 1)), 4 * (c[2] + (k >> 2))}).point;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::size_t own = std::size_t(1) << axis, b = std::size_t(1) << (axis + 1) % 3, d = std::size_t(1) << (axis + 2) % 3;
        Index3 n = c;
        ++n[axis];
        upper[axis] = {static_cast<std::int32_t>(cell(level, n)), {point[own], point[own | b], point[own | b | d], point[own | d]}};
    }
    std::ranges::sort(upper, {}, &Upper::other);
}

void LatticeMesh::Reader::addVertex(CellFace& face, int level, const Piece& piece, const Index3& at) {
    const Spot spot = spotAt(level, at);
    if (spot.point < 0) return; // no vertex on the middle of this edge
    const std::size_t i = face.vertices++;
    if (spot.front < 0) {
        face.points[i] = spot.point;
        return;
    }
    // The octant of the cell beside the vertex, on the face's side of it.
    const int axis = piece.axis;
    int octant = piece.side ? 0 : 1 << axis;
    for (int k = 1; k < 3; ++k) {
        const auto a = static_cast<std::size_t>((axis + k) % 3);
        if (at[a] != piece.high[a]) octant |= 1 << a;
    }
    face.points[i] = pointAt(spot, octant);
    if (face.kind == FaceKind::front) {
        const FrontPoint& front = mesh_.front_[static_cast<std::size_t>(spot.front)];
        const int across = octant & ~(1 << axis);
        face.fans[i] = front.firstFan + vertexPattern(front.pattern).fan[static_cast<std::size_t>(quarterFace(axis, across))];
    }
}

} // namespace i2b
