// Quality cell by cell, for looking at: the worst of each cell's faces.
#pragma once
#include "i2b/assemble/mesh_topology.h"
#include "i2b/quality/mesh_geometry.h"
#include <vector>

namespace i2b {

struct CellQuality {                     // one value per cell each
    std::vector<float> nonOrthogonality; // degrees, over internal faces
    std::vector<float> skewness;
    std::vector<float> volume;           // m^3
};

// What measureQuality() has worked out of single cells on its way, for whoever asks.
struct CellFigures {
    bool wantsQuality = true;
    Rows faces{};          // buildCellFaces()
    CellQuality quality{}; // if wanted; else empty
};

// Gathers the worst of each cell's faces; faces may come in any order and from any thread.
class CellQualityMaker {
  public:
    explicit CellQualityMaker(const RawVector<CellMoments>& moments);
    void addPair(std::int32_t own, std::int32_t nei, double cosine, double skewness); // an internal face, between two cells
    void addBoundary(std::int32_t own, double skewness);
    CellQuality take();

  private:
    CellQuality quality_; // until take(): one less the least cosine, not degrees
};

} // namespace i2b
