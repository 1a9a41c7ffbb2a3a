#include "i2b/quality/face_measure.h"
#include "i2b/quality/glances.h"
#include "i2b/quality/measures.h"
#include <numbers>

namespace i2b {
namespace {

using Index = std::size_t;
constexpr double rounding = 1e-15, largestRadius = 1e15, beyondAll = 1e300;
constexpr double tetTolerance = rounding * rounding;

struct FaceCellPart {
    Tally nonOrtho, wrongOriented, skew, lowWeight, lowVolRatio, lowQualityTets;
    std::int64_t severe = 0, orthoErrors = 0, pyramidErrors = 0, tetErrors = 0;
    Extremes ortho, skewness, weight, ratio;
    DictionaryPart dictionary;

    void join(const FaceCellPart& o) {
        nonOrtho.join(o.nonOrtho), wrongOriented.join(o.wrongOriented), skew.join(o.skew);
        lowWeight.join(o.lowWeight), lowVolRatio.join(o.lowVolRatio), lowQualityTets.join(o.lowQualityTets);
        severe += o.severe, orthoErrors += o.orthoErrors, pyramidErrors += o.pyramidErrors,
            tetErrors += o.tetErrors;
        ortho.join(o.ortho), skewness.join(o.skewness), weight.join(o.weight), ratio.join(o.ratio);
        dictionary.join(o.dictionary);
    }
};

// Volume over that of the regular tetrahedron in the same circumsphere; negative where inverted. With p, q, r
// the edges at a, the vector to the circumcentre is (|p|^2 q x r + |q|^2 r x p + |r|^2 p x q) / (2 p . q x
// r).
double tetQuality(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    const double regularVolume = 8.0 / (9.0 * std::sqrt(3.0)); // in the unit sphere
    const Vec3 p = b - a, q = c - a, r = d - a;
    const Vec3 pq = cross(p, q);
    const double sixfold = dot(pq, r);
    double radius = largestRadius;
    if (std::abs(sixfold) >= tinyDivisor) {
        const Vec3 toCentre = norm2(p) * cross(q, r) + norm2(q) * cross(r, p) + norm2(r) * pq;
        radius = std::min(radius, norm(toCentre) / (2 * std::abs(sixfold)));
    }
    return sixfold / 6 / (regularVolume * radius * radius * radius + tinyDivisor);
}

// Tetrahedra are poor whose quality is not over a tolerance. With D six times the volume and L the longest edge at one
// corner, the circumradius is at most 2.5 L^4/|D|, hence |quality| > |D|^4/(49 L^12); where D^2/L^6 is over shape, the size of
// the quality is clearly over the tolerance.
struct TetTolerance {
    explicit TetTolerance(double value) : quality(value), shape(value < 0 ? beyondAll : std::max(1e-12, 7.1 * std::sqrt(value))) {}

    // Sign of the quality where a glance settles that its size is over the tolerance, else 0.
    int clearSign(double sixfoldVolume, double longest2) const {
        const double d2 = sixfoldVolume * sixfoldVolume;
        if (!(d2 > shape * longest2 * longest2 * longest2) || !(d2 > 1e-280)) return 0;
        return sixfoldVolume > 0 ? 1 : -1;
    }

