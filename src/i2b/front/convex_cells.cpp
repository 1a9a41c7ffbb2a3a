#include "i2b/front/convex_cells.h"

namespace i2b {
namespace {

// By axis: the points of a node that are odd along the two other axes, as the middle of a face across it is on the lattice
// one level finer.
std::array<LeafBits, 3> middlesOfFaces() {
    std::array<LeafBits, 3> middles{};
    for (int at = 0; at < 512; ++at) {
        const int odd = (at >> 6 & 1) | (at >> 3 & 1) << 1 | (at & 1) << 2;
        for (int axis = 0; axis < 3; ++axis) {
            if ((odd | 1 << axis) == 7) {
                middles[static_cast<std::size_t>(axis)][static_cast<std::size_t>(at >> 6)] |= std::uint64_t(1) << (at & 63);
            }
        }
    }
    return middles;
}

// The kept cells of one triple of levels, as cells whose faces across `axis` may have a middle on one lattice of points.
struct Coarser {
    RankedMask::Reader cells;
    std::size_t axis = 0;
    int up = 0;      // a point's coordinate along the axis, halved this often, is the cell's; negative: doubled
    double edge = 0; // m, along the axis

    // Of the two cells whose face has its middle at v: how far it has to move along the axis, m.
    double outwards(const Index3& v) {
        const std::size_t b = (axis + 1) % 3, d = (axis + 2) % 3;
        Index3 c;
        c[b] = v[b] >> 1, c[d] = v[d] >> 1;
        if (up > 0 && (v[axis] & ((1 << up) - 1)) != 0) return 0;
        c[axis] = up >= 0 ? v[axis] >> up : v[axis] << -up;
        const bool above = cells.has(c);
        --c[axis];
        const bool below = cells.has(c);
        return above == below ? 0 : (below ? middleOut : -middleOut) * edge;
    }
};

std::vector<Coarser> coarserThan(const LatticeMesh& mesh, int pointLevel, std::size_t axis) {
    std::vector<Coarser> all;
    for (int l = 0; l < mesh.levels(); ++l) {
        const LevelTriple& of = mesh.levelOf(l);
        if (of[(axis + 1) % 3] + 1 != pointLevel || of[(axis + 2) % 3] + 1 != pointLevel) continue;
        const Vec3 edges = mesh.lattice().corner(of, {1, 1, 1}) - mesh.lattice().corner(of, {0, 0, 0});
        all.push_back({RankedMask::Reader(mesh.cells(l)), axis, pointLevel - of[axis], edges[static_cast<int>(axis)]});
    }
    return all;
}

} // namespace

void raiseMiddles(const LatticeMesh& mesh, RawVector<Vec3>& points) {
    const std::array<LeafBits, 3> middles = middlesOfFaces();
    for (int l = 1; l < mesh.pointLevels(); ++l) {
        const RankedMask& ranked = mesh.points(l);
        parallelChunks(ranked.leafCount(), 16, [&](std::size_t begin, std::size_t end, std::size_t) {
            RankedMask::Reader rank(ranked), front(mesh.frontPoints(l));
            for (std::size_t axis = 0; axis < 3; ++axis) {
                for (Coarser& coarser : coarserThan(mesh, l, axis)) {
                    for (std::size_t i = begin; i < end; ++i) {
                        const MaskLeaf& leaf = ranked.leaf(i);
                        LeafBits found = leafBits(&leaf);
                        for (std::size_t x = 0; x < 8; ++x) found[x] &= middles[axis][x];
                        const Index3 o = toIndex(leaf.origin());
                        bits::forEach(found, [&](int x, int y, int z) {
                            const Index3 v{o[0] + x, o[1] + y, o[2] + z};
                            const double by = coarser.outwards(v);
                            if (by != 0 && !front.has(v)) points[static_cast<std::size_t>(rank.rank(v))][static_cast<int>(axis)] += by;
                        });
                    }
                }
            }
        });
    }
}

} // namespace i2b
