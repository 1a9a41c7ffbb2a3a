#include "i2b/quality/face_measure.h"
#include "i2b/quality/glances.h"
#include "i2b/quality/measures.h"
#include "i2b/quality/tet_quality.h"
#include <numbers>

namespace i2b {
namespace {

using Index = std::size_t;
constexpr double rounding = 1e-15;
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
        const double least = m_.shown ? 0 : std::min(part.skewness.most, leastSkewness_); // less is not asked for
        const double skew = faceSkewness(mesh_, id, shape, own.centre, neiCentre, least);
        if (m_.shown && neiCentre) m_.shown->addPair(mesh_.owner[f], mesh_.neighbour[f], values->ortho, skew);
        if (m_.shown && !neiCentre) m_.shown->addBoundary(mesh_.owner[f], skew);
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
            if (m_.shown) m_.shown->addPair(m_.mesh.owner[f], m_.mesh.neighbour[f], batch.ortho[lane], batch.skewness[lane]);
        };
        for (Index f = begin; f < end; ++f) {
            flat[f - begin] = -1;
            if (!m_.outerFaces.empty() && m_.outerFaces[f] != 0) {
                if (f < m_.mesh.neighbour.size()) values[f - begin] = {};
                continue;
            }
            if (!quads_.add(f, clear, odd)) odd(f);
        }
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
    constexpr Index block = Index(1) << 18, held = 2 * block; // values of two blocks at a time
    RawVector<PairValues> values(std::min(held, faces));
    RawVector<double> flat(values.size());
    Sums sum;
    FacesPart total;
    const auto measure = [&](Index begin, Index end, FacesPart& part) {
        FaceStretch(m, bounds, faceCells, quads).measure(begin, end, part, &flat[begin % held], &values[begin % held]);
    };
    orderedBlocks(faces, block, total, measure, [&](Index begin, Index end) {
        for (Index f = begin; f < end; ++f)
            if (flat[f % held] >= 0) sum.flat += flat[f % held];
        for (Index f = begin; f < std::min(end, internal); ++f) {
            sum.ortho += values[f % held].ortho;
            sum.weight += values[f % held].weight;
            sum.ratio += values[f % held].ratio;
        }
    });
    storeFaces(m, total.alone, sum.flat);
    storeFaceCells(m, total.withCells, sum);
    const std::int32_t worst = m.hollowCells.worstId;
    storeDictionary(m.mesh, m.dictionary, total.withCells.dictionary, m.hollowCells, std::move(m.hollowFaces),
                    worst < 0 ? Vec3{} : m.moments[Index(worst)].centre, m.report);
}

} // namespace i2b