    double quality, shape;
};

// The fan of triangles from vertex base, with its apex at the cell's centre: no tetrahedron at or below the
// tolerance? (Equivalent to: the least quality is over it.)
bool fanIsGood(const PolyMesh& mesh, std::span<const std::int32_t> v, Index base, const Vec3& apex,
               bool owner, const TetTolerance& tolerance) {
    const Vec3& p0 = mesh.points[Index(v[base])];
    double least = beyondAll;
    for (Index i = 1; i + 1 < v.size(); ++i) {
        const Vec3* a = &mesh.points[Index(v[(i + base) % v.size()])];
        const Vec3* b = &mesh.points[Index(v[(i + base + 1) % v.size()])];
        if (!owner) std::swap(a, b);
        const Vec3 e0 = p0 - apex, ea = *a - apex, eb = *b - apex;
        const int sign = tolerance.clearSign(dot(cross(e0, ea), eb), std::max({norm2(e0), norm2(ea), norm2(eb)}));
        if (sign < 0) return false;
        if (sign == 0) least = std::min(least, tetQuality(apex, p0, *a, *b));
        if (!(least > tolerance.quality)) return false;
    }
    return true;
}

// Does any vertex serve as base of a good fan, as seen from the owner and, inside the mesh, from the
// neighbour?
bool hasGoodBase(const PolyMesh& mesh, std::span<const std::int32_t> v, const Vec3& owner,
                 const Vec3* neighbour, const TetTolerance& tolerance) {
    for (Index base = 0; base < v.size(); ++base)
        if (fanIsGood(mesh, v, base, owner, true, tolerance) &&
            (neighbour == nullptr || fanIsGood(mesh, v, base, *neighbour, false, tolerance)))
            return true;
    return false;
}

// The tetrahedra over the triangles around the face's centre: is any not clearly on the apex's side? side is
// -1 for the owner, whose tetrahedra are negative, 1 for the neighbour.
bool hasBadTet(const PolyMesh& mesh, std::span<const std::int32_t> v, const Vec3& faceCentre,
               const Vec3& apex, int side, const TetTolerance& tolerance) {
    for (Index i = 0; i < v.size(); ++i) {
        const Vec3& a = mesh.points[Index(v[i])];
        const Vec3& b = mesh.points[Index(v[i + 1 == v.size() ? 0 : i + 1])];
        const Vec3 ab = b - a, ac = faceCentre - a, ad = apex - a;
        const int sign = tolerance.clearSign(dot(cross(ab, ac), ad), std::max({norm2(ab), norm2(ac), norm2(ad)}));
        if (sign == side) continue;
        if (sign == -side) return true;
        const double quality = tetQuality(a, b, faceCentre, apex);
        if (side > 0 ? quality < tolerance.quality : quality > -tolerance.quality) return true;
    }
    return false;
}

// A glance at all tetrahedra of a face at once: are those over the triangles around its centre, and those of
// the fan from its first vertex, all clearly on their cell's side? Then the face has no errors. No edge of
// such a tetrahedron is longer than twice the larger of the reaches from the face's centre to its vertices
// and to the apex. Worked out from the centre, so that both sides share the cross products.
bool tetsClearlyGood(const PolyMesh& mesh, std::span<const std::int32_t> v, const Vec3& faceCentre,
                     const Vec3& owner, const Vec3* neighbour, const TetTolerance& tolerance) {
    const Vec3 toOwner = owner - faceCentre;
    const Vec3 toNeighbour = neighbour != nullptr ? *neighbour - faceCentre : -toOwner;
    double reach2 = std::max(norm2(toOwner), norm2(toNeighbour));
    double least = beyondAll; // of the sixfold volumes
    const Vec3 first = mesh.points[Index(v[0])] - faceCentre;
    Vec3 here = first;
    for (Index i = 1; i <= v.size(); ++i) {
        const Vec3 next = i == v.size() ? first : mesh.points[Index(v[i])] - faceCentre;
        reach2 = std::max(reach2, norm2(next));
        const Vec3 area = cross(here, next);
        least = std::min(least, std::min(-dot(area, toOwner), dot(area, toNeighbour)));
        if (i > 1 && i < v.size()) {
            const Vec3 fan = cross(here - first, next - first);
            least = std::min(least, std::min(dot(fan, first - toOwner), dot(fan, toNeighbour - first)));
        }
        here = next;
    }
    return least > 0 && tolerance.clearSign(least, 4 * reach2) > 0;
}

int tetErrors(const PolyMesh& mesh, std::span<const std::int32_t> v, const Vec3& faceCentre,
              const Vec3& owner, const Vec3* neighbour, const TetTolerance& tolerance) {
    if (tolerance.quality >= 0 && tetsClearlyGood(mesh, v, faceCentre, owner, neighbour, tolerance)) return 0;
    int errors = hasBadTet(mesh, v, faceCentre, owner, -1, tolerance) ? 1 : 0;
    if (neighbour != nullptr && hasBadTet(mesh, v, faceCentre, *neighbour, 1, tolerance)) ++errors;
    if (!hasGoodBase(mesh, v, owner, neighbour, tolerance)) ++errors;
    return errors;
}

class FaceCells {
  public:
    FaceCells(const Measurement& m, const DictionaryBounds& bounds)
        : m_(m), mesh_(m.mesh), bounds_(bounds), internal_(Index(m.mesh.internalFaces())),
          severeCosine_(std::cos(m.limits.nonOrthogonality * std::numbers::pi / 180)), tets_(tetTolerance),
          dictionaryTets_(bounds.tetQuality),
          leastSkewness_(std::min({m.limits.skewness, bounds.internalSkewness, bounds.boundarySkewness})) {}

