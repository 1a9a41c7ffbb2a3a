#include "i2b/fit/band.h"
#include <algorithm>
#include <atomic>

namespace i2b {
namespace {

struct BandCell {
    int level = 0;
    Index3 at{};
};

struct Marks { // which cells and points belong; several threads may set the same mark
    std::vector<std::uint8_t> cells, points; // 0: not in the band; else 1 + ring
    static void set(std::uint8_t& mark, std::uint8_t value) {
        std::atomic_ref<std::uint8_t> m(mark);
        std::uint8_t old = m.load(std::memory_order_relaxed);
        while ((old == 0 || old > value) && !m.compare_exchange_weak(old, value, std::memory_order_relaxed)) {}
    }
};

constexpr double prismHeight = 0.7; // of h: what the energy and the Laplacian tend to

// f(level, coordinates, rank) for marked bits of ranked masks, leaf-parallel, one Reader a chunk.
template <class Ranked, class F>
void forMarked(const LatticeMesh& mesh, int levels, const Ranked& rankedOf, const std::vector<std::uint8_t>& marks, const F& f) {
    for (int l = 0; l < levels; ++l) {
        const RankedMask& ranked = rankedOf(l);
        parallelChunks(ranked.leafCount(), 16, [&](std::size_t begin, std::size_t end, std::size_t) {
            LatticeMesh::Reader reader(mesh);
            for (std::size_t i = begin; i < end; ++i) {
                auto rank = static_cast<std::size_t>(ranked.leafFirst(i));
                const Index3 o = toIndex(ranked.leaf(i).origin());
                bits::forEach(leafBits(&ranked.leaf(i)), [&](int x, int y, int z) {
                    if (marks[rank]) f(reader, l, Index3{o[0] + x, o[1] + y, o[2] + z}, rank);
                    ++rank;
                });
            }
        });
    }
}

Marks markBand(const LatticeMesh& mesh, int rings) {
    Marks marks;
    marks.cells.assign(static_cast<std::size_t>(mesh.cellCount()), 0);
    marks.points.assign(static_cast<std::size_t>(mesh.pointCount()), 0);
    parallelFor(static_cast<std::size_t>(mesh.frontPointCount()), [&](std::size_t s) {
        const LatticeMesh::FrontPoint& p = mesh.frontPoint(static_cast<std::int64_t>(s));
        marks.points[static_cast<std::size_t>(p.point)] = 1;
        for (int k = 1; k < vertexPattern(p.pattern).components; ++k) marks.points[static_cast<std::size_t>(p.firstExtra + k - 1)] = 1;
    });
    for (int ring = 0; ring <= rings; ++ring) {
        const auto now = static_cast<std::uint8_t>(ring + 1);
        const std::vector<std::uint8_t> before = marks.points;
        forMarked(mesh, mesh.pointLevels(), [&](int l) -> const RankedMask& { return mesh.points(l); }, before,
                  [&](LatticeMesh::Reader& reader, int l, const Index3& v, std::size_t rank) {
                      if (before[rank] != now) return;
                      reader.cellsAround(l, v, [&](int cl, const Index3& c) {
                          Marks::set(marks.cells[static_cast<std::size_t>(reader.cell(cl, c))], now);
                      });
                  });
        const std::vector<std::uint8_t> cells = marks.cells;
        forMarked(mesh, mesh.levels(), [&](int l) -> const RankedMask& { return mesh.cells(l); }, cells,
                  [&](LatticeMesh::Reader& reader, int l, const Index3& c, std::size_t rank) {
                      if (cells[rank] != now) return;
                      reader.faces(l, c, [&](const CellFace& face) {
                          for (std::size_t i = 0; i < face.vertices; ++i) {
                              Marks::set(marks.points[static_cast<std::size_t>(face.points[i])], static_cast<std::uint8_t>(now + 1));
                          }
                      });
                  });
    }
    return marks;
}

using Hanging = std::pair<std::int32_t, std::array<std::int32_t, 4>>; // a node and its parents, -1 filled
bool sameNode(const Hanging& a, const Hanging& b) { return a.first == b.first; }

// An edge between two nodes, either end first.
constexpr std::uint64_t edgeKey(std::int32_t a, std::int32_t b) { return std::uint64_t(std::uint32_t(a)) << 32 | std::uint32_t(b); }

template <class T>
void dropRepeats(std::vector<T>& list) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
    list.shrink_to_fit();
}

// What some cells contribute.
struct Pieces {
    std::vector<Corner> corners;
    std::vector<std::uint64_t> edges; // the lower node first
    std::vector<Hanging> hanging;

