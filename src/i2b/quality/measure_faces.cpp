#include "i2b/core/flags.h"
#include "i2b/quality/face_measure.h"
#include <array>
#include <numbers>

namespace i2b {
namespace {

using Index = std::size_t;
constexpr double rounding = 1e-15, tinyLength = 1e-150, tinyArea = 1e-300;

// Does every corner clearly turn with the normal? Of two unit vectors the dot product is then far above the
// limit that concavitySine compares it with, which is the rounding error; no roots, no divisions.
template <class Count>
bool clearlyConvex(const Vec3* edge, Count n, const Vec3& area) {
    const double area2 = norm2(area);
    bool convex = true;
    for (Index i = 0; i < n; ++i) {
        const Vec3 turn = cross(edge[i == 0 ? n - 1 : i - 1], edge[i]);
        const double along = dot(turn, area);
        convex = convex && along > 1e-140 && along * along > 1e-16 * norm2(turn) * area2;
    }
    return convex;
}

// Sine of the largest angle at which two consecutive edges turn against the normal; 0: none over the limit.
double concavitySine(const PolyMesh& mesh, std::span<const std::int32_t> v, const Vec3& area, double areaSize,
                     double maxSine) {
    const auto point = [&](Index i) -> const Vec3& { return mesh.points[Index(v[i])]; };
    const Vec3 normal = divided(area, areaSize + tinyLength);
    Vec3 before = point(0) - point(v.size() - 1);
    double beforeLength = norm(before);
    before = divided(before, beforeLength + tinyLength);
    double worst = 0;
    for (Index i = 0; i < v.size(); ++i) {
        Vec3 edge = point(i + 1 == v.size() ? 0 : i + 1) - point(i);
        const double length = norm(edge);
        edge = divided(edge, length + tinyLength);
        if (beforeLength > rounding && length > rounding) {
            const Vec3 turn = cross(before, edge);
            const double sine = norm(turn);
            if (!(sine < maxSine) && dot(divided(turn, sine), normal) < rounding)
                worst = std::max(worst, sine);
        }
        before = edge;
        beforeLength = length;
    }
    return worst;
}

// The face's area over the sum of its triangles' areas around the centre.
template <class Count>
double flatness(const Vec3* point, const Vec3* edge, Count n, const Vec3& centre, double areaSize) {
    double sum = 0;
    for (Index i = 0; i < n; ++i) sum += norm(0.5 * cross(edge[i], centre - point[i]));
    return areaSize / (sum + tinyLength);
}

} // namespace

FaceMeasure::FaceMeasure(Measurement& m, const DictionaryBounds& bounds)
    : m_(m), bounds_(bounds), maxSine_(std::sin(m.limits.concavity * std::numbers::pi / 180)),
      short2_(nearDistanceSquared(m.report.box)) {}

double FaceMeasure::measure(std::int32_t id, FaceShape& shape, FacePart& part, BrokenLimits& broken) {
    const std::span<const std::int32_t> v = m_.mesh.face(id);
    if (v.size() == 4) {
        std::array<Vec3, 4> point, edge;
        return measure(id, v, std::integral_constant<Index, 4>{}, point.data(), edge.data(), shape, part, broken);
    }
    points_.resize(v.size());
    edges_.resize(v.size());
    return measure(id, v, v.size(), points_.data(), edges_.data(), shape, part, broken);
}

template <class Count>
double FaceMeasure::measure(std::int32_t id, std::span<const std::int32_t> v, Count n, Vec3* point, Vec3* edge,
                            FaceShape& shape, FacePart& part, BrokenLimits& broken) {
    for (Index i = 0; i < n; ++i) point[i] = m_.mesh.points[Index(v[i])];
    double shortest2 = std::numeric_limits<double>::infinity();
    for (Index i = 0; i < n; ++i) {
        edge[i] = point[i + 1 == n ? 0 : i + 1] - point[i];
        const double length2 = norm2(edge[i]);
        part.edge2.add(length2);
        shortest2 = std::min(shortest2, length2);
    }
    if (shortest2 < short2_) markShortEdges(v, edge);
    shape = shapeOfPolygon(point, n);
    const double area = norm(shape.area);
    part.area.add(area);
    if (area < m_.limits.faceArea) part.zeroArea.hit(id, -area);
    if (const int repeated = repeatedVertices(v, n); repeated > 0) {
        part.faultyVertices += repeated;
        part.outOfRange.hit(id, repeated);
    }
    if (!clearlyConvex(edge, n, shape.area)) {
        const double sine = concavitySine(m_.mesh, v, shape.area, area, maxSine_);
        part.maxConcaveSine = std::max(part.maxConcaveSine, sine);
        if (sine > rounding) part.concave.hit(id, sine);
        const double severe = bounds_.concavityAsked ? concavitySine(m_.mesh, v, shape.area, area, bounds_.sine) : 0;
        if (severe > 0) broken.add(DictionaryLimit::concavity, severe);
    }
    addFaceLimits(m_.mesh, id, shape, bounds_, broken);
    if (n <= 3 || !(area > tinyArea)) return -1;
    const double value = area > tinyLength ? flatness(point, edge, n, shape.centre, area) : 1.0;
    ++part.flatnessFaces;
    part.flatness.add(value);
    if (value < m_.limits.flatness) part.warped.hit(id, -value);
    return value;
}

void FaceMeasure::markShortEdges(std::span<const std::int32_t> v, const Vec3* edge) {
    for (Index i = 0; i < v.size(); ++i)
        if (norm2(edge[i]) < short2_)
            for (const std::int32_t p : {v[i], v[i + 1 == v.size() ? 0 : i + 1]}) setFlag(m_.shortPoints[Index(p)]);
}

Tally tallyMarks(const std::vector<std::uint8_t>& marks) {
    Tally tally;
    orderedLoop(marks.size(), tally, [&](Index begin, Index end, Tally& part) {
        for (Index i = begin; i < end; ++i)
            if (marks[i] != 0) part.hit(static_cast<std::int32_t>(i));
    });
    return tally;
}

double nearDistanceSquared(const Box& box) { return norm2(1e-6 * box.extent()); }

void storeFaces(Measurement& m, FacePart& total, double flatSum) {
    QualityReport& r = m.report;
    r.minFaceArea = total.area.least, r.maxFaceArea = total.area.most;
    r.faultyFaceVertices = total.faultyVertices;
    r.minEdgeLength = std::sqrt(total.edge2.least), r.maxEdgeLength = std::sqrt(total.edge2.most);
    r.concaveFaces = total.concave.count;
    r.maxConcaveAngle = std::asin(std::min(1.0, total.maxConcaveSine)) * 180 / std::numbers::pi;
    r.flatnessFaces = total.flatnessFaces;
    if (total.flatnessFaces > 0) {
        r.minFaceFlatness = total.flatness.least;
        r.meanFaceFlatness = flatSum / static_cast<double>(total.flatnessFaces);
    }
    r.warpedFaces = total.warped.count;
    r.nearDistance = std::sqrt(nearDistanceSquared(r.box));
    m.tallies.outOfRangeFaces = total.outOfRange;
    m.tallies.zeroAreaFaces = total.zeroArea;
    m.tallies.concaveFaces = total.concave;
    m.tallies.warpedFaces = total.warped;
    m.tallies.shortEdges = tallyMarks(m.shortPoints);
    r.shortEdgePoints = m.tallies.shortEdges.count;
}

} // namespace i2b