    // values: where the face is internal. broken: what the face breaks alone.
    void measure(Index f, const FaceShape& shape, FaceCellPart& part, PairValues* values, BrokenLimits& broken) const {
        const auto id = static_cast<std::int32_t>(f);
        const CellMoments& own = m_.moments[static_cast<Index>(mesh_.owner[f])];
        const Vec3* neiCentre = nullptr;
        double leastPyramid = dot(shape.area, shape.centre - own.centre);
        int wrong = leastPyramid / 3 < -rounding ? 1 : 0;
        if (f < internal_) {
            const CellMoments& nei = m_.moments[static_cast<Index>(mesh_.neighbour[f])];
            neiCentre = &nei.centre;
            const double pyramid = dot(shape.area, nei.centre - shape.centre);
            if (pyramid / 3 < -rounding) ++wrong;
            leastPyramid = std::min(leastPyramid, pyramid);
            *values = pairValues(shape, own, nei);
            judge(id, *values, part);
            judge(*values, own, nei, broken);
        }
        if (leastPyramid / 3 < bounds_.pyramidVolume) broken.add(DictionaryLimit::pyramidVolume, -leastPyramid);
        const double least = std::min(part.skewness.most, leastSkewness_); // less is not asked for
        const double skew = faceSkewness(mesh_, id, shape, own.centre, neiCentre, least);
        part.pyramidErrors += wrong;
        if (wrong > 0) part.wrongOriented.hit(id, -leastPyramid);
        part.skewness.add(skew);
        if (skew > m_.limits.skewness) part.skew.hit(id, skew);
        if (skew > (neiCentre ? bounds_.internalSkewness : bounds_.boundarySkewness))
            broken.add(neiCentre ? DictionaryLimit::internalSkewness : DictionaryLimit::boundarySkewness, skew);
        const int errors = tetErrors(mesh_, mesh_.face(id), shape.centre, own.centre, neiCentre, tets_);
        part.tetErrors += errors;
        if (errors > 0) part.lowQualityTets.hit(id, -leastPyramid);
        if (bounds_.tetsAsked && tetErrors(mesh_, mesh_.face(id), shape.centre, own.centre, neiCentre, dictionaryTets_) > 0)
            broken.add(DictionaryLimit::tetQuality, -leastPyramid);
        addTwist(mesh_, id, shape, (neiCentre ? *neiCentre : shape.centre) - own.centre, bounds_, broken);
        if (broken.any()) part.dictionary.hit(id, broken);
    }

    QuadBounds quadBounds(double shortEdge2) const {
        return {.shortEdge2 = shortEdge2,
                .faceArea = std::max(m_.limits.faceArea, bounds_.faceArea),
                .flatness = m_.limits.flatness,
                .spread = std::max(0.0, bounds_.flatness * (1 + margin)),
                .cosine = std::max(severeCosine_, bounds_.cosine),
                .weight = std::max(m_.limits.faceWeight, bounds_.faceWeight),
                .ratio = std::max(m_.limits.volumeRatio, bounds_.volumeRatio),
                .skewness = leastSkewness_,
                .pyramid3 = std::max(0.0, 3 * bounds_.pyramidVolume * (1 + margin)),
                .tetShape = std::max(tets_.shape, bounds_.tetQuality > 0 ? dictionaryTets_.shape : 0),
                .twist = std::max(-2.0, bounds_.twist),
                .triangleTwist = std::max(-2.0, bounds_.triangleTwist)};
    }

