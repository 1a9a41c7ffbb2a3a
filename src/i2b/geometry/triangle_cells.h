// Which unit cells [i, i + 1]^3 that a triangle meets, for a few nanoseconds each: the answer of TriangleBoxTest::meets()
// for every cell (closed, decided to the safe side), found for whole columns of cells at once.
//
// The columns run along the axis w that the triangle's normal is closest to, so that a triangle leaves one to three
// cells in each. A column's cells are one range, and each direction that may separate the two bounds it on its own:
//
//     3 lines in the plane (u, v)   say which columns there are: one range of v for each u
//     3 lines in (u, w), 3 in (v, w)     one range of w for each u, one for each v
//     the plane                     one range of w for each column, the sum of a part from u and one from v
//
// Work goes by tiles of 8 x 8 columns, which make whole nodes of 8x8x8 cells.
#pragma once
#include "i2b/geometry/triangle_box.h"
#include <array>
#include <cstdint>

namespace i2b {

class TriangleCells {
  public:
    using Cell = std::array<std::int32_t, 3>;
    using Words = std::array<std::uint64_t, 8>; // word x, bit y * 8 + z, as in grid/leaf_bits.h

    // In cells; of a test that outlives this.
    explicit TriangleCells(const TriangleBoxTest& test);

    // Calls mark(origin, words) once for every node of 8x8x8 cells that holds a cell that the triangle meets, of the
    // cells lo .. hi (both included).
    template <class Mark>
    void visit(const Cell& lo, const Cell& hi, const Mark& mark) const;

  private:
    // Places along an axis, in cells: all from the cell that holds lo to the one that holds hi.
    struct Range {
        double lo = std::numeric_limits<double>::infinity(), hi = -std::numeric_limits<double>::infinity();
    };
    struct Line { // all columns of one u, or of one v
        Range w, plane;
        std::int32_t first = 0, last = -1; // of a u: its columns, along v
    };
    struct Tile { // 8 x 8 columns
        Cell origin;
        std::array<Line, 8> us, vs;
        std::array<std::int32_t, 64> first, last; // the cells of each column; set where the u has the column
        std::int32_t lowest, highest;             // of all
    };

    Range clipped(std::size_t axis, std::int32_t i) const;
    Line lineOf(std::size_t axis, std::int32_t i) const;
    Line columnsOf(std::int32_t u, std::int32_t lo, std::int32_t hi) const;
    void fill(Tile& tile, const Cell& lo, const Cell& hi) const;
    Words wordsOf(const Tile& tile, std::int32_t w0) const;

