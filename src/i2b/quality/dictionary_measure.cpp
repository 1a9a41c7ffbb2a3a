#include "i2b/quality/dictionary_measure.h"
#include <algorithm>
#include <numbers>
#include <span>

namespace i2b {
namespace {

using Index = std::size_t;
constexpr double never = -std::numeric_limits<double>::infinity(), huge = 1e15, rounding = 1e-15, tinyArea = 1e-300;

double cosineOf(double degrees) { return degrees < 180 - rounding ? std::cos(degrees * std::numbers::pi / 180) : never; }
double least(double limit, bool asked) { return asked ? limit : never; }

// Twice the triangles between a face's edges and its centre; body(triangle, size) until it returns false.
template <class Body>
void forTriangles(const PolyMesh& mesh, std::span<const std::int32_t> v, const Vec3& centre, const Body& body) {
    for (Index i = 0; i < v.size(); ++i) {
        const Vec3& a = mesh.points[Index(v[i])];
        const Vec3& b = mesh.points[Index(v[i + 1 == v.size() ? 0 : i + 1])];
        const Vec3 triangle = 0.5 * cross(b - a, centre - a);
        if (!body(triangle, norm(triangle))) return;
    }
}

// Least cosine between the normals of consecutive triangles, round to the first one that has any area. Where cosines
// over 0 are wanted a triangle without area is as bad as one turned over.
double leastTriangleCosine(const PolyMesh& mesh, std::span<const std::int32_t> v, const Vec3& centre, bool needsArea) {
    double worst = std::numeric_limits<double>::infinity();
    Vec3 first, before;
    bool any = false;
    forTriangles(mesh, v, centre, [&](const Vec3& triangle, double size) {
        if (size > tinyArea) {
            const Vec3 unit = divided(triangle, size);
            if (any) worst = std::min(worst, dot(before, unit));
            if (!any) first = unit;
            any = true;
            before = unit;
        } else if (needsArea) {
            worst = -1;
        }
        return true;
    });
    return any ? std::min(worst, dot(before, first)) : std::numeric_limits<double>::infinity();
}

} // namespace

DictionaryBounds::DictionaryBounds(const DictionaryLimits& d)
    : cosine(cosineOf(d.nonOrthogonality)), pyramidVolume(least(d.pyramidVolume, d.pyramidVolume > -huge)),
      tetQuality(least(d.tetQuality, d.tetQuality > -huge)), sine(std::sin(d.concavity * std::numbers::pi / 180)),
      faceArea(least(d.faceArea, d.faceArea > -rounding)), internalSkewness(d.internalSkewness),
      boundarySkewness(d.boundarySkewness), faceWeight(least(d.faceWeight, d.faceWeight >= 0 && d.faceWeight < 1)),
      volumeRatio(least(d.volumeRatio, d.volumeRatio >= 0)), twist(least(d.twist, d.twist > -1)),
      triangleTwist(least(d.triangleTwist, d.triangleTwist > -1)), flatness(least(d.flatness, d.flatness > -rounding)),
      determinant(least(d.determinant, d.determinant > -1)), concavityAsked(d.concavity < 180 - rounding),
      tetsAsked(d.tetQuality > -huge), flatnessAsked(d.flatness > -rounding) {
    if (!(internalSkewness > 0 || boundarySkewness > 0)) internalSkewness = boundarySkewness = -never;
}

void DictionaryPart::hit(std::int32_t face, const BrokenLimits& limits) {
    bool before = false;
    for (Index k = 0; k < dictionaryLimitCount; ++k) {
        if (!limits.has(k)) continue;
        broken[k].hit(face, limits.badness(k));
        if (!before) ++first[k];
        before = true;
    }
    if (before) faces.push_back(face);
}

void DictionaryPart::join(const DictionaryPart& next) {
    for (Index k = 0; k < dictionaryLimitCount; ++k) {
        broken[k].join(next.broken[k]);
        first[k] += next.first[k];
    }
    faces.insert(faces.end(), next.faces.begin(), next.faces.end());
}

void addFaceLimits(const PolyMesh& mesh, std::int32_t face, const FaceShape& shape, const DictionaryBounds& bounds,
                   BrokenLimits& broken) {
    const double area = norm(shape.area);
    if (area < bounds.faceArea) broken.add(DictionaryLimit::faceArea, -area);
    const std::span<const std::int32_t> v = mesh.face(face);
    if (v.size() <= 3) return;
    if (bounds.triangleTwist > never) {
        const double cosine = leastTriangleCosine(mesh, v, shape.centre, bounds.triangleTwist > 0);
        if (cosine < bounds.triangleTwist) broken.add(DictionaryLimit::triangleTwist, -cosine);
    }
    if (!bounds.flatnessAsked) return;
    double sum = 0;
    forTriangles(mesh, v, shape.centre, [&](const Vec3&, double size) { return sum += size, true; });
    if (sum / area < bounds.flatness) broken.add(DictionaryLimit::flatness, -sum / area);
}

void addTwist(const PolyMesh& mesh, std::int32_t face, const FaceShape& shape, const Vec3& across,
              const DictionaryBounds& bounds, BrokenLimits& broken) {
    const std::span<const std::int32_t> v = mesh.face(face);
    const double size = norm(across);
    if (v.size() <= 3 || !(bounds.twist > never) || size < tinyDivisor) return;
    const Vec3 direction = divided(across, size);
    double worst = std::numeric_limits<double>::infinity();
    forTriangles(mesh, v, shape.centre, [&](const Vec3& triangle, double area) {
        if (area > tinyArea) worst = std::min(worst, dot(direction, divided(triangle, area)));
        return true;
    });
    if (worst < bounds.twist) broken.add(DictionaryLimit::twist, -worst);
}

void storeDictionary(const PolyMesh& mesh, const DictionaryLimits& d, const DictionaryPart& faces, const Tally& cells,
                     std::vector<std::int32_t> cellFaces, const Vec3& worstCell, QualityReport& report) {
    const DictionaryBounds bounds(d);
    const bool skewnessAsked = bounds.internalSkewness < huge || bounds.boundarySkewness < huge;
    struct Entry {
        const char* key;
        double limit;
        bool asked;
    };
    const std::array<Entry, dictionaryLimitCount> entries{{
        {"maxNonOrtho", d.nonOrthogonality, bounds.cosine > never},
        {"minVol", d.pyramidVolume, bounds.pyramidVolume > never},
        {"minTetQuality", d.tetQuality, bounds.tetsAsked},
        {"maxConcave", d.concavity, bounds.concavityAsked},
        {"minArea", d.faceArea, bounds.faceArea > never},
        {"maxInternalSkewness", d.internalSkewness, skewnessAsked},
        {"maxBoundarySkewness", d.boundarySkewness, skewnessAsked},
        {"minFaceWeight", d.faceWeight, bounds.faceWeight > never},
        {"minVolRatio", d.volumeRatio, bounds.volumeRatio > never},
        {"minTwist", d.twist, bounds.twist > never},
        {"minTriangleTwist", d.triangleTwist, bounds.triangleTwist > never},
        {"minFaceFlatness", d.flatness, bounds.flatnessAsked},
        {"minDeterminant", d.determinant, bounds.determinant > never},
    }};
    for (Index k = 0; k < entries.size(); ++k) {
        const Tally& broken = faces.broken[k];
        DictionaryCheck& check = report.dictionary.emplace_back();
        check.key = entries[k].key, check.limit = entries[k].limit, check.asked = entries[k].asked;
        check.faces = broken.count, check.newFaces = faces.first[k];
        if (broken.worstId >= 0) check.worst = measureFace(mesh, broken.worstId).centre;
    }
    std::sort(cellFaces.begin(), cellFaces.end());
    cellFaces.erase(std::unique(cellFaces.begin(), cellFaces.end()), cellFaces.end());
    std::vector<std::int32_t> fresh;
    std::set_difference(cellFaces.begin(), cellFaces.end(), faces.faces.begin(), faces.faces.end(), std::back_inserter(fresh));
    DictionaryCheck& determinant = report.dictionary.back();
    determinant.cells = cells.count, determinant.worst = worstCell;
    determinant.faces = static_cast<std::int64_t>(cellFaces.size());
    determinant.newFaces = static_cast<std::int64_t>(fresh.size());
    report.dictionaryFaces = static_cast<std::int64_t>(faces.faces.size() + fresh.size());
    const auto first = [](const std::vector<std::int32_t>& ids) { return std::span(ids).first(std::min(ids.size(), Tally::idLimit)); };
    std::ranges::set_union(first(faces.faces), first(fresh), std::back_inserter(report.dictionaryIds));
    report.dictionaryIds.resize(std::min(report.dictionaryIds.size(), Tally::idLimit));
    report.dictionaryLimits = d;
}

} // namespace i2b
