// What the addressing of a cell says, without its points: its shape, the use of its edges, the order of its faces.
// measureCells() asks it on its way over the cells.
#pragma once
#include "i2b/quality/cell_edges.h"
#include "i2b/quality/measure_steps.h"
#include <map>

namespace i2b {

// Of a stretch of cells: what is counted of their addressing and of their geometry.
struct CellPart {
    Tally illegal, zipUp, multiFaces, oneInternal, twoInternal, open, aspect, zeroVolume, determinant,
        concave;
    std::int64_t openByEdges = 0, unordered = 0, multiplyConnected = 0;
    Extremes openness, aspectRatio, volume, determinants, fullness;
    Tally hollow;
    std::vector<std::int32_t> hollowFaces;
    CellShapes shapes;
    std::map<std::int64_t, std::int64_t> polyhedra;
    std::vector<std::int32_t> unorderedFaces;

    void join(const CellPart& o) {
        illegal.join(o.illegal), zipUp.join(o.zipUp), oneInternal.join(o.oneInternal),
            twoInternal.join(o.twoInternal);
        open.join(o.open), aspect.join(o.aspect), zeroVolume.join(o.zeroVolume),
            determinant.join(o.determinant);
        concave.join(o.concave);
        openByEdges += o.openByEdges, unordered += o.unordered, multiplyConnected += o.multiplyConnected;
        openness.join(o.openness), aspectRatio.join(o.aspectRatio), volume.join(o.volume);
        determinants.join(o.determinants), fullness.join(o.fullness), hollow.join(o.hollow);
        hollowFaces.insert(hollowFaces.end(), o.hollowFaces.begin(), o.hollowFaces.end());
        shapes.hexahedra += o.shapes.hexahedra, shapes.prisms += o.shapes.prisms,
            shapes.wedges += o.shapes.wedges;
        shapes.pyramids += o.shapes.pyramids, shapes.tetWedges += o.shapes.tetWedges;
        shapes.tetrahedra += o.shapes.tetrahedra, shapes.polyhedra += o.shapes.polyhedra;
        for (const auto& [n, count] : o.polyhedra) polyhedra[n] += count;
        unorderedFaces.insert(unorderedFaces.end(), o.unorderedFaces.begin(), o.unorderedFaces.end());
    }
};

class CellAddressing {
  public:
    explicit CellAddressing(const PolyMesh& mesh) : mesh_(mesh) {}

    // hex: the faces are six quadrilaterals
    void measure(std::int32_t cell, std::span<const std::int32_t> faces, bool hex, CellPart& part);

  private:
    void checkEdges(std::span<const std::int32_t> faces, std::int32_t cell, CellPart& part);
    void checkOrder(std::span<const std::int32_t> faces, std::int32_t cell, CellPart& part);

    const PolyMesh& mesh_;
    CellEdges edges_;
    std::vector<std::pair<std::int32_t, std::int32_t>> scratch_;
};

} // namespace i2b
