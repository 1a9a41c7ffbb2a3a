#include "i2b/quality/cell_addressing.h"
#include "i2b/quality/dictionary_measure.h"
#include "i2b/quality/glances.h"
#include "i2b/quality/measure_steps.h"
#include "i2b/quality/measures.h"

namespace i2b {
namespace {

using Index = std::size_t;
constexpr double tinyLength = 1e-300, beyondAll = 1e300;

// A sixth of the surface (m^2, summed along the axes) over the volume to the power of two thirds, or aspect where that is
// more. The power is costly, and of no account where it clearly leaves the ratio below what is known to be reached.
double roundness(double aspect, double surface, double volume, double known) {
    volume = std::max(tinyDivisor, volume);
    const double floor = std::max(aspect, known) * 0.999;
    const bool below = volume > 1e-90 && surface > 1e-90 &&
                       surface * surface * surface < floor * floor * floor * volume * volume;
    return below ? aspect : std::max(aspect, surface / std::pow(volume, 2.0 / 3.0));
}

void checkClosedness(const Measurement& m, std::span<const std::int32_t> faces,
                     std::span<const FaceShape> shapes, std::int32_t cell, const Directions& directions,
                     CellPart& part) {
    Vec3 sum, sizes;
    for (Index i = 0; i < faces.size(); ++i) {
        const Vec3& area = shapes[i].area;
        if (m.mesh.owner[Index(faces[i])] == cell)
            sum += area;
        else
            sum -= area;
        sizes += Vec3{std::abs(area.x), std::abs(area.y), std::abs(area.z)};
    }
    double openness = 0, least = beyondAll, most = -beyondAll;
    for (int k = 0; k < 3; ++k) {
        openness = std::max(openness, std::abs(sum[k]) / (sizes[k] + tinyDivisor));
        if (!directions.valid[Index(k)]) continue;
        least = std::min(least, sizes[k]);
        most = std::max(most, sizes[k]);
    }
    double aspect = most / (least + tinyDivisor);
    const double surface = 1.0 / 6.0 * (sizes.x + sizes.y + sizes.z);
    const double known = std::min(part.aspectRatio.most, m.limits.aspectRatio);
    if (directions.count == 3) aspect = roundness(aspect, surface, m.moments[Index(cell)].volume, known);
    part.openness.add(openness);
    part.aspectRatio.add(aspect);
    if (openness > m.limits.closedness) part.open.hit(cell, openness);
    if (aspect > m.limits.aspectRatio) part.aspect.hit(cell, aspect);
}

// Does any face centre lie on the outer side of another face's plane, or in it? The angle is compared without
// normalising anything unless it is within rounding of the tolerance.
bool isConcave(const PolyMesh& mesh, std::span<const std::int32_t> faces, std::span<const FaceShape> shapes,
               std::int32_t cell) {
    for (Index f = 0; f < faces.size(); ++f) {
        const double side = mesh.owner[Index(faces[f])] == cell ? 1 : -1;
        const Vec3 area = shapes[f].area * side;
        const double area2 = norm2(area);
        for (Index g = 0; g < faces.size(); ++g) {
            if (g == f) continue;
            const Vec3 d = shapes[g].centre - shapes[f].centre;
            const double along = dot(d, area), size2 = norm2(d);
            if (along < 0 && along * along > (1.01 * planarCosine * planarCosine) * size2 * area2 &&
                size2 * area2 > 1e-200)
                continue;
            const Vec3 normal = divided(area, std::max(std::sqrt(area2), tinyLength));
            if (dot(divided(d, std::max(std::sqrt(size2), tinyLength)), normal) > -planarCosine) return true;
        }
    }
    return false;
}

void storeOrder(Measurement& m, CellPart& total) {
    const PolyMesh& mesh = m.mesh;
    std::int64_t reversed = 0;
    for (Index f = 0; f < mesh.neighbour.size(); ++f)
        if (mesh.owner[f] >= mesh.neighbour[f]) {
            ++reversed;
            total.unorderedFaces.push_back(static_cast<std::int32_t>(f));
        }
    std::vector<std::int32_t>& faces = total.unorderedFaces;
    std::sort(faces.begin(), faces.end());
    faces.erase(std::unique(faces.begin(), faces.end()), faces.end());
    for (const std::int32_t f : faces) m.tallies.upperTriangularFace.hit(f);
    m.report.upperTriangular = reversed == 0 && total.unordered == 0;
    m.report.multiplyConnectedCells = total.multiplyConnected;
}

void store(Measurement& m, CellPart& total, double volumeSum, double determinantSum) {
    QualityReport& r = m.report;
    QualityTallies& t = m.tallies;
    if (m.mesh.cells > 0) {
        r.minVolume = total.volume.least, r.maxVolume = total.volume.most;
        r.maxOpenness = total.openness.most, r.maxAspectRatio = total.aspectRatio.most;
        r.minDeterminant = total.determinants.least,
        r.meanDeterminant = determinantSum / double(m.mesh.cells);
    }
    r.totalVolume = volumeSum;
    r.negativeVolumeCells = total.zeroVolume.count;
    r.openCells = total.open.count, r.highAspectRatioCells = total.aspect.count;
    r.openCellsByEdges = total.openByEdges;
    r.smallDeterminantCells = total.determinant.count, r.concaveCells = total.concave.count;
    r.minFullness = m.mesh.cells > 0 ? total.fullness.least : 0;
    m.hollowCells = std::move(total.hollow), m.hollowFaces = std::move(total.hollowFaces);
    static_cast<CellShapes&>(r.statistics) = total.shapes;
    r.statistics.polyhedraByFaces.assign(total.polyhedra.begin(), total.polyhedra.end());
    t.illegalCells = total.illegal, t.zipUpCells = total.zipUp;
    t.oneInternalFaceCells = total.oneInternal, t.twoInternalFacesCells = total.twoInternal;
    t.nonClosedCells = total.open, t.highAspectRatioCells = total.aspect,
    t.zeroVolumeCells = total.zeroVolume;
    t.underdeterminedCells = total.determinant, t.concaveCells = total.concave;
}

Directions directionsOf(const QualityReport& report) {
    Directions directions;
    directions.count = 0;
    for (int k = 0; k < 3; ++k) {
        directions.valid[Index(k)] = report.geometricDirections[Index(k)] == 1;
        if (directions.valid[Index(k)])
            ++directions.count;
        else
            directions.missing = k;
    }
    return directions;
}

// Cells one after another: what their addressing says of all of them; the geometry of those with six quadrilaterals for
// faces eight at a time, and one by one of those that these leave over.
class CellStretch {
  public:
    // knownAspect: a ratio that cells before these reach
    CellStretch(Measurement& m, const Directions& directions, double dictionaryDeterminant, double knownAspect)
        : m_(m), directions_(directions), fullness_(dictionaryDeterminant), knownAspect_(knownAspect), faceShapes_(m.mesh), addressing_(m.mesh),
          hexes_(m.mesh, m.cellFaces, {m.limits.smallVolume, m.limits.closedness, m.limits.aspectRatio, m.limits.determinant, fullness_}) {}