    // Four cells share an edge: what is alike goes before the pieces are put together.
    void settle() {
        dropRepeats(edges);
        std::sort(hanging.begin(), hanging.end());
        hanging.erase(std::unique(hanging.begin(), hanging.end(), sameNode), hanging.end());
    }
};

// A cell's vertices with their neighbours along its edges: six slots, 2 * axis (+ 1 for the positive direction).
struct CellVertex {
    std::int32_t node = -1;
    std::array<std::int32_t, 6> next{-1, -1, -1, -1, -1, -1};
};

std::size_t vertexOf(std::vector<CellVertex>& list, std::int32_t node) {
    for (std::size_t i = 0; i < list.size(); ++i) {
        if (list[i].node == node) return i;
    }
    list.push_back({node, {-1, -1, -1, -1, -1, -1}});
    return list.size() - 1;
}

int directionOf(const Vec3& d) {
    const double ax = std::abs(d.x), ay = std::abs(d.y), az = std::abs(d.z);
    const int axis = ax >= ay && ax >= az ? 0 : ay >= az ? 1 : 2;
    return 2 * axis + (d[axis] > 0 ? 1 : 0);
}

void addCoreCell(const Band& band, LatticeMesh::Reader& reader, int level, const Index3& c,
                 const std::vector<std::int32_t>& nodeOf, std::vector<CellVertex>& vertices, Pieces& out) {
    vertices.clear();
    reader.faces(level, c, [&](const CellFace& face) {
        for (std::size_t i = 0; i < face.vertices; ++i) {
            const std::int32_t a = nodeOf[static_cast<std::size_t>(face.points[i])];
            const std::int32_t b = nodeOf[static_cast<std::size_t>(face.points[(i + 1) % face.vertices])];
            const int d = directionOf(band.start[static_cast<std::size_t>(b)] - band.start[static_cast<std::size_t>(a)]);
            vertices[vertexOf(vertices, a)].next[static_cast<std::size_t>(d)] = b;
            vertices[vertexOf(vertices, b)].next[static_cast<std::size_t>(d ^ 1)] = a;
        }
    });
    for (const CellVertex& v : vertices) {
        const Vec3& x = band.start[static_cast<std::size_t>(v.node)];
        const auto lengthTo = [&](std::int32_t n) { return norm(band.start[static_cast<std::size_t>(n)] - x); };
        std::array<std::int32_t, 4> parents{-1, -1, -1, -1};
        std::size_t count = 0;
        Corner corner{{v.node, -1, -1, -1}, {}, 1};
        int sign = 1;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const std::int32_t down = v.next[2 * axis], up = v.next[2 * axis + 1];
            if (down >= 0 && up >= 0) {
                if (count < 3) parents[count++] = down, parents[count++] = up;
            } else if (const std::int32_t n = down >= 0 ? down : up; n >= 0) {
                corner.node[axis + 1] = n;
                corner.inverseLength[axis] = static_cast<float>(1 / lengthTo(n));
                sign *= up >= 0 ? 1 : -1;
            }
            for (std::int32_t n : {down, up}) {
                if (n > v.node) out.edges.push_back(edgeKey(v.node, n)); // n has it too
            }
        }
        if (count > 0) {
            out.hanging.push_back({v.node, parents});
        } else if (corner.node[1] >= 0 && corner.node[2] >= 0 && corner.node[3] >= 0) {
            if (sign < 0) std::swap(corner.node[1], corner.node[2]), std::swap(corner.inverseLength[0], corner.inverseLength[1]);
            out.corners.push_back(corner);
        }
    }
}

// Edge of a cell along the normal over its smaller edge across.
double stretch(const Vec3& size, const Vec3& normal) {
    const int axis = directionOf(normal) / 2;
    return size[axis] / std::min(size[(axis + 1) % 3], size[(axis + 2) % 3]);
}

// An edge of the wall with its length on the front, where it is the lattice's.
BandEdge wallEdge(const Band& band, std::int32_t a, std::int32_t b) {
    const auto frontOf = [&](std::int32_t w) { return static_cast<std::size_t>(band.frontNode[static_cast<std::size_t>(w)]); };
    return {a, b, static_cast<float>(band.h[static_cast<std::size_t>(a)] / norm(band.start[frontOf(b)] - band.start[frontOf(a)]))};
}

