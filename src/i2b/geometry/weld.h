// Welding of exactly equal points while a file is read, in two steps, both the same on any number of threads:
//
//   pieces of the file        each with its own small table in cache: corners -> points of the piece
//   all points of all pieces  one shared table, the lowest number of equals wins: -> points of the file
//
// A coherent file is nearly done after the first step; one in random order pays for the second. Welded, a
// triangle takes 28 bytes instead of 88. Nothing is moved: only equal coordinates of one part (-0 counts as
// 0) become one point.
#pragma once
#include "i2b/core/vec.h"
#include <array>
#include <cstdint>
#include <vector>

namespace i2b {

// The first step. Points are appended to a list that the caller owns; equals since the last startPart() are
// found again.
class PieceWelder {
  public:
    explicit PieceWelder(std::vector<Vec3>& points);
    std::uint32_t add(const Vec3& point); // its number in the list
    void startPart();                     // from here on nothing is welded to what came before

  private:
    void grow();
    std::vector<Vec3>& points_;
    std::vector<std::uint32_t> slots_; // open addressing, a power of two; numbers below first_ count as empty
    std::uint32_t first_ = 0;
};

// The second step: makes equal points of one part one, in the order of their first occurrence, and renumbers
// the triangles. partOf: per point. points.size() < 2^32 - 1.
void weldPoints(std::vector<Vec3>& points, const std::vector<std::int32_t>& partOf,
                std::vector<std::array<std::uint32_t, 3>>& triangles);

} // namespace i2b