  private:
    void judge(std::int32_t id, const PairValues& values, FaceCellPart& part) const {
        if (values.ortho < severeCosine_) {
            ++(values.ortho > rounding ? part.severe : part.orthoErrors);
            part.nonOrtho.hit(id, -values.ortho);
        }
        if (values.weight < m_.limits.faceWeight) part.lowWeight.hit(id, -values.weight);
        if (values.ratio < m_.limits.volumeRatio) part.lowVolRatio.hit(id, -values.ratio);
        part.ortho.add(values.ortho), part.weight.add(values.weight), part.ratio.add(values.ratio);
    }

    // by the dictionary
    void judge(const PairValues& values, const CellMoments& own, const CellMoments& nei, BrokenLimits& broken) const {
        if (values.ortho < bounds_.cosine) broken.add(DictionaryLimit::nonOrthogonality, -values.ortho);
        if (values.weight < bounds_.faceWeight) broken.add(DictionaryLimit::faceWeight, -values.weight);
        const double sizes[2] = {std::abs(own.volume), std::abs(nei.volume)};
        const double ratio = std::min(sizes[0], sizes[1]) / (std::max(sizes[0], sizes[1]) + 1e-300);
        if (ratio < bounds_.volumeRatio) broken.add(DictionaryLimit::volumeRatio, -ratio);
    }

    static constexpr double margin = 1e-6; // a glance leaves what is nearer a limit to a closer look
    const Measurement& m_;
    const PolyMesh& mesh_;
    const DictionaryBounds& bounds_;
    Index internal_;
    double severeCosine_;
    TetTolerance tets_, dictionaryTets_;
    double leastSkewness_;
};

struct FacesPart {
    FacePart alone;
    FaceCellPart withCells;
    void join(const FacesPart& o) { alone.join(o.alone), withCells.join(o.withCells); }
};

// Faces one after another: quadrilaterals inside the mesh eight at a time, and one by one what these leave over.
class FaceStretch {
  public:
    FaceStretch(Measurement& m, const DictionaryBounds& dictionary, const FaceCells& faceCells, const QuadBounds& bounds)
        : m_(m), faceCells_(faceCells), alone_(m, dictionary), quads_(m.mesh, m.moments.data(), bounds) {}

    // flat, values: of the first face; flat -1 of faces that have none, values of internal faces only
    void measure(Index begin, Index end, FacesPart& part, double* flat, PairValues* values) {
        closer_.clear();
        const auto odd = [&](Index f) { closer_.push_back(f); };
        const auto clear = [&](Index f, const QuadBatch& batch, Index lane) {
            flat[f - begin] = batch.flat[lane];
            values[f - begin] = {batch.ortho[lane], batch.weight[lane], batch.ratio[lane]};
            ++part.alone.flatnessFaces;
        };
        for (Index f = begin; f < end; ++f)
            if (!quads_.add(f, clear, odd)) odd(f);
        quads_.finish(clear, odd);
        joinExtremes(part);
        std::sort(closer_.begin(), closer_.end());
        for (const Index f : closer_) {
            FaceShape shape;
            BrokenLimits broken;
            flat[f - begin] = alone_.measure(static_cast<std::int32_t>(f), shape, part.alone, broken);
            faceCells_.measure(f, shape, part.withCells, &values[f - begin], broken);
        }
    }

  private:
    void joinExtremes(FacesPart& part) {
        const auto join = [](Extremes& to, const LaneExtremes& from) { to.join({from.leastOfAll(), from.mostOfAll()}); };
        const QuadExtremes& e = quads_.extremes;
        join(part.alone.edge2, e.edge2), join(part.alone.area, e.area);
        join(part.alone.flatness, e.flatness), join(part.withCells.ortho, e.ortho);
        join(part.withCells.weight, e.weight), join(part.withCells.ratio, e.ratio);
        join(part.withCells.skewness, e.skewness);
        quads_.extremes = {};
    }

