// A grid made by hand for the tests of the .vdb writer.
#pragma once
#include "i2b/write/vdb_write.h"
#include <algorithm>
#include <array>
#include <cmath>

namespace i2b::test {

// A ball of radius 1.2 about the middle of a box [-4,4]^3 of 8^3 base cells, level 0; base cells that come
// near the sphere are split once. The cells that the sphere meets are cut, those outside are the fluid
// (region 0, painted), those inside are region 1.
struct Ball {
    CellGrid grid;
    CutCells cut;
    Regions regions;
    KeptCells kept;
    static constexpr double radius = 1.2;

    static double distance(const Vec3& p, double) { return std::abs(norm(p) - radius); }

    explicit Ball(int refine = 1) {
        grid.lattice = {{-4, -4, -4}, {1, 1, 1}, {8, 8, 8}, refine};
        for (int l = 0; l <= refine; ++l) {
            const auto level = static_cast<std::uint8_t>(l);
            grid.levels.push_back({{level, level, level}, std::make_shared<Mask>()});
            cut.levels.push_back(std::make_shared<Mask>());
            kept.levels.push_back(std::make_shared<Mask>());
            regions.pieces.emplace_back();
        }
        regions.table.resize(2);
        regions.table[0].painted = true;
        regions.table[1].id = 1;
        for (int i = 0; i < 8; ++i)
            for (int j = 0; j < 8; ++j)
                for (int k = 0; k < 8; ++k) split(0, {i, j, k});
        for (std::size_t l = 0; l < grid.levels.size(); ++l) addPieces(l);
    }

    // Nearest and farthest point of a cell from the middle.
    static std::array<double, 2> range(const Box& box) {
        Vec3 near, far;
        for (int a = 0; a < 3; ++a) {
            near[a] = box.lo[a] > 0 ? box.lo[a] : box.hi[a] < 0 ? box.hi[a] : 0;
            far[a] = std::max(std::abs(box.lo[a]), std::abs(box.hi[a]));
        }
        return {norm(near), norm(far)};
    }

    void split(int level, const Index3& c) {
        const auto [near, far] = range(grid.lattice.cellBox(level, c));
        if (level < grid.lattice.maxLevel && near <= radius + 0.5 && far >= radius - 0.5) {
            for (int i = 0; i < 8; ++i)
                split(level + 1, {2 * c[0] + (i >> 2), 2 * c[1] + (i >> 1 & 1), 2 * c[2] + (i & 1)});
            return;
        }
        const openvdb::Coord at(c[0], c[1], c[2]);
        const auto l = static_cast<std::size_t>(level);
        grid.levels[l].cells->setValueOn(at);
        if (near <= radius && far >= radius)
            cut.levels[l]->setValueOn(at);
        else if (near > radius)
            kept.levels[l]->setValueOn(at);
    }

    void addPieces(std::size_t l) {
        for (auto leaf = grid.levels[l].cells->cbeginLeaf(); leaf; ++leaf) {
            std::array<RegionPiece, 2> pieces;
            for (auto cell = leaf->cbeginValueOn(); cell; ++cell) {
                if (cut.levels[l]->isValueOn(cell.getCoord())) continue;
                const std::size_t region = kept.levels[l]->isValueOn(cell.getCoord()) ? 0 : 1;
                pieces[region].mask[cell.pos() >> 6] |= std::uint64_t(1) << (cell.pos() & 63);
            }
            for (std::size_t r = 0; r < 2; ++r) {
                pieces[r].origin = {leaf->origin().x(), leaf->origin().y(), leaf->origin().z()};
                pieces[r].region = static_cast<std::int32_t>(r);
                if (pieces[r].mask != decltype(pieces[r].mask){}) regions.pieces[l].push_back(pieces[r]);
            }
        }
    }

    void write(const std::filesystem::path& path, const VdbWriteOptions& options = {}) const {
        writeVdb({grid, &cut, &regions, &kept, &Ball::distance}, path, options, Context());
    }
};

} // namespace i2b::test