    // determinants: of the first cell
    void measure(Index begin, Index end, CellPart& part, double* determinants) {
        closer_.clear();
        const auto odd = [&](std::int32_t cell) { closer_.push_back(cell); };
        const auto clear = [&](std::int32_t cell, const HexBatch& batch, Index lane) {
            const double known = std::min(std::max(part.aspectRatio.most, knownAspect_), m_.limits.aspectRatio);
            const double aspect = roundness(batch.aspect[lane], batch.surface[lane], batch.volume[lane], known);
            if (aspect > m_.limits.aspectRatio) return odd(cell);
            m_.moments[Index(cell)] = hexes_.moments(lane);
            determinants[Index(cell) - begin] = batch.determinant[lane];
            part.aspectRatio.add(aspect);
        };
        for (Index c = begin; c < end; ++c) {
            const auto cell = static_cast<std::int32_t>(c);
            const std::span<const std::int32_t> faces = m_.cellFaces[cell];
            if (!m_.outerCells.empty() && m_.outerCells[c] != 0) {
                m_.moments[c] = measureCell(m_.mesh, faces, faceShapes_.of(faces), cell);
                continue;
            }
            const bool hex = hexes_.isHex(faces);
            addressing_.measure(cell, faces, hex, part);
            if (hex && directions_.count == 3) hexes_.add(cell, clear, odd);
            else odd(cell);
        }
        hexes_.finish(clear, odd);
        joinExtremes(part);
        std::sort(closer_.begin(), closer_.end());
        for (const std::int32_t cell : closer_) measureClosely(cell, part, determinants[Index(cell) - begin]);
    }

