#include "i2b/fit/band_marks.h"
#include "i2b/core/parallel.h"
#include <atomic>
#include <cstring>

namespace i2b {
namespace {

// Several threads may set the same mark: the lowest counts.
void set(std::uint8_t& mark, std::uint8_t value) {
    std::atomic_ref<std::uint8_t> m(mark);
    std::uint8_t old = m.load(std::memory_order_relaxed);
    while ((old == 0 || old > value) && !m.compare_exchange_weak(old, value, std::memory_order_relaxed)) {}
}

// f(reader, level, coordinates) for the bits of ranked masks that bear one mark, leaf-parallel, one Reader a chunk. Most leaves
// have none.
template <class Ranked, class F>
void forMarked(const LatticeMesh& mesh, int levels, const Ranked& rankedOf, const std::vector<std::uint8_t>& marks, std::uint8_t mark, const F& f) {
    for (int l = 0; l < levels; ++l) {
        const RankedMask& ranked = rankedOf(l);
        parallelChunks(ranked.leafCount(), 16, [&](std::size_t begin, std::size_t end, std::size_t) {
            LatticeMesh::Reader reader(mesh);
            for (std::size_t i = begin; i < end; ++i) {
                auto rank = static_cast<std::size_t>(ranked.leafFirst(i));
                if (!std::memchr(marks.data() + rank, mark, static_cast<std::size_t>(bits::count(leafBits(&ranked.leaf(i)))))) continue;
                const Index3 o = toIndex(ranked.leaf(i).origin());
                bits::forEach(leafBits(&ranked.leaf(i)), [&](int x, int y, int z) {
                    if (marks[rank++] == mark) f(reader, l, Index3{o[0] + x, o[1] + y, o[2] + z});
                });
            }
        });
    }
}

} // namespace

BandMarks markBand(const LatticeMesh& mesh, int rings) {
    BandMarks marks;
    marks.cells.assign(static_cast<std::size_t>(mesh.cellCount()), 0);
    marks.points.assign(static_cast<std::size_t>(mesh.pointCount()), 0);
    parallelFor(static_cast<std::size_t>(mesh.frontPointCount()), [&](std::size_t s) {
        const LatticeMesh::FrontPoint& p = mesh.frontPoint(static_cast<std::int64_t>(s));
        marks.points[static_cast<std::size_t>(p.point)] = 1;
        for (int k = 1; k < vertexPattern(p.pattern).components; ++k) marks.points[static_cast<std::size_t>(p.firstExtra + k - 1)] = 1;
    });
    for (int ring = 0; ring <= rings; ++ring) {
        const auto now = static_cast<std::uint8_t>(ring + 1);
        forMarked(mesh, mesh.pointLevels(), [&](int l) -> const RankedMask& { return mesh.points(l); }, marks.points, now,
                  [&](LatticeMesh::Reader& reader, int l, const Index3& v) {
                      reader.cellsAround(l, v, [&](int cl, const Index3& c) {
                          set(marks.cells[static_cast<std::size_t>(reader.cell(cl, c))], now);
                      });
                  });
        forMarked(mesh, mesh.levels(), [&](int l) -> const RankedMask& { return mesh.cells(l); }, marks.cells, now,
                  [&](LatticeMesh::Reader& reader, int l, const Index3& c) {
                      if (std::array<std::int32_t, 8> corners; reader.corners(l, c, corners)) {
                          for (const std::int32_t p : corners) set(marks.points[static_cast<std::size_t>(p)], static_cast<std::uint8_t>(now + 1));
                          return;
                      }
                      reader.faces(l, c, [&](const CellFace& face) {
                          for (std::size_t i = 0; i < face.vertices; ++i) {
                              set(marks.points[static_cast<std::size_t>(face.points[i])], static_cast<std::uint8_t>(now + 1));
                          }
                      });
                  });
    }
    return marks;
}

} // namespace i2b
