#include "i2b/write/vdb_band.h"
#include "i2b/core/parallel.h"
#include <algorithm>
#include <array>
#include <cmath>
#include <openvdb/tools/Morphology.h>
#include <memory>
#include <unordered_map>

namespace i2b {
namespace {

using openvdb::Coord;
using MaskLeaf = Mask::LeafNodeType;

enum Side : std::int8_t { negative = -1, unknown = 0, positive = 1, outside = 2 };

constexpr std::array<std::array<int, 3>, 6> faceNeighbours{
    {{-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 1}}};

std::vector<Mask::Ptr> fluidCells(const CellGrid& grid, const Regions* regions, const KeptCells* kept) {
    if (!regions || regions->table.empty()) return kept ? kept->levels : std::vector<Mask::Ptr>{};
    std::vector<Mask::Ptr> fluid(grid.levels.size());
    for (std::size_t l = 0; l < fluid.size(); ++l) {
        fluid[l] = std::make_shared<Mask>();
        if (l >= regions->pieces.size()) continue;
        for (const RegionPiece& piece : regions->pieces[l]) {
            if (!regions->table[static_cast<std::size_t>(piece.region)].painted) continue;
            auto* leaf = fluid[l]->touchLeaf(Coord(piece.origin.data()));
            for (openvdb::Index x = 0; x < 8; ++x)
                leaf->getValueMask().getWord<std::uint64_t>(x) |= piece.mask[x];
        }
    }
    return fluid;
}

// Which side a voxel of any level lies on, by the cell that holds it or, where it is split, by its children.
class SideLookup {
  public:
    SideLookup(const CellGrid& grid, const CutCells& cut, const std::vector<Mask::Ptr>& fluid) {
        for (std::size_t l = 0; l < grid.levels.size(); ++l)
            levels_.push_back(
                {accessor(grid.levels[l].cells), accessor(at(cut.levels, l)), accessor(at(fluid, l))});
    }

    Side operator()(int level, const Coord& c) const {
        for (int l = level; l >= 0; --l) {
            const int up = level - l;
            const Coord parent(c.x() >> up, c.y() >> up, c.z() >> up);
            if (const Side side = leafSide(l, parent); side != outside) return side;
        }
        return fromChildren(level, c);
    }

  private:
    using Accessor = openvdb::tree::ValueAccessor<const Mask>;
    struct Level {
        Accessor cells, cut, fluid;
    };

    static Mask::Ptr at(const std::vector<Mask::Ptr>& masks, std::size_t l) {
        return l < masks.size() ? masks[l] : nullptr;
    }
    Accessor accessor(Mask::Ptr mask) { return Accessor(mask ? *mask : empty_); }

    // `outside` where the voxel is no leaf cell of the level.
    Side leafSide(int l, const Coord& c) const {
        const Level& level = levels_[static_cast<std::size_t>(l)];
        if (level.cut.isValueOn(c)) return unknown;
        if (level.fluid.isValueOn(c)) return positive;
        return level.cells.isValueOn(c) ? negative : outside;
    }

    Side fromChildren(int level, const Coord& c) const {
        if (level + 1 >= static_cast<int>(levels_.size())) return outside;
        Side found = outside;
        for (int i = 0; i < 8; ++i) {
            const Coord child(2 * c.x() + (i >> 2), 2 * c.y() + ((i >> 1) & 1), 2 * c.z() + (i & 1));
            Side side = leafSide(level + 1, child);
            if (side == outside) side = fromChildren(level + 1, child);
            if (side == unknown) return unknown;
            if (side == outside) return outside; // the domain ends, or the level is finer still and empty
            if (found == outside || side == positive) found = side;
        }
        return found;
    }

    Mask empty_;
    std::vector<Level> levels_;
};

// Voxels of the level that hold a cut cell, a part of one or several, grown by the half width.
Mask::Ptr bandTopology(const CellGrid& grid, const CutCells& cut, int level, int halfWidth) {
    auto band = std::make_shared<Mask>();
    openvdb::tree::ValueAccessor<Mask> at(*band);
    for (std::size_t l = 0; l < cut.levels.size(); ++l) {
        if (!cut.levels[l]) continue;
        const int shift = level - static_cast<int>(l);
        for (auto voxel = cut.levels[l]->cbeginValueOn(); voxel; ++voxel) {
            const Coord c = voxel.getCoord();
            if (shift <= 0) {
                at.setValueOn(Coord(c.x() >> -shift, c.y() >> -shift, c.z() >> -shift));
            } else {
                const Coord lo(c.x() << shift, c.y() << shift, c.z() << shift);
                at.clear();
                band->fill(openvdb::CoordBBox(lo, lo.offsetBy((1 << shift) - 1)), true, true);
            }
        }
    }
    band->voxelizeActiveTiles();
    openvdb::tools::dilateActiveValues(*band, halfWidth, openvdb::tools::NN_FACE_EDGE_VERTEX,
                                       openvdb::tools::IGNORE_TILES);
    const Index3 n = grid.lattice.cells(level);
    band->clip(openvdb::CoordBBox(Coord(0), Coord(n[0] - 1, n[1] - 1, n[2] - 1)));
    return band;
}

// The voxels of a leaf such that each lies beside the one before.
constexpr std::array<std::uint16_t, 512> toAndFro = [] {
    std::array<std::uint16_t, 512> order{};
    for (unsigned i = 0; i < 512; ++i) {
        const unsigned x = i >> 6, y = (i >> 3 & 7) ^ (x & 1 ? 7u : 0u), z = (i & 7) ^ (i >> 3 & 1 ? 7u : 0u);
        order[i] = static_cast<std::uint16_t>(x << 6 | y << 3 | z);
    }
    return order;
}();

using VoxelBits = openvdb::util::NodeMask<3>;

struct Block {
    std::array<float, 512> distance{};
    std::array<Side, 512> side{};
    VoxelBits open;  // of the band, on no known side
    VoxelBits fresh; // on a known side since the last sweep
};

class BandBuilder {
  public:
    BandBuilder(const CellGrid& grid, const Mask& band, int level, const DistanceFunction& distance)
        : lattice_(grid.lattice), level_(level), size_(lattice_.cellSize(level)), distance_(distance) {
        band.getNodes(leaves_);
        blocks_.resize(leaves_.size());
        for (std::size_t i = 0; i < leaves_.size(); ++i) number_[leaves_[i]->origin()] = i;
    }

