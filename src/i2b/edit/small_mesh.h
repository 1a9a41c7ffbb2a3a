// Some cells of a mesh with what lies around them, as a small mesh of its own that the measures of whole meshes can judge.
#pragma once
#include "i2b/core/vec.h"
#include "i2b/edit/local_edits.h"
#include <cstdint>
#include <functional>
#include <vector>

namespace i2b {

// Cells and points by numbers of the caller's, not below zero; in the small mesh they keep their order.
class SmallMesh {
  public:
    // isInner: as against what lies around, of which only moments count.
    void addCell(std::int32_t cell, bool isInner);
    // loop: its normal away from own; next: -1 where no cell lies behind. Cells that were not added count as none.
    void addFace(const std::vector<std::int32_t>& loop, std::int32_t own, std::int32_t next);
    // placeOf: of a point, m. points: their numbers, ascending, if asked for.
    LocalEdits::Surroundings build(const std::function<Vec3(std::int32_t)>& placeOf, std::vector<std::int32_t>* points = nullptr);

  private:
    struct Face {
        std::int32_t own, next;
        std::size_t begin, end; // in loops_
    };
    std::vector<std::int32_t> cells_, inner_, loops_;
    std::vector<Face> faces_;
};

} // namespace i2b
