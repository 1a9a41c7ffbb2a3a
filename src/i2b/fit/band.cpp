#include "i2b/fit/band.h"
#include "i2b/core/flags.h"
#include "i2b/core/give_up.h"
#include "i2b/core/raw_fill.h"
#include "i2b/core/rows.h"
#include "i2b/fit/band_marks.h"
#include "i2b/fit/band_pieces.h"
#include <algorithm>
#include <atomic>
#include <memory>

namespace i2b {
namespace {

// Of h. Prisms settle a fifth lower than they tend to on the whole, and by more in places.
constexpr double leastPrism = 0.7, highestPrism = 1.3;
constexpr double heightForRoom = 2.2;

// An edge of the wall with its length on the front, where it is the lattice's.
BandEdge wallEdge(const Band& band, std::int32_t a, std::int32_t b) {
    const auto frontOf = [&](std::int32_t w) { return static_cast<std::size_t>(band.frontNode[static_cast<std::size_t>(w)]); };
    return {b, static_cast<float>(band.h[static_cast<std::size_t>(a)] / norm(band.start[frontOf(b)] - band.start[frontOf(a)]))};
}

// Rows of item numbers, ascending in each. row(i, put) calls put(r) for every row of an item.
template <class Row>
Csr<std::int32_t> rowsOf(std::size_t rows, std::size_t first, std::size_t last, const Row& row) {
    Csr<std::int32_t> csr;
    turnIntoRows(rows, first, last, row, csr.start, csr.values);
    return csr;
}

// The cells of the core around each movable node.
Csr<std::int32_t> rowsOfCells(const BandCorners& corners, std::size_t rows) {
    return rowsOf(rows, 0, corners.cells.size(), [&](std::size_t c, const auto& put) {
        const auto offer = [&](std::int32_t n) {
            if (static_cast<std::size_t>(n) < rows) put(static_cast<std::size_t>(n));
        };
        const CornerCell& cell = corners.cells[c];
        if (cell.level != CornerCell::hasCorners) {
            std::ranges::for_each(cell.node, offer);
            return;
        }
        // Each node once, at the first of the cell's corners that has it.
        for (std::int32_t i = cell.node[0]; i < cell.node[1]; ++i) {
            for (const std::int32_t n : corners.list[static_cast<std::size_t>(i)].node) {
                std::int32_t first = cell.node[0];
                while (!corners.list[static_cast<std::size_t>(first)].has(n)) ++first;
                if (first == i) offer(n);
            }
        }
    });
}

// The prisms' corners around each wall and front node, numbers ascending.
Csr<std::int32_t> rowsOfPrisms(const BandCorners& corners, std::size_t rows) {
    return rowsOf(rows, corners.prisms, corners.list.size(), [&](std::size_t c, const auto& put) {
        for (const std::int32_t n : corners.list[c].node) put(static_cast<std::size_t>(n));
    });
}

// The edges, once each, from both ends, by node and by other end; make(a, b) gives the edge.
template <class Make>
Csr<BandEdge> edgesOf(std::size_t rows, const std::vector<BandPieces>& pieces, const Make& make) {
    RawVector<std::int64_t> next = filled<std::int64_t>(rows + 1, 0), first;
    const auto raise = [](std::int64_t& n) { return std::atomic_ref<std::int64_t>(n).fetch_add(1, std::memory_order_relaxed); };
    const auto forEdges = [&](const auto& f) {
        parallelFor(pieces.size(), [&](std::size_t p) {
            for (std::uint64_t e : pieces[p].edges) f(static_cast<std::uint32_t>(e >> 32), static_cast<std::uint32_t>(e)), f(static_cast<std::uint32_t>(e), static_cast<std::uint32_t>(e >> 32));
        }, 1);
    };
    forEdges([&](std::uint32_t a, std::uint32_t) { raise(next[a]); });
    RawVector<std::int32_t> other(static_cast<std::size_t>(exclusiveScan(next)));
    copyTo(first, next);
    forEdges([&](std::uint32_t a, std::uint32_t b) { other[static_cast<std::size_t>(raise(next[a]))] = static_cast<std::int32_t>(b); });
    Csr<BandEdge> edges;
    edges.start.resize(rows + 1);
    edges.start[rows] = 0;
    parallelFor(rows, [&](std::size_t r) {
        std::int32_t* const begin = other.data() + first[r];
        std::int32_t* const end = other.data() + next[r];
        std::sort(begin, end);
        edges.start[r] = std::unique(begin, end) - begin;
    });
    edges.values.resize(static_cast<std::size_t>(exclusiveScan(edges.start)));
    parallelFor(rows, [&](std::size_t r) {
        for (std::int64_t i = edges.start[r]; i < edges.start[r + 1]; ++i) {
            edges.values[static_cast<std::size_t>(i)] = make(static_cast<std::int32_t>(r), other[static_cast<std::size_t>(first[r] + i - edges.start[r])]);
        }
    });
    return edges;
}

// In the order of the pieces; room: for how many more memory is taken at once.
void appendCells(BandCorners& corners, const std::vector<BandPieces>& pieces, std::size_t room) {
    std::vector<std::size_t> first, firstCell;
    for (const BandPieces& p : pieces) first.push_back(p.corners.size()), firstCell.push_back(p.cells.size());
    corners.prisms = exclusiveScan(first);
    corners.cells.resize(exclusiveScan(firstCell));
    corners.list.reserve(corners.prisms + room);
    corners.list.resize(corners.prisms);
    parallelFor(pieces.size(), [&](std::size_t p) {
        std::ranges::copy(pieces[p].corners, corners.list.begin() + static_cast<std::ptrdiff_t>(first[p]));
        for (std::size_t i = 0; i < pieces[p].cells.size(); ++i) {
            CornerCell& cell = corners.cells[firstCell[p] + i] = pieces[p].cells[i];
            if (cell.level == CornerCell::hasCorners) cell.node[0] += static_cast<std::int32_t>(first[p]), cell.node[1] += static_cast<std::int32_t>(first[p]);
        }
    }, 1);
}

std::vector<std::array<float, 3>> inverseSizes(const LatticeMesh& mesh) {
    std::vector<std::array<float, 3>> sizes;
    for (int l = 0; l < mesh.levels(); ++l) {
        const Vec3 size = mesh.lattice().corner(l, {1, 1, 1}) - mesh.lattice().corner(l, {0, 0, 0});
        sizes.push_back({static_cast<float>(1 / size.x), static_cast<float>(1 / size.y), static_cast<float>(1 / size.z)});
    }
    return sizes;
}

// Numbers the band's core points: front, then movable, then fixed; within each in order of their numbers.
RawVector<std::int32_t> numberNodes(Band& band, const LatticeMesh& mesh, const BandMarks& marks, int rings) {
    const std::size_t points = marks.points.size();
    constexpr std::size_t chunk = 8192;
    const auto group = [&](std::size_t p) { return marks.points[p] == 1 ? 0 : marks.points[p] <= rings + 1 ? 1 : 2; };
    const std::size_t chunks = (points + chunk - 1) / chunk;
    std::vector<std::int32_t> next(3 * chunks, 0); // by group, then chunk
    parallelChunks(points, chunk, [&](std::size_t begin, std::size_t end, std::size_t c) {
        for (std::size_t p = begin; p < end; ++p) {
            if (marks.points[p]) ++next[static_cast<std::size_t>(group(p)) * chunks + c];
        }
    });
    const std::size_t nodes = band.walls + static_cast<std::size_t>(exclusiveScan(next));
    band.fronts = chunks ? static_cast<std::size_t>(next[chunks]) : 0;
    band.movable = band.walls + (chunks ? static_cast<std::size_t>(next[2 * chunks]) : 0);
    band.start.resize(nodes), band.h.resize(nodes), band.outside.resize(nodes), band.corePoint.resize(nodes - band.walls);
    RawVector<std::int32_t> nodeOf(points);
    parallelChunks(points, chunk, [&](std::size_t begin, std::size_t end, std::size_t c) {
        for (std::size_t p = begin; p < end; ++p) {
            nodeOf[p] = -1;
            if (!marks.points[p]) continue;
            const std::int32_t i = next[static_cast<std::size_t>(group(p)) * chunks + c]++;
            nodeOf[p] = static_cast<std::int32_t>(band.walls) + i;
            band.corePoint[static_cast<std::size_t>(i)] = static_cast<std::int32_t>(p);
        }
    });
    const auto nodeAt = [&](std::int64_t p) { return nodeOf[static_cast<std::size_t>(p)]; };
    for (int l = 0; l < mesh.pointLevels(); ++l) {
        const Index3 n = mesh.lattice().cells(l);
        mesh.points(l).forEach([&](std::int64_t rank, const Index3& v) {
            if (nodeAt(rank) < 0) return;
            const auto i = static_cast<std::size_t>(nodeAt(rank));
            band.start[i] = mesh.lattice().corner(l, v);
            band.h[i] = mesh.lattice().h(l);
            band.outside[i] = 0;
            for (std::size_t axis = 0; axis < 3; ++axis) {
                if (v[axis] == 0) band.outside[i] = static_cast<std::uint8_t>(band.outside[i] | 1 << (2 * axis));
                if (v[axis] == n[axis]) band.outside[i] = static_cast<std::uint8_t>(band.outside[i] | 2 << (2 * axis));
            }
        });
    }
    parallelFor(static_cast<std::size_t>(mesh.frontPointCount()), [&](std::size_t s) {
        const LatticeMesh::FrontPoint& p = mesh.frontPoint(static_cast<std::int64_t>(s));
        const auto from = static_cast<std::size_t>(nodeAt(p.point));
        for (int k = 1; k < vertexPattern(p.pattern).components; ++k) {
            const auto i = static_cast<std::size_t>(nodeAt(p.firstExtra + k - 1));
            band.start[i] = band.start[from];
            band.h[i] = band.h[from];
            band.outside[i] = p.outside;
        }
    });
    return nodeOf;
}

// Of a node in several pieces the first of all, in order.
Csr<std::int32_t> parentsOf(std::size_t nodes, const std::vector<BandPieces>& pieces) {
    std::vector<Hanging> hanging;
    for (const BandPieces& p : pieces) hanging.insert(hanging.end(), p.hanging.begin(), p.hanging.end());
    std::sort(hanging.begin(), hanging.end());
    hanging.erase(std::unique(hanging.begin(), hanging.end(), sameNode), hanging.end());
    Csr<std::int32_t> rows;
    rows.start.assign(nodes + 1, 0);
    for (const auto& [node, parents] : hanging) {
        for (std::int32_t p : parents) {
            if (p < 0) continue;
            ++rows.start[static_cast<std::size_t>(node)];
            rows.values.push_back(p);
        }
    }
    exclusiveScan(rows.start);
    return rows;
}

} // namespace

double Band::prismHeight(std::size_t node) const {
    return std::clamp(heightForRoom * room.inCells(h[node]), leastPrism, highestPrism);
}

Band buildBand(const LatticeMesh& mesh, const Front& front, int rings, const WantedRoom& room) {
    const BandMarks marks = markBand(mesh, rings);
    Band band;
    band.room = room;
    band.walls = front.front.size();
    band.start.resize(band.walls), band.reach.resize(band.walls);
    parallelFor(band.walls, [&](std::size_t v) {
        const Vec3& s = front.size[v];
        band.start[v] = front.wall(v);
        band.reach[v] = std::max(s.x, std::max(s.y, s.z));
    });
    band.h.assign(front.h.begin(), front.h.end());
    band.outside.assign(front.outside.begin(), front.outside.end());
    const RawVector<std::int32_t> nodeOf = numberNodes(band, mesh, marks, rings);
    band.frontNode.resize(band.walls);
    parallelFor(band.walls, [&](std::size_t v) { band.frontNode[v] = nodeOf[static_cast<std::size_t>(front.corePoint[v])]; });
    band.inside.resize(band.fronts);
    band.behind.assign(band.fronts, 0);
    band.fansOf = rowsOf(band.fronts, 0, band.walls,
                         [&](std::size_t v, const auto& put) { put(static_cast<std::size_t>(band.frontNode[v]) - band.walls); });
    band.away.resize(band.fronts);
    parallelFor(band.fronts, [&](std::size_t i) {
        const auto v = static_cast<std::size_t>(band.fansOf[i].back());
        band.inside[i] = band.away[i] = front.inside[v];
        if (band.fansOf[i].size() > 1) return;
        const std::array<std::int8_t, 3>& wall = front.direction[v];
        const Vec3& s = front.size[v];
        band.away[i] = front.front[v] - Vec3{wall[0] * s.x, wall[1] * s.y, wall[2] * s.z} * 0.5;
    });

    std::vector<BandPieces> pieces;
    for (int l = 0; l < mesh.levels(); ++l) {
        const RankedMask& cells = mesh.cells(l);
        const std::size_t before = pieces.size();
        pieces.resize(before + (cells.leafCount() + 15) / 16);
        parallelChunks(cells.leafCount(), 16, [&](std::size_t begin, std::size_t end, std::size_t chunk) {
            LatticeMesh::Reader reader(mesh);
            const auto room = std::make_unique<CoreCellRoom>();
            for (std::size_t i = begin; i < end; ++i) {
                auto rank = static_cast<std::size_t>(cells.leafFirst(i));
                if (!anyFlag(marks.cells, rank, rank + static_cast<std::size_t>(bits::count(leafBits(&cells.leaf(i)))))) continue;
                room->enterNode();
                const Index3 o = toIndex(cells.leaf(i).origin());
                bits::forEach(leafBits(&cells.leaf(i)), [&](int x, int y, int z) {
                    if (marks.cells[rank++]) addCoreCell(band, reader, l, {o[0] + x, o[1] + y, o[2] + z}, nodeOf, *room, pieces[before + chunk]);
                });
            }
        });
    }
    appendCells(band.corners, pieces, 2 * front.mesh.n_halfedges() * 5 / 4); // those of the prisms, of vertices put in later, too
    band.corners.inverseSize = inverseSizes(mesh);
    band.parents = parentsOf(band.nodes(), pieces);
    for (BandPieces& p : pieces) giveUp(p.cells, p.corners, p.hanging);
    const std::size_t chunk = 4096, before = pieces.size(); // and the front's nodes with the wall's
    pieces.resize(before + (band.walls + chunk - 1) / chunk);
    parallelChunks(band.walls, chunk, [&](std::size_t begin, std::size_t end, std::size_t c) {
        for (std::size_t v = begin; v < end; ++v) pieces[before + c].edges.push_back(edgeKey(static_cast<std::int32_t>(v), band.frontNode[v]));
    });
    // Core edges away from the front weigh as much less, or more, at front nodes as prisms are to be lower, or higher.
    band.edges.fixed = edgesOf(band.nodes(), pieces, [&](std::int32_t a, std::int32_t b) {
        const auto p = static_cast<std::size_t>(a), q = static_cast<std::size_t>(b), core = band.walls + band.fronts;
        if (p < band.walls || q < band.walls) return BandEdge{b, 1};
        BandEdge e{b, static_cast<float>(band.h[p] / norm(band.start[q] - band.start[p]))};
        if (p < core && q >= core) e.weight *= static_cast<float>(band.prismHeight(p));
        return e;
    });
    giveUp(pieces);
    band.corners.cellsOf = rowsOfCells(band.corners, band.movable);
    renewPrisms(band, front);
    band.blocks = NodeBlocks(band);
    return band;
}

// In the rows of wall nodes there are no edges but these and those to the front.
void renewPrisms(Band& band, const Front& front) {
    constexpr std::size_t chunk = 2048;
    const std::size_t faces = front.ownerCell.size();
    std::vector<BandPieces> pieces((faces + chunk - 1) / chunk);
    std::vector<std::size_t> first(pieces.size());
    parallelChunks(faces, chunk, [&](std::size_t begin, std::size_t end, std::size_t c) {
        pieces[c].edges.reserve(4 * (end - begin));
        for (std::size_t f = begin; f < end; ++f) first[c] += addPrism(band, front, f, {&pieces[c].edges});
    });
    band.corners.list.resize(band.corners.prisms); // so that none is copied when there are more
    band.corners.list.resize(band.corners.prisms + exclusiveScan(first));
    parallelChunks(faces, chunk, [&](std::size_t begin, std::size_t end, std::size_t c) {
        Corner* next = band.corners.list.data() + band.corners.prisms + first[c];
        for (std::size_t f = begin; f < end; ++f) next += addPrism(band, front, f, {nullptr, next});
    });
    giveUp(band.corners.prismsOf.values);
    band.corners.prismsOf = rowsOfPrisms(band.corners, band.walls + band.fronts);
    const Csr<BandEdge> wall = edgesOf(band.walls, pieces, [&](std::int32_t a, std::int32_t b) { return wallEdge(band, a, b); });
    // Each wall node has its front node last: higher in number than all wall nodes.
    Csr<BandEdge>& edges = band.edges.changing;
    edges.values.clear();
    edges.values.resize(wall.values.size() + band.walls);
    edges.start.resize(band.walls + 1);
    edges.start[band.walls] = static_cast<std::int64_t>(edges.values.size());
    parallelFor(band.walls, [&](std::size_t v) {
        edges.start[v] = wall.start[v] + static_cast<std::int64_t>(v);
        BandEdge* const end = std::copy(wall[v].begin(), wall[v].end(), edges.values.data() + edges.start[v]);
        *end = {band.frontNode[v], 1};
    });
}

} // namespace i2b
