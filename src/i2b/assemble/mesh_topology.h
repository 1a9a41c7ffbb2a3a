// Addressing of a PolyMesh turned round: the faces of a cell, the faces of a point. Compressed rows, built by
// count, scan, fill; the order of a row follows from the mesh alone.
#pragma once
#include "i2b/assemble/poly_mesh.h"
#include "i2b/core/raw_vector.h"
#include <cstdint>
#include <span>
#include <vector>

namespace i2b {

// Row i is items[offsets[i] .. offsets[i+1]).
struct Rows {
    RawVector<std::uint32_t> offsets; // rows + 1
    RawVector<std::int32_t> items;

    std::span<const std::int32_t> operator[](std::int32_t row) const {
        const auto r = static_cast<std::size_t>(row);
        return {items.data() + offsets[r], items.data() + offsets[r + 1]};
    }
};

// The faces a cell owns, ascending, then those it is the neighbour of, ascending.
Rows buildCellFaces(const PolyMesh& mesh);

// The faces that use a point, ascending.
Rows buildPointFaces(const PolyMesh& mesh);

// Per cell, the lowest cell of its region: cells are of one region when a chain of internal faces connects
// them.
std::vector<std::int32_t> regionRoots(const PolyMesh& mesh);

} // namespace i2b