    Measurement& m_;
    const FaceCells& faceCells_;
    FaceMeasure alone_;
    QuadGlance quads_;
    std::vector<Index> closer_;
};

double degrees(double cosine) {
    return std::acos(std::min(1.0, std::max(-1.0, cosine))) * 180 / std::numbers::pi;
}

struct Sums {
    double flat = 0, ortho = 0, weight = 0, ratio = 0;
};

void storeFaceCells(Measurement& m, const FaceCellPart& total, const Sums& sum) {
    QualityReport& r = m.report;
    if (m.mesh.internalFaces() > 0) {
        const auto n = static_cast<double>(m.mesh.internalFaces());
        r.maxNonOrthogonality = degrees(total.ortho.least);
        r.meanNonOrthogonality = degrees(sum.ortho / n);
        r.minFaceWeight = total.weight.least, r.meanFaceWeight = sum.weight / n;
        r.minVolumeRatio = total.ratio.least, r.meanVolumeRatio = sum.ratio / n;
    }
    r.severeNonOrthogonalFaces = total.severe;
    r.nonOrthogonalityErrors = total.orthoErrors;
    r.wrongOrientedFaces = total.pyramidErrors;
    r.maxSkewness = m.mesh.faces() > 0 ? total.skewness.most : 0;
    r.highlySkewFaces = total.skew.count;
    r.lowWeightFaces = total.lowWeight.count;
    r.lowVolumeRatioFaces = total.lowVolRatio.count;
    r.tetErrors = total.tetErrors;
    m.tallies.nonOrthoFaces = total.nonOrtho;
    m.tallies.wrongOrientedFaces = total.wrongOriented;
    m.tallies.skewFaces = total.skew;
    m.tallies.lowWeightFaces = total.lowWeight;
    m.tallies.lowVolRatioFaces = total.lowVolRatio;
    m.tallies.lowQualityTetFaces = total.lowQualityTets;
}

} // namespace

// Faces alone and with their cells in one pass, so that nothing of them need be kept.
void measureFaces(Measurement& m) {
    const auto faces = static_cast<Index>(m.mesh.faces()),
               internal = static_cast<Index>(m.mesh.internalFaces());
    m.shortPoints.assign(m.mesh.points.size(), 0);
    const DictionaryBounds bounds(m.dictionary);
    const FaceCells faceCells(m, bounds);
    const QuadBounds quads = faceCells.quadBounds(nearDistanceSquared(m.report.box));
    constexpr Index block = Index(1) << 17;
    std::vector<PairValues> values(std::min(block, faces));
    std::vector<double> flat(values.size());
    Sums sum;
    FacesPart total;
    const auto measure = [&](Index begin, Index end, FacesPart& part) {
        FaceStretch(m, bounds, faceCells, quads).measure(begin, end, part, &flat[begin % block], &values[begin % block]);
    };
    orderedBlocks(faces, block, total, measure, [&](Index begin, Index end) {
        for (Index f = begin; f < end; ++f)
            if (flat[f - begin] >= 0) sum.flat += flat[f - begin];
        for (Index f = begin; f < std::min(end, internal); ++f) {
            sum.ortho += values[f - begin].ortho;
            sum.weight += values[f - begin].weight;
            sum.ratio += values[f - begin].ratio;
        }
    });
    storeFaces(m, total.alone, sum.flat);
    storeFaceCells(m, total.withCells, sum);
    const std::int32_t worst = m.hollowCells.worstId;
    storeDictionary(m.mesh, m.dictionary, total.withCells.dictionary, m.hollowCells, std::move(m.hollowFaces),
                    worst < 0 ? Vec3{} : m.moments[Index(worst)].centre, m.report);
}

} // namespace i2b