    // Distances up to `width`; infinite beyond.
    void measure(const SideLookup& shared, double width, const Context& context) {
        parallelChunks(leaves_.size(), 16, [&](std::size_t begin, std::size_t end, std::size_t) {
            context.checkCancelled();
            const SideLookup sideOf(shared); // accessors are one thread's own
            for (std::size_t i = begin; i < end; ++i) {
                Vec3 near;
                double reach = std::numeric_limits<double>::infinity(); // of the geometry from near
                for (const openvdb::Index n : toAndFro) {
                    const Coord c = leaves_[i]->offsetToGlobalCoord(n);
                    const Side side = sideOf(level_, c);
                    blocks_[i].side[n] = side;
                    if (!leaves_[i]->isValueOn(n)) continue;
                    blocks_[i].open.set(n, side == unknown);
                    blocks_[i].fresh.set(n, side == positive || side == negative);
                    const Vec3 p = centre(c);
                    // It cannot be farther than by way of the voxel before: much is never looked at.
                    reach = distance_(p, 1.000001 * std::min(reach + norm(p - near), width));
                    near = p;
                    blocks_[i].distance[n] = static_cast<float>(reach);
                }
            }
        });
    }

    // Passes signs into the cut cells, one voxel a sweep, from those that have got theirs in the sweep before; each sweep reads
    // the one before alone, so the order in which voxels are visited does not matter.
    void passSigns(const Context& context) {
        for (int sweep = 0; sweep < 64; ++sweep) {
            context.checkCancelled();
            std::vector<std::vector<std::pair<openvdb::Index, Side>>> found(leaves_.size());
            parallelFor(
                leaves_.size(), [&](std::size_t i) { sweepBlock(i, found[i]); }, 4);
            if (std::ranges::all_of(found, [](const auto& block) { return block.empty(); })) return;
            parallelFor(found.size(), [&](std::size_t i) {
                Block& block = blocks_[i];
                block.fresh.setOff();
                for (const auto& [n, side] : found[i]) block.side[n] = side, block.fresh.setOn(n), block.open.setOff(n);
            });
        }
    }

    // Puts the band into two trees: it replaces what they hold at its places.
    void fill(float width, openvdb::FloatTree& surface, openvdb::FloatTree& fluid) const {
        using Leaf = openvdb::FloatTree::LeafNodeType;
        std::vector<std::unique_ptr<Leaf>> near(leaves_.size()), wet(leaves_.size());
        const auto make = [&](std::size_t i) {
            near[i] = std::make_unique<Leaf>(leaves_[i]->origin(), width);
            wet[i] = std::make_unique<Leaf>(leaves_[i]->origin(), width);
            for (openvdb::Index n = 0; n < 512; ++n) {
                const bool plus = blocks_[i].side[n] == positive || blocks_[i].side[n] == outside;
                const float d = blocks_[i].distance[n];
                if (!leaves_[i]->isValueOn(n) || !(d < width)) {
                    near[i]->setValueOff(n, plus ? width : -width);
                    continue;
                }
                near[i]->setValueOn(n, plus ? d : -d);
                if (plus) wet[i]->setValueOn(n, d);
            }
        };
        parallelFor(leaves_.size(), make, 16);
        for (std::size_t i = 0; i < leaves_.size(); ++i) {
            if (!near[i]->isEmpty()) surface.addLeaf(near[i].release());
            if (!wet[i]->isEmpty()) fluid.addLeaf(wet[i].release());
        }
    }

  private:
    Vec3 centre(const Coord& c) const {
        return lattice_.origin +
               Vec3{(c.x() + 0.5) * size_.x, (c.y() + 0.5) * size_.y, (c.z() + 0.5) * size_.z};
    }

