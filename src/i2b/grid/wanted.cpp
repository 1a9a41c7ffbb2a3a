#include "i2b/grid/wanted.h"
#include "i2b/grid/fill_shape.h"
#include "i2b/grid/mask_ops.h"
#include "i2b/grid/resample.h"

namespace i2b {
namespace {

// Cells of its size around a gap, instead of a buffer: gaps lie close together where there are many. Fewer, and what is sharp
// beside them meets too many hanging nodes.
constexpr int besideGaps = 2;

using Lists = std::array<std::vector<Mask::Ptr>, 3>;

class Collector {
  public:
    Collector(const Lattice& lattice, bool perAxis) {
        wanted_.perAxis = perAxis;
        for (Lists* lists : {&wanted_.walls, &wanted_.spaces}) {
            for (auto& list : *lists) {
                for (int l = 0; l <= lattice.maxLevel; ++l) list.push_back(std::make_shared<Mask>(false));
            }
        }
    }

    void addWalls(const Mask& cells, const LevelTriple& level) { add(wanted_.walls, cells, level); }
    // Takes the mask's nodes where it can.
    void takeSpace(Mask::Ptr cells, const LevelTriple& level) {
        if (level.same() && !wanted_.perAxis) {
            join(wanted_.spaces[0][level.x], std::move(cells));
        } else {
            add(wanted_.spaces, *cells, level);
        }
    }
    WantedCells result() {
        for (Lists* lists : {&wanted_.walls, &wanted_.spaces}) {
            if (!wanted_.perAxis) (*lists)[1] = (*lists)[2] = (*lists)[0];
        }
        return std::move(wanted_);
    }

  private:
    void add(Lists& lists, const Mask& cells, const LevelTriple& level) const {
        for (std::size_t a = 0; a < (wanted_.perAxis ? 3u : 1u); ++a) {
            if (level.same()) {
                lists[a][level.x]->topologyUnion(cells);
            } else {
                join(lists[a][static_cast<std::size_t>(level[a])], overlapping(cells, level, allAxes(level[a])));
            }
        }
    }
    static void join(Mask::Ptr& all, Mask::Ptr cells) {
        if (isEmpty(*all)) {
            all = std::move(cells);
        } else {
            all->topologyUnion(*cells);
        }
    }
    WantedCells wanted_;
};

Mask::Ptr maskOf(const std::vector<Index3>& cells) {
    auto mask = std::make_shared<Mask>(false);
    openvdb::tree::ValueAccessor<Mask> write(*mask);
    for (const Index3& c : cells) write.setValueOn(toCoord(c));
    return mask;
}

bool differs(const SizeField& field, const std::vector<CellLevel>& atTarget) {
    const auto any = [](const auto& rules) {
        return std::any_of(rules.begin(), rules.end(), [](const auto& rule) { return !rule.level.same(); });
    };
    return any(atTarget) || any(field.boxes) || any(field.shapes) || any(field.gaps);
}

} // namespace

WantedCells wantedCells(const SizeField& field, const std::vector<CellLevel>& atTarget) {
    const Lattice& lattice = field.lattice;
    Collector all(lattice, differs(field, atTarget));
    for (const LevelBox& rule : field.boxes) all.takeSpace(cellsOf(rule.box, lattice, rule.level), rule.level);
    for (const LevelShape& rule : field.shapes) all.takeSpace(cellsOf(rule.shape, lattice, rule.level), rule.level);
    for (const LevelCells& gap : field.gaps) all.takeSpace(dilated(*maskOf(gap.cells), besideGaps, lattice.cells(gap.level)), gap.level);
    for (const CellLevel& cut : atTarget) all.addWalls(*cut.cells, cut.level);
    return all.result();
}

} // namespace i2b
