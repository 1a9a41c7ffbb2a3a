#include "i2b/grid/splits.h"
#include "i2b/grid/octree.h"
#include "i2b/grid/resample.h"

namespace i2b {
namespace {

LevelTriple with(LevelTriple level, std::size_t axis, int value) {
    level[axis] = static_cast<std::uint8_t>(value);
    return level;
}

// Cells of one level that lie outside a set given on a coarser one.
Mask::Ptr outside(const Mask& cells, const LevelTriple& level, const Mask& coarse, const LevelTriple& coarseLevel) {
    const Mask::Ptr near = intersectionOf(coarse, *overlapping(cells, level, coarseLevel));
    return isEmpty(*near) ? std::make_shared<Mask>(cells) : differenceOf(cells, *overlapping(*near, coarseLevel, level));
}

// Adds the rest of every cell that the set holds a part of: where another axis has stopped at a coarser level, the
// cell is as long as that along it.
Mask::Ptr wholeCells(Mask::Ptr set, std::size_t axis, int round, const AxisSplits& splits) {
    for (std::size_t k = 1; k < 3; ++k) {
        const std::size_t other = (axis + k) % 3;
        Mask::Ptr rest = set;
        Mask::Ptr grown = set;
        LevelTriple level = allAxes(round);
        for (int j = round - 1; j >= 0; --j) {
            const LevelTriple next = with(level, other, j);
            rest = outside(*overlapping(*rest, level, next), next, *splits.axis[other][std::size_t(j)], allAxes(j));
            level = next;
            if (isEmpty(*rest)) break;
            grown = unionOf(*grown, *overlapping(*rest, level, allAxes(round)));
        }
        set = grown;
    }
    return set;
}

// Cells around what is split must be one level up at most: from the finest round to the coarsest.
void grade(AxisSplits& splits, const SizeField& field, const WantedCells& wanted) {
    for (std::size_t a = 0; a < 3; ++a) {
        std::vector<Mask::Ptr>& rounds = splits.axis[a];
        for (std::size_t l = rounds.size() - 1; l-- > 0;) {
            const Mask::Ptr below = unionOf(*wanted.walls[a][l + 1], *rounds[l + 1]);
            const Index3 size = field.lattice.cells(static_cast<int>(l) + 1);
            rounds[l] = unionOf(*rounds[l], *parentsOf(*dilated(*below, field.bufferCells, size)));
            rounds[l]->topologyUnion(*parentsOf(*wanted.spaces[a][l + 1]));
        }
    }
}

// From the coarsest round to the finest, since earlier rounds say how long cells are. True if a set grew.
bool makeWhole(AxisSplits& splits, int rounds) {
    bool grew = false;
    for (int l = 1; l < rounds; ++l) {
        for (std::size_t a = 0; a < 3; ++a) {
            Mask::Ptr& set = splits.axis[a][static_cast<std::size_t>(l)];
            const Mask::Ptr whole = wholeCells(set, a, l, splits);
            grew = grew || countOf(*whole) != countOf(*set);
            set = whole;
        }
    }
    return grew;
}

// Cells that stop at level l along the axis.
Mask::Ptr stopping(const Lattice& lattice, const AxisSplits& splits, std::size_t axis, std::size_t l) {
    const std::vector<Mask::Ptr>& rounds = splits.axis[axis];
    return l == 0 ? boxLess(lattice.count, *rounds[0]) : childrenLess(*rounds[l - 1], *rounds[l]);
}

// What two sets have in common, on the level that takes each axis from where it is finer. Each is a union of leaf
// cells where they meet, so one probe a cell is enough.
Mask::Ptr common(const Mask& a, const LevelTriple& levelA, const Mask& b, const LevelTriple& levelB, const LevelTriple& to) {
    const LevelTriple low = coarserOf(levelA, levelB);
    const Mask::Ptr both = intersectionOf(*overlapping(a, levelA, low), *overlapping(b, levelB, low));
    if (isEmpty(*both)) return both;
    const Mask::Ptr partA = intersectionOf(a, *overlapping(*both, low, levelA));
    const Mask::Ptr partB = intersectionOf(b, *overlapping(*both, low, levelB));
    return intersectionOf(*sampled(*partA, levelA, to), *sampled(*partB, levelB, to));
}

} // namespace

AxisSplits settleSplits(const SizeField& field, const WantedCells& wanted) {
    AxisSplits splits;
    for (std::vector<Mask::Ptr>& rounds : splits.axis) {
        for (int l = 0; l <= field.lattice.maxLevel; ++l) rounds.push_back(std::make_shared<Mask>(false));
    }
    do {
        grade(splits, field, wanted);
    } while (makeWhole(splits, field.lattice.maxLevel));
    return splits;
}

std::vector<CellLevel> leavesOfSplits(const Lattice& lattice, const AxisSplits& splits) {
    const auto levels = static_cast<std::size_t>(lattice.maxLevel) + 1;
    std::array<std::vector<Mask::Ptr>, 3> stop;
    for (std::size_t a = 0; a < 3; ++a) {
        for (std::size_t l = 0; l < levels; ++l) stop[a].push_back(stopping(lattice, splits, a, l));
    }
    std::vector<CellLevel> leaves;
    for (std::size_t i = 0; i < levels; ++i) {
        for (std::size_t j = 0; j < levels; ++j) {
            const LevelTriple xy = with(with(allAxes(static_cast<int>(std::max(i, j))), 0, static_cast<int>(i)), 1, static_cast<int>(j));
            const Mask::Ptr both = common(*stop[0][i], allAxes(static_cast<int>(i)), *stop[1][j], allAxes(static_cast<int>(j)), xy);
            if (isEmpty(*both)) continue;
            for (std::size_t k = 0; k < levels; ++k) {
                const LevelTriple level = with(xy, 2, static_cast<int>(k));
                const Mask::Ptr cells = common(*both, xy, *stop[2][k], allAxes(static_cast<int>(k)), level);
                if (!isEmpty(*cells)) leaves.push_back({level, cells});
            }
        }
    }
    std::sort(leaves.begin(), leaves.end(), [](const CellLevel& a, const CellLevel& b) {
        const int fa = a.level.finest(), fb = b.level.finest();
        return fa != fb ? fa < fb : a.level < b.level;
    });
    return leaves;
}

} // namespace i2b