  private:
    void measureClosely(std::int32_t cell, CellPart& part, double& determinant) {
        const std::span<const std::int32_t> faces = m_.cellFaces[cell];
        const std::span<const FaceShape> shapes = faceShapes_.of(faces);
        CellMoments& moments = m_.moments[Index(cell)];
        moments = measureCell(m_.mesh, faces, shapes, cell);
        part.volume.add(moments.volume);
        if (moments.volume < m_.limits.smallVolume) part.zeroVolume.hit(cell, -moments.volume);
        checkClosedness(m_, faces, shapes, cell, directions_, part);
        determinant = cellDeterminant(m_.mesh, faces, shapes, directions_);
        part.determinants.add(determinant);
        if (determinant < m_.limits.determinant) part.determinant.hit(cell, -determinant);
        if (isConcave(m_.mesh, faces, shapes, cell)) part.concave.hit(cell);
        const double fullness = cellFullness(shapes);
        part.fullness.add(fullness);
        if (!(fullness < fullness_)) return;
        part.hollow.hit(cell, -fullness);
        part.hollowFaces.insert(part.hollowFaces.end(), faces.begin(), faces.end());
    }

    void joinExtremes(CellPart& part) {
        const auto join = [](Extremes& to, const LaneExtremes& from) { to.join({from.leastOfAll(), from.mostOfAll()}); };
        const HexExtremes& e = hexes_.extremes;
        join(part.volume, e.volume), join(part.openness, e.openness);
        join(part.determinants, e.determinant), join(part.fullness, e.fullness);
    }

    Measurement& m_;
    const Directions& directions_;
    double fullness_, knownAspect_;
    CellFaceShapes faceShapes_;
    CellAddressing addressing_;
    HexGlance hexes_;
    std::vector<std::int32_t> closer_;
};

} // namespace

void measureCells(Measurement& m) {
    const auto cells = static_cast<Index>(m.mesh.cells);
    const Directions directions = directionsOf(m.report);
    const double fullness = DictionaryBounds(m.dictionary).determinant;
    m.moments.resize(cells);
    constexpr Index block = Index(1) << 18, held = 2 * block; // values of two blocks at a time
    RawVector<double> determinants(std::min(held, cells));
    double volumeSum = 0, determinantSum = 0;
    CellPart total;
    const auto measure = [&](Index begin, Index end, CellPart& part) {
        CellStretch(m, directions, fullness, total.aspectRatio.most).measure(begin, end, part, &determinants[begin % held]);
    };
    orderedBlocks(cells, block, total, measure, [&](Index begin, Index end) {
        for (Index c = begin; c < end; ++c) {
            volumeSum += m.moments[c].volume;
            determinantSum += determinants[c % held];
        }
    });
    storeOrder(m, total);
    store(m, total, volumeSum, determinantSum);
}

} // namespace i2b