    const TriangleBoxTest& test_;
    std::size_t u_, v_, w_;
    double perNormal_ = 0;  // 1 / the normal along w; 0: no plane
    double planeError_ = 0; // along w, with the rounding of places along it
};

inline TriangleCells::TriangleCells(const TriangleBoxTest& test) : test_(test) {
    const Vec3& n = test.absNormal_;
    w_ = n.z >= n.x && n.z >= n.y ? 2 : n.y >= n.x ? 1 : 0;
    u_ = (w_ + 1) % 3;
    v_ = (w_ + 2) % 3;
    const int u = static_cast<int>(u_), v = static_cast<int>(v_), w = static_cast<int>(w_);
    if (n[w] < 1e-290) return; // no extent across: the lines decide
    perNormal_ = 1 / test.normal_[w];
    const Vec3 size = test.bounds_.extent();
    const double far = std::max(std::abs(test.bounds_.lo[w]), std::abs(test.bounds_.hi[w]));
    planeError_ = test.planeError_ * std::abs(perNormal_) + 4 * TriangleBoxTest::eps * (far + size[u] + size[v]);
}

// The part of cell i along the axis that lies within the triangle's bounds, about its first vertex.
inline TriangleCells::Range TriangleCells::clipped(std::size_t axis, std::int32_t i) const {
    const int a = static_cast<int>(axis);
    return {std::max(double(i), test_.bounds_.lo[a]) - test_.origin_[a], std::min(double(i) + 1, test_.bounds_.hi[a]) - test_.origin_[a]};
}

// What one u or v says of places along w: its lines in the plane of the two, and its part of the plane's equation.
inline TriangleCells::Line TriangleCells::lineOf(std::size_t axis, std::int32_t i) const {
    Line line;
    const Range c = clipped(axis, i);
    Range w{-line.w.lo, line.w.lo};
    if (c.lo > c.hi || !test_.across(axis == u_ ? v_ : u_, axis == v_, c.lo, c.hi, w.lo, w.hi) || !test_.place(w_, w.lo, w.hi)) return line;
    line.w = w;
    line.plane = {-1e300, 1e300};
    if (perNormal_ == 0) return line;
    const double slope = -test_.normal_[static_cast<int>(axis)] * perNormal_;
    line.plane = {std::min(slope * c.lo, slope * c.hi), std::max(slope * c.lo, slope * c.hi)};
    return line;
}

inline TriangleCells::Line TriangleCells::columnsOf(std::int32_t u, std::int32_t lo, std::int32_t hi) const {
    Line line;
    const Range c = clipped(u_, u);
    Range v{-line.w.lo, line.w.lo};
    if (c.lo > c.hi || !test_.across(w_, true, c.lo, c.hi, v.lo, v.hi) || !test_.place(v_, v.lo, v.hi)) return line;
    const std::int32_t first = std::max(lo, floorToInt(v.lo)), last = std::min(hi, floorToInt(v.hi));
    if (first > last) return line;
    line = lineOf(u_, u);
    if (line.w.lo > line.w.hi + 1) return line;
    const double origin = test_.origin_[static_cast<int>(w_)];
    line.plane = {origin + line.plane.lo - planeError_, origin + line.plane.hi + planeError_};
    line.first = first;
    line.last = last;
    return line;
}

// The range of cells of every column, and of all of them.
inline void TriangleCells::fill(Tile& tile, const Cell& lo, const Cell& hi) const {
    const double low = lo[w_], high = hi[w_];
    tile.lowest = hi[w_] + 1, tile.highest = lo[w_] - 1;
    for (std::size_t i = 0; i < 8; ++i) {
        const Line& u = tile.us[i];
        for (std::int32_t j = std::max(u.first, tile.origin[v_]); j <= std::min(u.last, tile.origin[v_] + 7); ++j) {
            const auto k = static_cast<std::size_t>(j & 7);
            const Line& v = tile.vs[k];
            const double s = std::max({low, u.w.lo, v.w.lo, u.plane.lo + v.plane.lo});
            const double t = std::min({high, u.w.hi, v.w.hi, u.plane.hi + v.plane.hi});
            const bool some = s < high + 1 && t >= low;
            const std::int32_t first = some ? floorToInt(s) : 0, last = some ? floorToInt(t) : -1;
            tile.first[i * 8 + k] = first;
            tile.last[i * 8 + k] = last;
            if (first > last) continue;
            tile.lowest = std::min(tile.lowest, first);
            tile.highest = std::max(tile.highest, last);
        }
    }
}

// The cells w0 .. w0 + 7 of all columns.
inline TriangleCells::Words TriangleCells::wordsOf(const Tile& tile, std::int32_t w0) const {
    Words words{};
    for (std::size_t i = 0; i < 8; ++i) {
        const Line& u = tile.us[i];
        for (std::int32_t j = std::max(u.first, tile.origin[v_]); j <= std::min(u.last, tile.origin[v_] + 7); ++j) {
            const auto k = static_cast<std::size_t>(j & 7);
            const std::int32_t first = std::max(tile.first[i * 8 + k] - w0, 0), last = std::min(tile.last[i * 8 + k] - w0, 7);
            if (first > last) continue;
            if (w_ == 2) { // u is x, v is y: a run of bits
                words[i] |= ((std::uint64_t(2) << last) - (std::uint64_t(1) << first)) << (8 * k);
            } else if (w_ == 1) { // u is z, v is x: one bit in each of a run of bytes
                for (std::int32_t y = first; y <= last; ++y) words[k] |= std::uint64_t(1) << (8 * y + static_cast<int>(i));
            } else { // u is y, v is z: one bit in each of a run of words
                for (std::int32_t x = first; x <= last; ++x) words[static_cast<std::size_t>(x)] |= std::uint64_t(1) << (8 * i + k);
            }
        }
    }
    return words;
}

template <class Mark>
void TriangleCells::visit(const Cell& lo, const Cell& hi, const Mark& mark) const {
    Tile tile;
    for (std::int32_t u0 = lo[u_] & ~7; u0 <= hi[u_]; u0 += 8) {
        std::int32_t first = hi[v_] + 1, last = lo[v_] - 1;
        for (std::int32_t i = 0; i < 8; ++i) {
            Line& u = tile.us[static_cast<std::size_t>(i)];
            u.last = u.first - 1;
            if (u0 + i < lo[u_] || u0 + i > hi[u_]) continue;
            u = columnsOf(u0 + i, lo[v_], hi[v_]);
            if (u.first > u.last) continue;
            first = std::min(first, u.first);
            last = std::max(last, u.last);
        }
        for (std::int32_t v0 = first & ~7; v0 <= last; v0 += 8) {
            for (std::int32_t j = std::max(v0, first); j <= std::min(v0 + 7, last); ++j) tile.vs[static_cast<std::size_t>(j & 7)] = lineOf(v_, j);
            tile.origin[u_] = u0;
            tile.origin[v_] = v0;
            fill(tile, lo, hi);
            for (std::int32_t w0 = tile.lowest & ~7; w0 <= tile.highest; w0 += 8) {
                tile.origin[w_] = w0;
                const Words words = wordsOf(tile, w0);
                if (words != Words{}) mark(tile.origin, words);
            }
        }
    }
}

} // namespace i2b
