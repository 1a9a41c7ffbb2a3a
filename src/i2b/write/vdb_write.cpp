#include "i2b/write/vdb_write.h"
#include "i2b/write/vdb_file.h"
#include <algorithm>
#include <deque>
#include <fmt/format.h>
#include <openvdb/tools/Prune.h>
#include <tbb/parallel_invoke.h>

namespace i2b {
namespace {

using openvdb::GridBase;
using Maker = std::function<GridBase::Ptr()>; // null: there is nothing to write

// Voxel (i, j, k) is the cell (i, j, k) of the lattice, by its centre.
openvdb::math::Transform::Ptr cellTransform(const Lattice& lattice, const LevelTriple& level) {
    const openvdb::Vec3d size(lattice.base.x / double(1u << level.x), lattice.base.y / double(1u << level.y),
                              lattice.base.z / double(1u << level.z));
    const openvdb::Vec3d origin(lattice.origin.x, lattice.origin.y, lattice.origin.z);
    const openvdb::Vec3d centre = origin + 0.5 * size;
    openvdb::math::MapBase::Ptr map;
    if (size.x() == size.y() && size.x() == size.z())
        map = std::make_shared<openvdb::math::UniformScaleTranslateMap>(size.x(), centre);
    else
        map = std::make_shared<openvdb::math::ScaleTranslateMap>(size, centre);
    return std::make_shared<openvdb::math::Transform>(map);
}

template <class Tree>
GridBase::Ptr makeGrid(typename Tree::Ptr tree, const std::string& name, const Lattice& lattice,
                       const LevelTriple& level) {
    auto grid = openvdb::Grid<Tree>::create(tree);
    grid->setName(name);
    grid->setTransform(cellTransform(lattice, level));
    grid->setGridClass(openvdb::GRID_UNKNOWN);
    grid->setCreator("i2b");
    return grid;
}

template <class Tree>
GridBase::Ptr valueGrid(typename Tree::ValueType background, const std::string& name, const Lattice& lattice,
                        const std::function<void(PieceTree<Tree>&)>& fill) {
    auto tree = std::make_shared<Tree>(background);
    PieceTree<Tree> pieces(*tree, lattice.maxLevel);
    fill(pieces);
    openvdb::tools::prune(*tree);
    return makeGrid<Tree>(tree, name, lattice, allAxes(lattice.maxLevel));
}

template <class Tree>
void addLeaves(PieceTree<Tree>& pieces, const std::vector<Mask::Ptr>& levels) {
    for (std::size_t l = 0; l < levels.size(); ++l)
        if (levels[l])
            for (auto leaf = levels[l]->cbeginLeaf(); leaf; ++leaf) pieces.add(pieceOf(*leaf, static_cast<int>(l), 1));
}

void addValueGrids(const VdbInput& input, std::deque<Maker>& makers) {
    const Lattice& lattice = input.grid.lattice;
    makers.push_back([&] {
        return valueGrid<openvdb::FloatTree>(-1, "level", lattice, [&](auto& pieces) {
            for (std::size_t l = 0; l < input.grid.levels.size(); ++l)
                for (auto leaf = input.grid.levels[l].cells->cbeginLeaf(); leaf; ++leaf)
                    pieces.add(pieceOf(*leaf, static_cast<int>(l), static_cast<float>(l)));
        });
    });
    if (input.regions)
        makers.push_back([&] {
            return valueGrid<openvdb::FloatTree>(-1, "region", lattice, [&](auto& pieces) {
                for (std::size_t l = 0; l < input.regions->pieces.size(); ++l)
                    for (const RegionPiece& piece : input.regions->pieces[l])
                        pieces.add({static_cast<int>(l), piece.origin, piece.mask, static_cast<float>(piece.region)});
            });
        });
    if (input.cut)
        makers.push_back([&] {
            return valueGrid<openvdb::BoolTree>(false, "cut", lattice,
                                                [&](auto& pieces) { addLeaves(pieces, input.cut->levels); });
        });
    if (input.kept)
        makers.push_back([&] {
            return valueGrid<openvdb::BoolTree>(false, "kept", lattice,
                                                [&](auto& pieces) { addLeaves(pieces, input.kept->levels); });
        });
}

void addSurfaceGrids(const VdbInput& input, const VdbWriteOptions& options, const Context& context,
                     std::deque<Maker>& makers) {
    const Lattice& lattice = input.grid.lattice;
    const int level = options.bandLevel >= 0 ? std::min(options.bandLevel, lattice.maxLevel)
                                             : bandLevel(*input.cut, options.mostBandCells);
    if (level < 0) return; // nothing is cut
    const auto band = std::make_shared<SurfaceBand>();
    makers.push_back([&, band, level] {
        *band = buildSurfaceBand(input.grid, *input.cut, input.regions, input.kept, input.distance, level,
                                 options.halfWidth, context);
        GridBase::Ptr grid = makeGrid<openvdb::FloatTree>(std::move(band->signedDistance), "surface", lattice, allAxes(level));
        // A level set has cubes for voxels by definition.
        if (grid->hasUniformVoxels()) grid->setGridClass(openvdb::GRID_LEVEL_SET);
        return grid;
    });
    makers.push_back([&, band, level] {
        return makeGrid<openvdb::FloatTree>(std::move(band->distance), "distance", lattice, allAxes(level));
    });
}

// Bits of one level as a tree of truth values: full nodes are tiles at once, so that only ragged ones take room.
class MaskGridBuilder {
  public:
    using BoolLeaf = openvdb::BoolTree::LeafNodeType;

