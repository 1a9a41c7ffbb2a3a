#include "i2b/grid/cut.h"
#include "i2b/geometry/triangle_box.h"
#include "i2b/grid/mask_ops.h"
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_reduce.h>

namespace i2b {
namespace {

using MaskWriter = openvdb::tree::ValueAccessor<Mask>;

// A triangle in the coordinates of one level (cell edge 1), and the cells that its box spans there.
struct LevelTriangle {
    LevelTriangle(const Surface& surface, std::size_t t, const Lattice& lattice, const LevelTriple& level) {
        const Vec3 s = lattice.cellSize(level);
        for (std::size_t i = 0; i < 3; ++i) {
            const Vec3 d = surface.points[surface.triangles[t][i]] - lattice.origin;
            corner[i] = {d.x / s.x, d.y / s.y, d.z / s.z};
        }
        const Index3 n = lattice.cells(level);
        for (std::size_t i = 0; i < 3; ++i) {
            const int axis = static_cast<int>(i);
            const double a = std::min({corner[0][axis], corner[1][axis], corner[2][axis]});
            const double b = std::max({corner[0][axis], corner[1][axis], corner[2][axis]});
            const double pad = 1e-12 * (std::abs(a) + std::abs(b) + 1); // rounding of the division above
            // Closed cells: a plane between two cells belongs to both.
            lo[i] = static_cast<std::int32_t>(std::clamp(std::ceil(a - pad) - 1, -1.0, double(n[i])));
            hi[i] = static_cast<std::int32_t>(std::clamp(std::floor(b + pad), -1.0, double(n[i])));
            empty = empty || hi[i] < 0 || lo[i] >= n[i];
            lo[i] = std::max(lo[i], 0);
            hi[i] = std::min(hi[i], n[i] - 1);
        }
    }
    std::array<Vec3, 3> corner;
    Index3 lo{}, hi{};
    bool empty = false;
};

// Halves the range of cells until it is small, dropping what the triangle does not meet; a large triangle so costs
// its area, not its volume.
template <class Mark>
void visitCells(const TriangleBoxTest& test, const Index3& lo, const Index3& hi, const Mark& mark) {
    const Index3 n{hi[0] - lo[0] + 1, hi[1] - lo[1] + 1, hi[2] - lo[2] + 1};
    const bool single = n[0] == 1 && n[1] == 1 && n[2] == 1;
    if (!test.meets({double(lo[0]), double(lo[1]), double(lo[2])}, {hi[0] + 1.0, hi[1] + 1.0, hi[2] + 1.0})) return;
    if (single) return mark(lo);
    const std::size_t axis = n[0] >= n[1] && n[0] >= n[2] ? 0 : n[1] >= n[2] ? 1 : 2;
    Index3 low = hi, high = lo;
    low[axis] = lo[axis] + n[axis] / 2 - 1;
    high[axis] = low[axis] + 1;
    visitCells(test, lo, low, mark);
    visitCells(test, high, hi, mark);
}

template <class Mark>
void visitTriangle(const Surface& surface, std::size_t t, const Lattice& lattice, const LevelTriple& level, const Mark& mark) {
    const LevelTriangle triangle(surface, t, lattice, level);
    if (triangle.empty) return;
    const TriangleBoxTest test(triangle.corner[0], triangle.corner[1], triangle.corner[2]);
    visitCells(test, triangle.lo, triangle.hi, mark);
}

// Trees by level that threads fill on their own and that are then joined; a union has no order.
class LevelMasks {
  public:
    explicit LevelMasks(std::size_t levels) {
        for (std::size_t l = 0; l < levels; ++l) {
            masks.push_back(std::make_shared<Mask>(false));
            writers.emplace_back(std::make_unique<MaskWriter>(*masks[l]));
        }
    }
    void set(std::size_t level, const Index3& c) { writers[level]->setValueOn(toCoord(c)); }
    void join(LevelMasks& other) {
        for (std::size_t l = 0; l < masks.size(); ++l) masks[l]->topologyUnion(*other.masks[l]);
    }
    std::vector<Mask::Ptr> masks;
    std::vector<std::unique_ptr<MaskWriter>> writers;
};

template <class Visit>
std::vector<Mask::Ptr> collect(std::size_t triangles, std::size_t levels, const Visit& visit) {
    tbb::enumerable_thread_specific<LevelMasks> local([&] { return LevelMasks(levels); });
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, triangles, 512), [&](const auto& range) {
        LevelMasks& mine = local.local();
        for (std::size_t t = range.begin(); t != range.end(); ++t) visit(t, mine);
    });
    LevelMasks all(levels);
    all.writers.clear();
    for (LevelMasks& part : local) {
        if (all.masks[0]->empty() && &part == &*local.begin()) {
            all.masks = part.masks;
        } else {
            all.join(part);
        }
    }
    return all.masks;
}

} // namespace

std::vector<CellLevel> cutAtTargetLevels(const Surface& surface, const SizeField& field) {
    const std::vector<LevelTriple> targets = field.targets();
    const std::vector<Mask::Ptr> masks = collect(surface.triangles.size(), targets.size(), [&](std::size_t t, LevelMasks& out) {
        const LevelTriple level = field.target(surface, t);
        const auto slot = static_cast<std::size_t>(std::lower_bound(targets.begin(), targets.end(), level) - targets.begin());
        visitTriangle(surface, t, field.lattice, level, [&](const Index3& c) { out.set(slot, c); });
    });
    std::vector<CellLevel> cut;
    for (std::size_t i = 0; i < targets.size(); ++i) cut.push_back({targets[i], masks[i]});
    return cut;
}

CutCells cutLeafCells(const Surface& surface, const SizeField& field, const CellGrid& grid,
                      const std::vector<CellLevel>& atTarget) {
    const std::size_t levels = grid.levels.size();
    CutCells cut;
    for (const CellLevel& level : grid.levels) {
        const auto same = std::find_if(atTarget.begin(), atTarget.end(), [&](const CellLevel& c) { return c.level == level.level; });
        cut.levels.push_back(same == atTarget.end() ? std::make_shared<Mask>(false) : intersectionOf(*same->cells, *level.cells));
    }
    // Where the place was refined beyond a triangle's level, look at it again on the finer levels.
    const std::vector<Mask::Ptr> finer = collect(surface.triangles.size(), levels, [&](std::size_t t, LevelMasks& masks) {
        const LevelTriple start = field.target(surface, t);
        const auto own = std::find_if(grid.levels.begin(), grid.levels.end(), [&](const CellLevel& c) { return c.level == start; });
        bool refined = own == grid.levels.end();
        if (!refined) {
            MaskReader leaf(*own->cells);
            visitTriangle(surface, t, field.lattice, start, [&](const Index3& c) { refined = refined || !leaf.isValueOn(toCoord(c)); });
        }
        for (std::size_t l = 0; refined && l < levels; ++l) {
            const LevelTriple& level = grid.levels[l].level;
            if (level == start || finerOf(level, start) != level) continue;
            MaskReader here(*grid.levels[l].cells);
            visitTriangle(surface, t, field.lattice, level, [&](const Index3& c) {
                if (here.isValueOn(toCoord(c))) masks.set(l, c);
            });
        }
    });
    for (std::size_t l = 0; l < levels; ++l) cut.levels[l]->topologyUnion(*finer[l]);
    return cut;
}

} // namespace i2b
