// The limits of OpenFOAM's mesh quality dictionary, face by face. Definitions are those of checkMesh -meshQuality, v1912.
#pragma once
#include "i2b/quality/measures.h"
#include "i2b/quality/quality_report.h"
#include "i2b/quality/tally.h"
#include <array>

namespace i2b {

// In the order in which checkMesh asks.
enum class DictionaryLimit : std::uint8_t {
    nonOrthogonality,
    pyramidVolume,
    tetQuality,
    concavity,
    faceArea,
    internalSkewness,
    boundarySkewness,
    faceWeight,
    volumeRatio,
    twist,
    triangleTwist,
    flatness,
    determinant
};
inline constexpr std::size_t dictionaryLimitCount = 13;

// The limits as they are compared with; those that are not asked can be met by anything.
struct DictionaryBounds {
    explicit DictionaryBounds(const DictionaryLimits& limits);

    double cosine, pyramidVolume, tetQuality, sine, faceArea, internalSkewness, boundarySkewness, faceWeight, volumeRatio;
    double twist, triangleTwist, flatness, determinant;
    bool concavityAsked, tetsAsked, flatnessAsked;
};

// Which limits a face breaks.
class BrokenLimits {
  public:
    void add(DictionaryLimit limit, double badness) {
        badness_[std::size_t(limit)] = badness;
        bits_ |= 1U << unsigned(limit);
    }
    bool any() const { return bits_ != 0; }
    bool has(std::size_t limit) const { return (bits_ >> limit & 1U) != 0; }
    double badness(std::size_t limit) const { return badness_[limit]; }

  private:
    unsigned bits_ = 0;
    std::array<double, dictionaryLimitCount> badness_;
};

// Of a stretch of faces.
struct DictionaryPart {
    std::array<Tally, dictionaryLimitCount> broken; // faces
    std::array<std::int64_t, dictionaryLimitCount> first{}; // those that break none listed before
    std::vector<std::int32_t> faces; // that break any, ascending

    void hit(std::int32_t face, const BrokenLimits& limits);
    void join(const DictionaryPart& next);
};

// Limits of a face alone: its triangles around the centre. Concavity is asked where angles are measured.
void addFaceLimits(const PolyMesh& mesh, std::int32_t face, const FaceShape& shape, const DictionaryBounds& bounds,
                   BrokenLimits& broken);
// Does a triangle lean from the direction across, or along the line from the owner where there is no neighbour?
void addTwist(const PolyMesh& mesh, std::int32_t face, const FaceShape& shape, const Vec3& across,
              const DictionaryBounds& bounds, BrokenLimits& broken);

// Everything into report.dictionary. cells: over the limit of determinants; cellFaces: their faces, in any order.
void storeDictionary(const PolyMesh& mesh, const DictionaryLimits& limits, const DictionaryPart& faces, const Tally& cells,
                     std::vector<std::int32_t> cellFaces, const Vec3& worstCell, QualityReport& report);

} // namespace i2b
