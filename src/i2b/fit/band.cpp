#include "i2b/fit/band.h"
#include <algorithm>
#include <atomic>
#include <tbb/parallel_sort.h>

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
    for (std::int64_t s = 0; s < mesh.frontPointCount(); ++s) {
        const LatticeMesh::FrontPoint& p = mesh.frontPoint(s);
        marks.points[static_cast<std::size_t>(p.point)] = 1;
        for (int k = 1; k < vertexPattern(p.pattern).components; ++k) marks.points[static_cast<std::size_t>(p.firstExtra + k - 1)] = 1;
    }
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

// What some cells contribute.
struct Pieces {
    std::vector<Corner> corners;
    std::vector<BandEdge> edges; // both directions
    std::vector<Hanging> hanging;

    // Four cells share an edge: what is alike goes before the pieces are put together.
    void settle() {
        std::sort(edges.begin(), edges.end());
        edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
        edges.shrink_to_fit();
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
                if (n >= 0) out.edges.push_back({v.node, n, static_cast<float>(band.h[static_cast<std::size_t>(v.node)] / lengthTo(n))});
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

void addPrism(const Band& band, const Front& front, std::size_t f, Pieces& out) {
    std::array<std::int32_t, 8> wall{};
    int n = 0;
    for (auto v : front.mesh.fv_range(FrontMesh::FaceHandle(static_cast<int>(f)))) wall[static_cast<std::size_t>(n++)] = v.idx();
    for (int i = 0; i < n; ++i) {
        const std::int32_t b = wall[static_cast<std::size_t>(i)], next = wall[static_cast<std::size_t>((i + 1) % n)], previous = wall[static_cast<std::size_t>((i + n - 1) % n)];
        const auto frontOf = [&](std::int32_t w) { return band.frontNode[static_cast<std::size_t>(w)]; };
        const auto at = [&](std::int32_t node) { return band.start[static_cast<std::size_t>(node)]; };
        const Vec3 x = at(frontOf(b)), e1 = at(frontOf(next)) - x, e2 = at(frontOf(previous)) - x;
        const double l1 = norm(e1), l2 = norm(e2), h = band.h[static_cast<std::size_t>(b)];
        out.edges.push_back({b, next, static_cast<float>(h / l1)});
        out.edges.push_back({b, previous, static_cast<float>(h / l2)});
        if (norm2(cross(e1, e2)) < 0.25 * norm2(e1) * norm2(e2)) continue; // hangs on this polygon's edge
        const double height = prismHeight * std::min(l1, l2) * stretch(front.size[static_cast<std::size_t>(b)], cross(e1, e2));
        const auto il1 = static_cast<float>(1 / l1), il2 = static_cast<float>(1 / l2), ih = static_cast<float>(1 / height);
        out.corners.push_back({{frontOf(b), frontOf(next), frontOf(previous), b}, {il1, il2, ih}, 4});
        out.corners.push_back({{b, previous, next, frontOf(b)}, {il2, il1, ih}, 4});
    }
}

template <class T, class Row, class Value>
Csr<T> rowsOf(std::size_t rows, std::size_t items, const Row& row, const Value& value) {
    Csr<T> csr;
    csr.start.assign(rows + 1, 0);
    for (std::size_t i = 0; i < items; ++i) row(i, [&](std::size_t r) { ++csr.start[r + 1]; });
    for (std::size_t r = 0; r < rows; ++r) csr.start[r + 1] += csr.start[r];
    csr.values.resize(static_cast<std::size_t>(csr.start[rows]));
    std::vector<std::int64_t> next(csr.start.begin(), csr.start.end() - 1);
    for (std::size_t i = 0; i < items; ++i) row(i, [&](std::size_t r) { csr.values[static_cast<std::size_t>(next[r]++)] = value(i); });
    return csr;
}

// Numbers the band's core points: front, then movable, then fixed; within each in order of their numbers.
std::vector<std::int32_t> numberNodes(Band& band, const LatticeMesh& mesh, const Marks& marks, int rings) {
    std::vector<std::int32_t> nodeOf(marks.points.size(), -1);
    const std::vector<Vec3> positions = mesh.latticePoints();
    std::vector<double> h(marks.points.size());
    std::vector<std::uint8_t> outside(marks.points.size(), 0);
    for (int l = 0; l < mesh.pointLevels(); ++l) {
        const Index3 n = mesh.lattice().cells(l);
        mesh.points(l).forEach([&](std::int64_t rank, const Index3& v) {
            const auto r = static_cast<std::size_t>(rank);
            h[r] = mesh.lattice().h(l);
            for (std::size_t axis = 0; axis < 3; ++axis) {
                if (v[axis] == 0) outside[r] = static_cast<std::uint8_t>(outside[r] | 1 << (2 * axis));
                if (v[axis] == n[axis]) outside[r] = static_cast<std::uint8_t>(outside[r] | 2 << (2 * axis));
            }
        });
    }
    for (std::int64_t s = 0; s < mesh.frontPointCount(); ++s) {
        const LatticeMesh::FrontPoint& p = mesh.frontPoint(s);
        for (int k = 1; k < vertexPattern(p.pattern).components; ++k) {
            h[static_cast<std::size_t>(p.firstExtra + k - 1)] = h[static_cast<std::size_t>(p.point)];
            outside[static_cast<std::size_t>(p.firstExtra + k - 1)] = p.outside;
        }
    }
    const auto group = [&](std::uint8_t mark) { return mark == 0 ? -1 : mark == 1 ? 0 : mark <= rings + 1 ? 1 : 2; };
    for (int g = 0; g < 3; ++g) {
        for (std::size_t p = 0; p < nodeOf.size(); ++p) {
            if (group(marks.points[p]) != g) continue;
            nodeOf[p] = static_cast<std::int32_t>(band.nodes());
            band.start.push_back(positions[p]);
            band.h.push_back(h[p]);
            band.outside.push_back(outside[p]);
            band.corePoint.push_back(static_cast<std::int32_t>(p));
        }
        if (g == 0) band.fronts = band.nodes() - band.walls;
        if (g == 1) band.movable = band.nodes();
    }
    return nodeOf;
}

} // namespace

Band buildBand(const LatticeMesh& mesh, const Front& front, int rings) {
    const Marks marks = markBand(mesh, rings);
    Band band;
    band.walls = front.front.size();
    for (std::size_t v = 0; v < band.walls; ++v) {
        const auto& p = front.mesh.point(FrontMesh::VertexHandle(static_cast<int>(v)));
        band.start.push_back({p[0], p[1], p[2]});
    }
    band.h = front.h;
    for (const Vec3& s : front.size) band.reach.push_back(std::max(s.x, std::max(s.y, s.z)));
    band.outside = front.outside;
    const std::vector<std::int32_t> nodeOf = numberNodes(band, mesh, marks, rings);
    band.frontNode.resize(band.walls);
    for (std::size_t v = 0; v < band.walls; ++v) band.frontNode[v] = nodeOf[static_cast<std::size_t>(front.corePoint[v])];
    band.inside.resize(band.fronts);
    band.behind.assign(band.fronts, 0);
    for (std::size_t v = 0; v < band.walls; ++v) band.inside[static_cast<std::size_t>(band.frontNode[v]) - band.walls] = front.inside[v];
    band.fansOf = rowsOf<std::int32_t>(
        band.fronts, band.walls, [&](std::size_t v, const auto& put) { put(static_cast<std::size_t>(band.frontNode[v]) - band.walls); },
        [](std::size_t v) { return static_cast<std::int32_t>(v); });

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
    const std::size_t before = pieces.size(), faces = front.ownerCell.size();
    pieces.resize(before + (faces + 2047) / 2048);
    parallelChunks(faces, 2048, [&](std::size_t begin, std::size_t end, std::size_t chunk) {
        for (std::size_t f = begin; f < end; ++f) addPrism(band, front, f, pieces[before + chunk]);
        pieces[before + chunk].settle();
    });

    std::vector<BandEdge> edges;
    std::vector<Hanging> hanging;
    std::size_t cornerCount = 0, edgeCount = 2 * band.walls;
    for (const Pieces& p : pieces) cornerCount += p.corners.size(), edgeCount += p.edges.size();
    band.corners.reserve(cornerCount);
    edges.reserve(edgeCount);
    for (Pieces& p : pieces) {
        band.corners.insert(band.corners.end(), p.corners.begin(), p.corners.end());
        edges.insert(edges.end(), p.edges.begin(), p.edges.end());
        hanging.insert(hanging.end(), p.hanging.begin(), p.hanging.end());
        p = Pieces{};
    }
    band.cornersOf = rowsOf<std::int32_t>(
        band.movable, band.corners.size(),
        [&](std::size_t c, const auto& put) {
            for (std::int32_t n : band.corners[c].node) {
                if (static_cast<std::size_t>(n) < band.movable) put(static_cast<std::size_t>(n));
            }
        },
        [](std::size_t c) { return static_cast<std::int32_t>(c); });
    for (std::size_t v = 0; v < band.walls; ++v) {
        edges.push_back({static_cast<std::int32_t>(v), band.frontNode[v], 1});
        edges.push_back({band.frontNode[v], static_cast<std::int32_t>(v), 1});
    }
    // Core edges away from the front weigh less at front nodes, so that prisms come out 0.7 h high.
    parallelFor(edges.size(), [&](std::size_t i) {
        BandEdge& e = edges[i];
        const auto a = static_cast<std::size_t>(e.a), b = static_cast<std::size_t>(e.b);
        if (a >= band.walls && a < band.walls + band.fronts && b >= band.walls + band.fronts) e.weight *= static_cast<float>(prismHeight);
    });
    tbb::parallel_sort(edges.begin(), edges.end());
    edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
    band.edges = rowsOf<BandEdge>(
        band.nodes(), edges.size(), [&](std::size_t i, const auto& put) { put(static_cast<std::size_t>(edges[i].a)); },
        [&](std::size_t i) { return edges[i]; });
    std::sort(hanging.begin(), hanging.end());
    hanging.erase(std::unique(hanging.begin(), hanging.end(), sameNode), hanging.end());
    band.parents.start.assign(band.nodes() + 1, 0);
    for (const auto& [node, parents] : hanging) {
        for (std::int32_t p : parents) band.parents.start[static_cast<std::size_t>(node) + 1] += p >= 0;
    }
    for (std::size_t n = 0; n < band.nodes(); ++n) band.parents.start[n + 1] += band.parents.start[n];
    for (const auto& [node, parents] : hanging) {
        for (std::int32_t p : parents) {
            if (p >= 0) band.parents.values.push_back(p);
        }
    }
    return band;
}

} // namespace i2b