void addPrism(const Band& band, const Front& front, std::size_t f, Pieces& out) {
    std::array<std::int32_t, 8> wall{};
    int n = 0;
    for (auto v : front.mesh.fv_range(FrontMesh::FaceHandle(static_cast<int>(f)))) wall[static_cast<std::size_t>(n++)] = v.idx();
    for (int i = 0; i < n; ++i) {
        const std::int32_t b = wall[static_cast<std::size_t>(i)], next = wall[static_cast<std::size_t>((i + 1) % n)], previous = wall[static_cast<std::size_t>((i + n - 1) % n)];
        const auto frontOf = [&](std::int32_t w) { return band.frontNode[static_cast<std::size_t>(w)]; };
        const auto at = [&](std::int32_t node) { return band.start[static_cast<std::size_t>(node)]; };
        const Vec3 x = at(frontOf(b)), e1 = at(frontOf(next)) - x, e2 = at(frontOf(previous)) - x;
        const double l1 = norm(e1), l2 = norm(e2);
        out.edges.push_back(edgeKey(std::min(b, next), std::max(b, next)));
        if (norm2(cross(e1, e2)) < 0.25 * norm2(e1) * norm2(e2)) continue; // hangs on this polygon's edge
        const double height = prismHeight * std::min(l1, l2) * stretch(front.size[static_cast<std::size_t>(b)], cross(e1, e2));
        const auto il1 = static_cast<float>(1 / l1), il2 = static_cast<float>(1 / l2), ih = static_cast<float>(1 / height);
        out.corners.push_back({{frontOf(b), frontOf(next), frontOf(previous), b}, {il1, il2, ih}, 4});
        out.corners.push_back({{b, previous, next, frontOf(b)}, {il2, il1, ih}, 4});
    }
}

// Rows of item numbers, ascending in each. row(i, put) calls put(r) for every row of an item.
template <class Row>
Csr<std::int32_t> rowsOf(std::size_t rows, std::size_t first, std::size_t last, const Row& row) {
    Csr<std::int32_t> csr;
    csr.start.assign(rows + 1, 0);
    const auto raise = [](std::int64_t& n) { return std::atomic_ref<std::int64_t>(n).fetch_add(1, std::memory_order_relaxed); };
    parallelFor(last - first, [&](std::size_t i) { row(first + i, [&](std::size_t r) { raise(csr.start[r]); }); });
    csr.values.resize(static_cast<std::size_t>(exclusiveScan(csr.start)));
    std::vector<std::int64_t> next(csr.start.begin(), csr.start.end() - 1);
    parallelFor(last - first, [&](std::size_t i) {
        row(first + i, [&](std::size_t r) { csr.values[static_cast<std::size_t>(raise(next[r]))] = static_cast<std::int32_t>(first + i); });
    });
    parallelFor(rows, [&](std::size_t r) { // nearly in order already
        std::int32_t* const v = csr.values.data() + csr.start[r];
        for (std::int64_t i = 1; i < csr.start[r + 1] - csr.start[r]; ++i) {
            const std::int32_t n = v[i];
            std::int64_t at = i;
            for (; at > 0 && v[at - 1] > n; --at) v[at] = v[at - 1];
            v[at] = n;
        }
    });
    return csr;
}

// Rows of corners [first, last), numbers ascending.
Csr<std::int32_t> rowsOfCorners(const Band& band, std::size_t rows, std::size_t first, std::size_t last) {
    return rowsOf(rows, first, last, [&](std::size_t c, const auto& put) {
        for (std::int32_t n : band.corners[c].node) {
            if (static_cast<std::size_t>(n) < rows) put(static_cast<std::size_t>(n));
        }
    });
}

