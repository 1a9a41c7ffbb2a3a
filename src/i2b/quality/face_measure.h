// What there is to say of a face alone, one by one: measureFaces() asks it on its way over the faces.
#pragma once
#include "i2b/quality/dictionary_measure.h"
#include "i2b/quality/measure_steps.h"
#include <algorithm>

namespace i2b {

// How many of a face's n vertices it has had before. n: of any type, a constant for faces of a kind.
template <class Count>
inline int repeatedVertices(std::span<const std::int32_t> v, Count n) {
    int repeated = 0;
    for (std::size_t i = 1; i < n; ++i)
        for (std::size_t j = 0; j < i; ++j)
            if (v[i] == v[j]) {
                ++repeated;
                break;
            }
    return repeated;
}

struct FacePart {
    Tally outOfRange, zeroArea, warped, concave;
    std::int64_t faultyVertices = 0, flatnessFaces = 0;
    Extremes area, flatness, edge2;
    double maxConcaveSine = 0;

    void join(const FacePart& o) {
        outOfRange.join(o.outOfRange), zeroArea.join(o.zeroArea), warped.join(o.warped),
            concave.join(o.concave);
        faultyVertices += o.faultyVertices, flatnessFaces += o.flatnessFaces;
        area.join(o.area), flatness.join(o.flatness), edge2.join(o.edge2);
        maxConcaveSine = std::max(maxConcaveSine, o.maxConcaveSine);
    }
};

class FaceMeasure {
  public:
    FaceMeasure(Measurement& m, const DictionaryBounds& bounds); // marks m.shortPoints

    // Returns the flatness, or -1 of a face that has none; shape is filled, limits that the face alone breaks are added.
    double measure(std::int32_t id, FaceShape& shape, FacePart& part, BrokenLimits& broken);

  private:
    template <class Count>
    double measure(std::int32_t id, std::span<const std::int32_t> v, Count n, Vec3* point, Vec3* edge,
                   FaceShape& shape, FacePart& part, BrokenLimits& broken);
    void markShortEdges(std::span<const std::int32_t> v, const Vec3* edge);

    Measurement& m_;
    const DictionaryBounds& bounds_;
    double maxSine_, short2_;
    std::vector<Vec3> points_, edges_;
};

void storeFaces(Measurement& m, FacePart& total, double flatSum);

} // namespace i2b
