#include "i2b/write/vdb_write.h"
#include "i2b/core/checksum.h"
#include "i2b/core/error.h"
#include "i2b/write/output_file.h"
#include <algorithm>
#include <cerrno>
#include <fmt/format.h>
#include <fstream>
#include <openvdb/tools/Prune.h>
#include <tbb/parallel_invoke.h>

namespace i2b {
namespace {

using openvdb::GridBase;

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

LevelTriple cube(int level) {
    const auto l = static_cast<std::uint8_t>(level);
    return {l, l, l};
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
GridBase::Ptr pieceGrid(const std::vector<ValuePiece>& pieces, typename Tree::ValueType background,
                        const std::string& name, const Lattice& lattice) {
    auto tree = std::make_shared<Tree>(background);
    PieceTree<Tree>(*tree, lattice.maxLevel).add(pieces);
    openvdb::tools::prune(*tree);
    return makeGrid<Tree>(tree, name, lattice, cube(lattice.maxLevel));
}

std::vector<ValuePiece> regionPieces(const Regions& regions) {
    std::vector<ValuePiece> pieces;
    for (std::size_t l = 0; l < regions.pieces.size(); ++l)
        for (const RegionPiece& piece : regions.pieces[l])
            pieces.push_back(
                {static_cast<int>(l), piece.origin, piece.mask, static_cast<float>(piece.region)});
    return pieces;
}

// level, region, cut and kept, each built by one thread while others build the rest.
void addValueGrids(const VdbInput& input, std::vector<GridBase::Ptr>& grids) {
    const Lattice& lattice = input.grid.lattice;
    std::array<GridBase::Ptr, 4> made;
    tbb::parallel_invoke(
        [&] {
            std::vector<Mask::Ptr> cells;
            for (const CellLevel& level : input.grid.levels) cells.push_back(level.cells);
            made[0] = pieceGrid<openvdb::FloatTree>(piecesOf(cells), -1, "level", lattice);
        },
        [&] {
            if (input.regions)
                made[1] = pieceGrid<openvdb::FloatTree>(regionPieces(*input.regions), -1, "region", lattice);
        },
        [&] {
            if (input.cut)
                made[2] = pieceGrid<openvdb::BoolTree>(piecesOf(input.cut->levels, 1), false, "cut", lattice);
        },
        [&] {
            if (input.kept)
                made[3] =
                    pieceGrid<openvdb::BoolTree>(piecesOf(input.kept->levels, 1), false, "kept", lattice);
        });
    for (const GridBase::Ptr& grid : made)
        if (grid) grids.push_back(grid);
}

void addSurfaceGrids(const VdbInput& input, const VdbWriteOptions& options, const Context& context,
                     std::vector<GridBase::Ptr>& grids) {
    const int level = options.bandLevel >= 0 ? std::min(options.bandLevel, input.grid.lattice.maxLevel)
                                             : bandLevel(*input.cut);
    if (level < 0) return; // nothing is cut
    const SurfaceBand band = buildSurfaceBand(input.grid, *input.cut, input.regions, input.kept,
                                              input.distance, level, options.halfWidth, context);
    grids.push_back(
        makeGrid<openvdb::FloatTree>(band.signedDistance, "surface", input.grid.lattice, cube(level)));
    // A level set has cubes for voxels by definition.
    if (grids.back()->hasUniformVoxels()) grids.back()->setGridClass(openvdb::GRID_LEVEL_SET);
    grids.push_back(makeGrid<openvdb::FloatTree>(band.distance, "distance", input.grid.lattice, cube(level)));
}

void addCellMasks(const CellGrid& grid, std::vector<GridBase::Ptr>& grids) {
    for (const CellLevel& level : grid.levels) {
        if (!level.cells || level.cells->empty()) continue;
        const LevelTriple& l = level.level;
        const bool same = l.x == l.y && l.y == l.z;
        const std::string name =
            same ? fmt::format("cells_L{}", l.x) : fmt::format("cells_L{}_{}_{}", l.x, l.y, l.z);
        auto tree = std::make_shared<openvdb::BoolTree>(*level.cells, false, true, openvdb::TopologyCopy());
        openvdb::tools::prune(*tree);
        grids.push_back(makeGrid<openvdb::BoolTree>(tree, name, grid.lattice, l));
    }
}

openvdb::MetaMap metadata(const VdbInput& input, const VdbWriteOptions& options) {
    openvdb::MetaMap meta;
    meta.insertMeta("program", openvdb::StringMetadata("i2b"));
    meta.insertMeta("version", openvdb::StringMetadata(options.version));
    meta.insertMeta("case", openvdb::StringMetadata(options.caseName));
    meta.insertMeta("size_surface", openvdb::DoubleMetadata(options.surfaceSize));
    meta.insertMeta("size_min", openvdb::DoubleMetadata(options.minSize));
    meta.insertMeta("size_max", openvdb::DoubleMetadata(options.maxSize));
    meta.insertMeta("levels", openvdb::Int32Metadata(input.grid.lattice.maxLevel + 1));
    return meta;
}

// The library's own File does not look whether its stream failed: a full disk would pass for success.
class CheckedArchive : public openvdb::io::Archive {
  public:
    CheckedArchive() { setCompression(openvdb::io::COMPRESS_BLOSC | openvdb::io::COMPRESS_ACTIVE_MASK); }

    void save(const std::filesystem::path& path, const std::vector<GridBase::Ptr>& grids,
              const openvdb::MetaMap& meta) const {
        const openvdb::GridCPtrVec all(grids.begin(), grids.end());
        errno = 0;
        std::ofstream out(path, std::ios::binary);
        if (!out) throwSystemError("create the file", path, errno);
        try {
            out.exceptions(std::ios::failbit | std::ios::badbit);
            write(out, all, true, meta);
            out.close();
        } catch (const std::ios::failure&) {
            throwSystemError("write", path, errno ? errno : EIO);
        } catch (const openvdb::Exception& problem) {
            if (!out || errno == ENOSPC) throwSystemError("write", path, errno ? errno : EIO);
            throw Error(ErrorKind::internal, problem.what(), path.string(), "report this");
        }
    }

  private:
    using Archive::write;
};

// The library draws a random UUID; ours says what the file holds. It stands behind the magic number, three
// versions and a flag.
void settleUuid(const std::filesystem::path& path) {
    constexpr std::streamoff place = 8 + 3 * 4 + 1;
    constexpr std::size_t length = 36;
    std::fstream file(path, std::ios::binary | std::ios::in | std::ios::out);
    std::string text(length, ' ');
    file.seekg(place);
    file.read(text.data(), length);
    if (!file || text[8] != '-' || text[23] != '-') return; // a later layout: leave it
    Checksum sum;
    std::vector<char> buffer(std::size_t(1) << 20);
    while (file.read(buffer.data(), static_cast<std::streamsize>(buffer.size())), file.gcount() > 0)
        sum.bytes(buffer.data(), static_cast<std::size_t>(file.gcount()));
    file.clear();
    const std::string a = sum.hex();
    sum.add(std::uint64_t(1));
    const std::string b = sum.hex();
    text = fmt::format("{}-{}-4{}-8{}-{}", a.substr(0, 8), a.substr(8, 4), a.substr(13, 3), b.substr(1, 3),
                       b.substr(4, 12));
    file.seekp(place);
    file.write(text.data(), length);
    file.close();
    if (!file) throwSystemError("write", path, errno ? errno : EIO);
}

} // namespace

void writeVdb(const VdbInput& input, const std::filesystem::path& path, const VdbWriteOptions& options,
              const Context& context) {
    openvdb::initialize();
    const bool cubes =
        std::all_of(input.grid.levels.begin(), input.grid.levels.end(), [](const CellLevel& level) {
            return level.level.x == level.level.y && level.level.y == level.level.z;
        });
    std::vector<GridBase::Ptr> grids;
    if (options.values && cubes) {
        if (input.cut && input.distance) addSurfaceGrids(input, options, context, grids);
        context.checkCancelled();
        addValueGrids(input, grids);
    }
    context.checkCancelled();
    addCellMasks(input.grid, grids);
    context.checkCancelled();
    CheckedArchive().save(path, grids, metadata(input, options));
    settleUuid(path);
}

} // namespace i2b
