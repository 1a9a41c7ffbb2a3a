// The samples of the geometry's sharp edges by which a wall is judged (fit_report.h), and which of them it has captured; anew for those at
// a part of the wall whose points have moved. Captured ones are among them whether they count or not: that takes longest to find out.
#pragma once
#include "i2b/geometry/surface_index.h"
#include "i2b/quality/fit_wall.h"
#include "i2b/quality/line_capture.h"
#include "i2b/quality/wall_folds.h"

namespace i2b {

inline constexpr double capturedWithin = 0.1; // of h: so near to a sample is an edge of the wall where it folds

// Of samples of sharpEdges those that count: no edge that ends inside another part is one that a wall could have, nor one where the geometry
// goes straight on. Keeps references.
LineAsk sharpThatCount(const Wall& wall, const SurfaceIndex& index, const Surface& sharpEdges);

class SharpSamples {
  public:
    using Faces = std::vector<std::int32_t>; // of the wall, by their places here, ascending

    // Keeps a reference to mesh; of all its patches of type wall. features: as for measureFit(). index: of the geometry. h: m, the size of most
    // of the wall.
    SharpSamples(const PolyMesh& mesh, const Rows& cellFaces, const FeatureGraph& features, const SurfaceIndex& index, double h);

    const Surface& edges() const { return edges_; } // as triangles without area: LostSample::line is a place among them
    const std::vector<LostSample>& samples() const { return samples_; } // by the faces that they are at
    bool isCaptured(std::size_t sample) const { return captured_[sample] != 0; }
    // Of the faces near sharp edges, which are all that are known here.
    std::int32_t meshFace(std::int32_t face) const { return wall_.faces[static_cast<std::size_t>(face)]; }

    std::vector<std::uint32_t> at(const Faces& faces) const; // samples, ascending
    // With the points where they are now. Samples and sizes stay.
    void judge(const std::vector<std::uint32_t>& samples);
    // Those faces and further rings of such as share a point.
    Faces grown(Faces faces, int rings) const;

  private:
    bool folds(std::size_t edge) const;

    const PolyMesh& mesh_;
    Wall wall_;
    Surface edges_;
    std::vector<LostSample> samples_;
    std::vector<std::uint8_t> captured_;
    std::vector<std::pair<std::int32_t, std::int32_t>> facesAt_; // points of the mesh and faces that use them, ascending
    RawVector<WallEnd> ends_;
};

} // namespace i2b