    void add(const Mask::LeafNodeType& leaf) {
        if (leaf.getValueMask().isOff()) return;
        if (leaf.getValueMask().isOn())
            at_.addTile(1, leaf.origin(), true, true);
        else
            at_.addLeaf(new BoolLeaf(leaf, false, true, openvdb::TopologyCopy()));
    }
    GridBase::Ptr grid(const std::string& name, const Lattice& lattice, const LevelTriple& level) {
        if (tree_->empty()) return nullptr;
        openvdb::tools::prune(*tree_);
        const std::string suffix = level.same() ? fmt::format("{}", level.x) : fmt::format("{}_{}_{}", level.x, level.y, level.z);
        return makeGrid<openvdb::BoolTree>(tree_, name + "_L" + suffix, lattice, level);
    }

  private:
    openvdb::BoolTree::Ptr tree_ = std::make_shared<openvdb::BoolTree>(false);
    openvdb::tree::ValueAccessor<openvdb::BoolTree> at_{*tree_};
};

GridBase::Ptr maskGrid(const CellGrid& grid, std::size_t l, const Mask::Ptr& mask, const std::string& name) {
    MaskGridBuilder builder;
    if (mask)
        for (auto leaf = mask->cbeginLeaf(); leaf; ++leaf) builder.add(*leaf);
    return builder.grid(name, grid.lattice, grid.levels[l].level);
}

// The cells of all painted regions. Pieces of one node follow each other.
GridBase::Ptr paintedGrid(const CellGrid& grid, std::size_t l, const Regions& regions) {
    MaskGridBuilder builder;
    const std::vector<RegionPiece>& pieces = regions.pieces[l];
    for (std::size_t i = 0, end = 0; i < pieces.size(); i = end) {
        Mask::LeafNodeType leaf(openvdb::Coord(pieces[i].origin.data()), false);
        openvdb::util::NodeMask<3> bits;
        for (end = i; end < pieces.size() && pieces[end].origin == pieces[i].origin; ++end)
            if (regions.table[static_cast<std::size_t>(pieces[end].region)].painted)
                for (openvdb::Index x = 0; x < 8; ++x) bits.getWord<std::uint64_t>(x) |= pieces[end].mask[x];
        leaf.setValueMask(bits);
        builder.add(leaf);
    }
    return builder.grid("painted", grid.lattice, grid.levels[l].level);
}

// By level, in place of the value grids.
void addStageMasks(const VdbInput& input, std::deque<Maker>& makers) {
    for (std::size_t l = 0; l < input.grid.levels.size(); ++l) {
        if (input.regions && l < input.regions->pieces.size())
            makers.push_back([&, l] { return paintedGrid(input.grid, l, *input.regions); });
        if (input.cut && l < input.cut->levels.size())
            makers.push_back([&, l] { return maskGrid(input.grid, l, input.cut->levels[l], "cut"); });
        if (input.kept && l < input.kept->levels.size())
            makers.push_back([&, l] { return maskGrid(input.grid, l, input.kept->levels[l], "kept"); });
    }
}

openvdb::MetaMap metadata(const VdbInput& input, const VdbWriteOptions& options, const std::string& masks) {
    openvdb::MetaMap meta;
    meta.insertMeta("program", openvdb::StringMetadata("i2b"));
    meta.insertMeta("version", openvdb::StringMetadata(options.version));
    meta.insertMeta("case", openvdb::StringMetadata(options.caseName));
    meta.insertMeta("size_surface", openvdb::DoubleMetadata(options.surfaceSize));
    meta.insertMeta("size_min", openvdb::DoubleMetadata(options.minSize));
    meta.insertMeta("size_max", openvdb::DoubleMetadata(options.maxSize));
    meta.insertMeta("levels", openvdb::Int32Metadata(input.grid.lattice.maxLevel + 1));
    for (const auto& [name, text] : options.texts) meta.insertMeta(name, openvdb::StringMetadata(text));
    if (!masks.empty()) meta.insertMeta("masks", openvdb::StringMetadata(masks));
    return meta;
}

// Makes each grid while the one before is written.
void writeAll(VdbFile& file, std::deque<Maker> makers, const Context& context) {
    GridBase::Ptr ready;
    while (ready || !makers.empty()) {
        context.checkCancelled();
        const Maker make = makers.empty() ? Maker() : std::move(makers.front());
        if (make) makers.pop_front();
        GridBase::Ptr next;
        tbb::parallel_invoke(
            [&] {
                if (ready) file.add(*ready);
            },
            [&] {
                if (make) next = make();
            });
        ready = std::move(next);
    }
}

} // namespace

void writeVdb(const VdbInput& input, const std::filesystem::path& path, const VdbWriteOptions& options,
              const Context& context) {
    openvdb::initialize();
    const bool cubes = std::all_of(input.grid.levels.begin(), input.grid.levels.end(),
                                   [](const CellLevel& level) { return level.level.same(); });
    std::uint64_t cells = 0;
    for (const CellLevel& level : input.grid.levels) cells += level.cells ? level.cells->activeVoxelCount() : 0;
    std::string masks;
    if (!cubes)
        masks = "the cells have no lattice in common: painted, cut and kept are masks by level";
    else if (cells > options.mostValueCells)
        masks = fmt::format("{} cells are many: painted, cut and kept are masks by level", cells);
    std::deque<Maker> makers;
    if (options.values && cubes && input.cut && input.distance) addSurfaceGrids(input, options, context, makers);
    if (options.values && masks.empty()) addValueGrids(input, makers);
    if (options.values && !masks.empty()) addStageMasks(input, makers);
    for (std::size_t l = 0; l < input.grid.levels.size(); ++l)
        makers.push_back([&, l] { return maskGrid(input.grid, l, input.grid.levels[l].cells, "cells"); });
    VdbFile file(path, metadata(input, options, masks));
    writeAll(file, std::move(makers), context);
    file.close();
}

} // namespace i2b
