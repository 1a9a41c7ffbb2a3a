// Values of cells of many levels as one sparse tree on the finest lattice. A cell of 8 finest cells or more
// along an edge is tiles; smaller ones are voxels only where a block of 8x8x8 finest cells does not hold one
// value alone.
//
//     cells of the finest level:  one node 8^3 is 1 block      of the next:  one node is 2^3 blocks of 4^3
//     cells two levels up:              4^3 blocks of 2^3 cells      three:        each cell is a block, a
//     tile
#pragma once
#include "i2b/grid/cell_grid.h"
#include <array>
#include <bit>
#include <cstdint>
#include <vector>

namespace i2b {

// Cells of one tree node that have one value in common.
struct ValuePiece {
    int level = 0;
    std::array<std::int32_t, 3> origin{}; // of the 8x8x8 node, level coordinates
    std::array<std::uint64_t, 8> mask{};  // word x, bit y * 8 + z
    float value = 0;
};

// A piece of a mask's leaf node.
inline ValuePiece pieceOf(const Mask::LeafNodeType& leaf, int level, float value) {
    ValuePiece piece{level, {leaf.origin().x(), leaf.origin().y(), leaf.origin().z()}, {}, value};
    for (openvdb::Index x = 0; x < 8; ++x) piece.mask[x] = leaf.getValueMask().getWord<std::uint64_t>(x);
    return piece;
}

// Adds pieces to a tree on the lattice of level `finest`, as active or as inactive values. Pieces of finer levels are
// skipped; no two may overlap.
template <class Tree>
class PieceTree {
  public:
    using Value = typename Tree::ValueType;
    PieceTree(Tree& tree, int finest, bool active = true)
        : tree_(tree), at_(tree), finest_(finest), active_(active) {}

    void add(const ValuePiece& piece) {
        if (piece.level > finest_) return;
        const int shift = finest_ - piece.level;
        const auto value = static_cast<Value>(piece.value);
        if (shift > 3) return addLargeCells(piece, shift, value);
        const int cells = 8 >> shift; // of a block along an edge
        for (int x = 0; x < 8; x += cells)
            for (int y = 0; y < 8; y += cells)
                for (int z = 0; z < 8; z += cells) addBlock(piece, {x, y, z}, cells, shift, value);
    }

  private:

    static bool has(const ValuePiece& piece, int x, int y, int z) {
        return (piece.mask[static_cast<std::size_t>(x)] >> (y * 8 + z)) & 1;
    }

    static openvdb::Coord place(const ValuePiece& piece, int x, int y, int z, int shift) {
        return {(piece.origin[0] + x) << shift, (piece.origin[1] + y) << shift,
                (piece.origin[2] + z) << shift};
    }

    // Cells of 16 to 64: eight and more fill a block of 128, which is one tile of the next level and costs no node.
    void addLargeCells(const ValuePiece& piece, int shift, const Value& value) {
        const int cells = shift < 7 ? 128 >> shift : 1; // of a block along an edge
        for (int x = 0; x < 8; x += cells)
            for (int y = 0; y < 8; y += cells)
                for (int z = 0; z < 8; z += cells) {
                    const int n = countIn(piece, {x, y, z}, cells);
                    if (n == cells * cells * cells)
                        addTiles(place(piece, x, y, z, shift), cells << shift, value);
                    else if (n > 0)
                        forCells(piece, {x, y, z}, cells, [&](int i, int j, int k) {
                            addTiles(place(piece, i, j, k, shift), 1 << shift, value);
                        });
                }
    }

    template <class Body>
    static void forCells(const ValuePiece& piece, const std::array<int, 3>& at, int cells, const Body& body) {
        for (int x = at[0]; x < at[0] + cells; ++x)
            for (int y = at[1]; y < at[1] + cells; ++y)
                for (int z = at[2]; z < at[2] + cells; ++z)
                    if (has(piece, x, y, z)) body(x, y, z);
    }

    static int countIn(const ValuePiece& piece, const std::array<int, 3>& at, int cells) {
        int count = 0;
        const std::uint64_t row = ((std::uint64_t(1) << cells) - 1) << at[2]; // along z
        for (int x = at[0]; x < at[0] + cells; ++x)
            for (int y = at[1]; y < at[1] + cells; ++y)
                count += std::popcount(piece.mask[static_cast<std::size_t>(x)] >> (y * 8) & row);
        return count;
    }

    // A cell in the largest tiles that it is made of: 8, 128 or 4096 finest cells along an edge.
    void addTiles(const openvdb::Coord& lo, int edge, const Value& value) {
        const int tile = edge >= 4096 ? 4096 : edge >= 128 ? 128 : 8;
        const openvdb::Index level = edge >= 4096 ? 3 : edge >= 128 ? 2 : 1;
        for (int x = 0; x < edge; x += tile)
            for (int y = 0; y < edge; y += tile)
                for (int z = 0; z < edge; z += tile) at_.addTile(level, lo.offsetBy(x, y, z), value, active_);
    }

    void addBlock(const ValuePiece& piece, const std::array<int, 3>& at, int cells, int shift,
                  const Value& value) {
        const int count = countIn(piece, at, cells);
        if (count == 0) return;
        const openvdb::Coord origin = place(piece, at[0], at[1], at[2], shift);
        if (count == cells * cells * cells) return at_.addTile(1, origin, value, active_);
        auto* leaf = at_.touchLeaf(origin);
        forCells(piece, at, cells, [&](int x, int y, int z) {
            setVoxels(*leaf, place(piece, x, y, z, shift), 1 << shift, value);
        });
    }

    template <class Leaf>
    void setVoxels(Leaf& leaf, const openvdb::Coord& lo, int edge, const Value& value) {
        for (int x = 0; x < edge; ++x)
            for (int y = 0; y < edge; ++y)
                for (int z = 0; z < edge; ++z) {
                    const openvdb::Index n = Leaf::coordToOffset(lo.offsetBy(x, y, z));
                    if (active_)
                        leaf.setValueOn(n, value);
                    else
                        leaf.setValueOff(n, value);
                }
    }

    Tree& tree_;
    openvdb::tree::ValueAccessor<Tree> at_;
    int finest_;
    bool active_;
};

} // namespace i2b
