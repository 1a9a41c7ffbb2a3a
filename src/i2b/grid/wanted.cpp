#include "i2b/grid/wanted.h"
#include "i2b/grid/fill_shape.h"
#include "i2b/grid/mask_ops.h"
#include "i2b/grid/resample.h"

namespace i2b {
namespace {

class Collector {
  public:
    Collector(const Lattice& lattice, bool perAxis) {
        wanted_.perAxis = perAxis;
        for (std::size_t a = 0; a < 3; ++a) {
            for (int l = 0; l <= lattice.maxLevel; ++l) wanted_.axis[a].push_back(std::make_shared<Mask>(false));
        }
    }

    void add(const Mask& cells, const LevelTriple& level) {
        for (std::size_t a = 0; a < axes(); ++a) {
            if (level.same()) {
                wanted_.axis[a][level.x]->topologyUnion(cells);
            } else {
                addOne(a, level[a], overlapping(cells, level, allAxes(level[a])));
            }
        }
    }
    // As add(), and takes the mask's nodes where it can.
    void take(Mask::Ptr cells, const LevelTriple& level) {
        if (level.same() && !wanted_.perAxis) {
            addOne(0, level.x, std::move(cells));
        } else {
            add(*cells, level);
        }
    }
    WantedCells result() {
        if (!wanted_.perAxis) wanted_.axis[1] = wanted_.axis[2] = wanted_.axis[0];
        return std::move(wanted_);
    }

  private:
    std::size_t axes() const { return wanted_.perAxis ? 3 : 1; }
    void addOne(std::size_t axis, int level, Mask::Ptr cells) {
        Mask::Ptr& all = wanted_.axis[axis][static_cast<std::size_t>(level)];
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
    for (const LevelBox& rule : field.boxes) all.take(cellsOf(rule.box, lattice, rule.level), rule.level);
    for (const LevelShape& rule : field.shapes) all.take(cellsOf(rule.shape, lattice, rule.level), rule.level);
    for (const LevelCells& gap : field.gaps) all.take(maskOf(gap.cells), gap.level);
    for (const CellLevel& cut : atTarget) all.add(*cut.cells, cut.level);
    return all.result();
}

} // namespace i2b