// The same edges from both ends, by node and by other end; make(a, b) gives the edge.
template <class Make>
Csr<BandEdge> edgesOf(std::size_t rows, const std::vector<Pieces>& pieces, const Make& make) {
    std::vector<std::int64_t> next(rows + 1, 0);
    const auto raise = [](std::int64_t& n) { return std::atomic_ref<std::int64_t>(n).fetch_add(1, std::memory_order_relaxed); };
    const auto forEdges = [&](const auto& f) {
        parallelFor(pieces.size(), [&](std::size_t p) {
            for (std::uint64_t e : pieces[p].edges) f(static_cast<std::uint32_t>(e >> 32), static_cast<std::uint32_t>(e)), f(static_cast<std::uint32_t>(e), static_cast<std::uint32_t>(e >> 32));
        }, 1);
    };
    forEdges([&](std::uint32_t a, std::uint32_t) { raise(next[a]); });
    std::vector<std::int32_t> other(static_cast<std::size_t>(exclusiveScan(next)));
    const std::vector<std::int64_t> first = next;
    forEdges([&](std::uint32_t a, std::uint32_t b) { other[static_cast<std::size_t>(raise(next[a]))] = static_cast<std::int32_t>(b); });
    Csr<BandEdge> edges; // pieces share edges: each once
    edges.start.assign(rows + 1, 0);
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

// In the order of the pieces.
void appendCorners(Band& band, const std::vector<Pieces>& pieces) {
    std::vector<std::size_t> first;
    for (const Pieces& p : pieces) first.push_back(p.corners.size());
    const std::size_t before = band.corners.size();
    band.corners.resize(before + exclusiveScan(first));
    parallelFor(pieces.size(), [&](std::size_t p) {
        std::copy(pieces[p].corners.begin(), pieces[p].corners.end(), band.corners.begin() + static_cast<std::ptrdiff_t>(before + first[p]));
    }, 1);
}

// Corners and wall edges of the prisms; in the rows of wall nodes there are no others.
void addPrisms(Band& band, const Front& front) {
    const std::size_t faces = front.ownerCell.size();
    std::vector<Pieces> pieces((faces + 2047) / 2048);
    parallelChunks(faces, 2048, [&](std::size_t begin, std::size_t end, std::size_t chunk) {
        for (std::size_t f = begin; f < end; ++f) addPrism(band, front, f, pieces[chunk]);
        pieces[chunk].settle();
    });
    appendCorners(band, pieces);
    // In a row the core's corners come first: those of the prisms that were there before are left out.
    const Csr<std::int32_t> core = std::move(band.cornersOf);
    const std::size_t touched = band.walls + band.fronts;
    const Csr<std::int32_t> prisms = rowsOfCorners(band, touched, band.coreCorners, band.corners.size());
    const auto isCore = [&](std::int32_t c) { return static_cast<std::size_t>(c) < band.coreCorners; };
    const auto coreOf = [&](std::size_t n) { return std::span(core[n].begin(), n < touched ? std::partition_point(core[n].begin(), core[n].end(), isCore) : core[n].end()); };
    band.cornersOf.start.resize(band.movable + 1);
    parallelFor(band.movable, [&](std::size_t n) {
        band.cornersOf.start[n] = static_cast<std::int64_t>(coreOf(n).size() + (n < touched ? prisms[n].size() : 0));
    });
    band.cornersOf.start[band.movable] = 0;
    band.cornersOf.values.resize(static_cast<std::size_t>(exclusiveScan(band.cornersOf.start)));
    parallelFor(band.movable, [&](std::size_t n) {
        const auto own = coreOf(n);
        std::int32_t* const to = std::copy(own.begin(), own.end(), band.cornersOf.values.data() + band.cornersOf.start[n]);
        if (n < touched) std::copy(prisms[n].begin(), prisms[n].end(), to);
    });
    const Csr<BandEdge> wall = edgesOf(band.walls, pieces, [&](std::int32_t a, std::int32_t b) { return wallEdge(band, a, b); });
    // Each wall node has its front node last: higher in number than all wall nodes.
    const auto old = static_cast<std::size_t>(band.edges.start[band.walls]), all = wall.values.size() + band.walls;
    std::vector<BandEdge> values(all + band.edges.values.size() - old);
    std::vector<std::int64_t> start(band.nodes() + 1);
    parallelFor(band.walls, [&](std::size_t v) {
        start[v] = wall.start[v] + static_cast<std::int64_t>(v);
        BandEdge* const end = std::copy(wall[v].begin(), wall[v].end(), values.data() + start[v]);
        *end = {static_cast<std::int32_t>(v), band.frontNode[v], 1};
    });
    parallelFor(band.nodes() + 1 - band.walls, [&](std::size_t i) {
        start[band.walls + i] = band.edges.start[band.walls + i] + static_cast<std::int64_t>(all) - static_cast<std::int64_t>(old);
    });
    parallelFor(values.size() - all, [&](std::size_t i) { values[all + i] = band.edges.values[old + i]; }, 4096);
    band.edges = {std::move(start), std::move(values)};
}

// Numbers the band's core points: front, then movable, then fixed; within each in order of their numbers.
std::vector<std::int32_t> numberNodes(Band& band, const LatticeMesh& mesh, const Marks& marks, int rings) {
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
    std::vector<std::int32_t> nodeOf(points, -1);
    parallelChunks(points, chunk, [&](std::size_t begin, std::size_t end, std::size_t c) {
        for (std::size_t p = begin; p < end; ++p) {
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
Csr<std::int32_t> parentsOf(std::size_t nodes, const std::vector<Pieces>& pieces) {
    std::vector<Hanging> hanging;
    for (const Pieces& p : pieces) hanging.insert(hanging.end(), p.hanging.begin(), p.hanging.end());
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

Band buildBand(const LatticeMesh& mesh, const Front& front, int rings) {
    const Marks marks = markBand(mesh, rings);
    Band band;
    band.walls = front.front.size();
    band.start.resize(band.walls), band.reach.resize(band.walls);
    parallelFor(band.walls, [&](std::size_t v) {
        const auto& p = front.mesh.point(FrontMesh::VertexHandle(static_cast<int>(v)));
        const Vec3& s = front.size[v];
        band.start[v] = {p[0], p[1], p[2]};
        band.reach[v] = std::max(s.x, std::max(s.y, s.z));
    });
    band.h = front.h;
    band.outside = front.outside;
    const std::vector<std::int32_t> nodeOf = numberNodes(band, mesh, marks, rings);
    band.frontNode.resize(band.walls);
    parallelFor(band.walls, [&](std::size_t v) { band.frontNode[v] = nodeOf[static_cast<std::size_t>(front.corePoint[v])]; });
    band.inside.resize(band.fronts);
    band.behind.assign(band.fronts, 0);
    band.fansOf = rowsOf(band.fronts, 0, band.walls,
                         [&](std::size_t v, const auto& put) { put(static_cast<std::size_t>(band.frontNode[v]) - band.walls); });
    parallelFor(band.fronts, [&](std::size_t i) { band.inside[i] = front.inside[static_cast<std::size_t>(band.fansOf[i].back())]; });

    std::vector<Pieces> pieces;
    for (int l = 0; l < mesh.levels(); ++l) {
        const RankedMask& cells = mesh.cells(l);
        const std::size_t before = pieces.size();
        pieces.resize(before + (cells.leafCount() + 15) / 16);
        parallelChunks(cells.leafCount(), 16, [&](std::size_t begin, std::size_t end, std::size_t chunk) {
            LatticeMesh::Reader reader(mesh);
            std::vector<CellVertex> vertices;
            for (std::size_t i = begin; i < end; ++i) {
                auto rank = static_cast<std::size_t>(cells.leafFirst(i));
                const Index3 o = toIndex(cells.leaf(i).origin());
                bits::forEach(leafBits(&cells.leaf(i)), [&](int x, int y, int z) {
                    if (marks.cells[rank++]) addCoreCell(band, reader, l, {o[0] + x, o[1] + y, o[2] + z}, nodeOf, vertices, pieces[before + chunk]);
                });
            }
            pieces[before + chunk].settle();
        });
    }
    appendCorners(band, pieces);
    band.coreCorners = band.corners.size();
    band.parents = parentsOf(band.nodes(), pieces);
    for (Pieces& p : pieces) p.corners = {}, p.hanging = {};
    const std::size_t chunk = 4096, before = pieces.size(); // and the front's nodes with the wall's
    pieces.resize(before + (band.walls + chunk - 1) / chunk);
    parallelChunks(band.walls, chunk, [&](std::size_t begin, std::size_t end, std::size_t c) {
        for (std::size_t v = begin; v < end; ++v) pieces[before + c].edges.push_back(edgeKey(static_cast<std::int32_t>(v), band.frontNode[v]));
    });
    // Core edges away from the front weigh less at front nodes, so that prisms come out 0.7 h high.
    band.edges = edgesOf(band.nodes(), pieces, [&](std::int32_t a, std::int32_t b) {
        const auto p = static_cast<std::size_t>(a), q = static_cast<std::size_t>(b), core = band.walls + band.fronts;
        if (p < band.walls || q < band.walls) return BandEdge{a, b, 1};
        BandEdge e{a, b, static_cast<float>(band.h[p] / norm(band.start[q] - band.start[p]))};
        if (p < core && q >= core) e.weight *= static_cast<float>(prismHeight);
        return e;
    });
    pieces = {};
    band.cornersOf = rowsOfCorners(band, band.movable, 0, band.coreCorners);
    addPrisms(band, front);
    return band;
}

void renewPrisms(Band& band, const Front& front) {
    band.corners.resize(band.coreCorners);
    addPrisms(band, front);
}

} // namespace i2b