    void sweepBlock(std::size_t i, std::vector<std::pair<openvdb::Index, Side>>& found) const {
        for (auto voxel = blocks_[i].open.beginOn(); voxel; ++voxel) {
            const openvdb::Index n = voxel.pos();
            const Coord c = leaves_[i]->offsetToGlobalCoord(n);
            for (int k = 0; k < 6; ++k) {
                const auto& step = faceNeighbours[static_cast<std::size_t>(k)];
                const Coord other = c.offsetBy(step[0], step[1], step[2]);
                const Block* const block = blockOf(i, other);
                const openvdb::Index m = MaskLeaf::coordToOffset(other);
                if (!block || !block->fresh.isOn(m)) continue;
                if (!reaches(other, block->distance[m], c, blocks_[i].distance[n], size_[k / 2])) continue;
                found.emplace_back(n, block->side[m]);
                break;
            }
        }
    }

    // The block that a voxel is in, most often this one; nullptr: the band has none there.
    const Block* blockOf(std::size_t here, const Coord& c) const {
        if ((c & ~7) == leaves_[here]->origin()) return &blocks_[here];
        const auto at = number_.find(c & ~7);
        return at == number_.end() ? nullptr : &blocks_[at->second];
    }

    // Does the straight line between two voxel centres keep off the geometry? The spheres around the ends are
    // free.
    bool reaches(const Coord& from, double room, const Coord& to, double roomThere, double length) const {
        const Vec3 a = centre(from), b = centre(to);
        const double least = 1e-3 * length;
        for (double t = room; t < length - roomThere;) {
            const double left = length - roomThere - t; // farther off, it is as good as infinitely far
            const double r = distance_(a + (b - a) * (t / length), std::max(left, least));
            if (r < least) return false;
            t += r;
        }
        return room + roomThere > 0;
    }

    const Lattice& lattice_;
    int level_;
    Vec3 size_;
    const DistanceFunction& distance_;
    std::vector<const MaskLeaf*> leaves_;
    std::vector<Block> blocks_;
    std::unordered_map<Coord, std::size_t, std::hash<Coord>> number_; // of the leaf at an origin
};

// The cells that are neither fluid nor cut, as inactive values inside the geometry.
void addSolid(const CellGrid& grid, const CutCells& cut, const std::vector<Mask::Ptr>& fluid, int level, float value,
              openvdb::FloatTree& tree) {
    PieceTree<openvdb::FloatTree> pieces(tree, level, false);
    for (std::size_t l = 0; l < grid.levels.size() && static_cast<int>(l) <= level; ++l) {
        for (auto leaf = grid.levels[l].cells->cbeginLeaf(); leaf; ++leaf) {
            ValuePiece piece = pieceOf(*leaf, static_cast<int>(l), value);
            for (const auto* masks : {&cut.levels, &fluid}) {
                if (l >= masks->size() || !(*masks)[l]) continue;
                const MaskLeaf* other = (*masks)[l]->probeConstLeaf(leaf->origin());
                for (openvdb::Index x = 0; other && x < 8; ++x) piece.mask[x] &= ~other->getValueMask().getWord<std::uint64_t>(x);
            }
            pieces.add(piece);
        }
    }
}

} // namespace

int bandLevel(const CutCells& cut, std::uint64_t mostCells) {
    int best = -1;
    std::uint64_t most = 0;
    std::vector<double> counts;
    for (std::size_t l = 0; l < cut.levels.size(); ++l) {
        const std::uint64_t count = cut.levels[l] ? cut.levels[l]->activeVoxelCount() : 0;
        if (count > 0 && count >= most) best = static_cast<int>(l), most = count;
        counts.push_back(static_cast<double>(count));
    }
    const auto cellsAt = [&](int level) { // a surface has four times the cells on the next finer level
        double sum = 0;
        for (std::size_t l = 0; l < counts.size(); ++l) sum += std::ldexp(counts[l], 2 * (level - static_cast<int>(l)));
        return sum;
    };
    while (best > 0 && cellsAt(best) > static_cast<double>(mostCells)) --best;
    return best;
}

SurfaceBand buildSurfaceBand(const CellGrid& grid, const CutCells& cut, const Regions* regions,
                             const KeptCells* kept, const DistanceFunction& distance, int level,
                             int halfWidth, const Context& context) {
    const std::vector<Mask::Ptr> fluid = fluidCells(grid, regions, kept);
    const Mask::Ptr band = bandTopology(grid, cut, level, halfWidth);
    const auto width = static_cast<float>(halfWidth * grid.lattice.h(level));
    BandBuilder builder(grid, *band, level, distance);
    builder.measure(SideLookup(grid, cut, fluid), width, context);
    builder.passSigns(context);
    SurfaceBand result;
    result.level = level;
    result.signedDistance = std::make_shared<openvdb::FloatTree>(width);
    result.distance = std::make_shared<openvdb::FloatTree>(width);
    // Beyond the band the tree must know inside from outside, too, or a filled volume made from it would be
    // hollow.
    addSolid(grid, cut, fluid, level, -width, *result.signedDistance);
    builder.fill(width, *result.signedDistance, *result.distance);
    return result;
}

} // namespace i2b
