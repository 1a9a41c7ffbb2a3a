#include "i2b/quality/measure_steps.h"
#include <atomic>
#include <numbers>

namespace i2b {
namespace {

using Index = std::size_t;
constexpr double rounding = 1e-15, tinyLength = 1e-150, tinyArea = 1e-300;

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

void mark(std::vector<std::uint8_t>& marks, std::int32_t i) {
    std::atomic_ref<std::uint8_t>(marks[Index(i)]).store(1, std::memory_order_relaxed);
}

int repeatedVertices(std::span<const std::int32_t> v) {
    int repeated = 0;
    for (Index i = 1; i < v.size(); ++i)
        for (Index j = 0; j < i; ++j)
            if (v[i] == v[j]) {
                ++repeated;
                break;
            }
    return repeated;
}

// Does every corner clearly turn with the normal? Of two unit vectors the dot product is then far above the
// limit that concavitySine compares it with, which is the rounding error; no roots, no divisions.
bool clearlyConvex(const PolyMesh& mesh, std::span<const std::int32_t> v, const Vec3& area) {
    const auto point = [&](Index i) -> const Vec3& { return mesh.points[Index(v[i])]; };
    const double area2 = norm2(area);
    Vec3 before = point(0) - point(v.size() - 1);
    for (Index i = 0; i < v.size(); ++i) {
        const Vec3 edge = point(i + 1 == v.size() ? 0 : i + 1) - point(i);
        const Vec3 turn = cross(before, edge);
        const double along = dot(turn, area);
        if (!(along > 0 && along * along > 1e-16 * norm2(turn) * area2 && along > 1e-140)) return false;
        before = edge;
    }
    return true;
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
double flatness(const PolyMesh& mesh, std::span<const std::int32_t> v, const Vec3& centre, double areaSize) {
    double sum = 0;
    for (Index i = 0; i < v.size(); ++i) {
        const Vec3& here = mesh.points[Index(v[i])];
        const Vec3& next = mesh.points[Index(v[i + 1 == v.size() ? 0 : i + 1])];
        sum += norm(0.5 * cross(next - here, centre - here));
    }
    return areaSize / (sum + tinyLength);
}

} // namespace

Tally tallyMarks(const std::vector<std::uint8_t>& marks) {
    Tally tally;
    orderedLoop(marks.size(), tally, [&](Index begin, Index end, Tally& part) {
        for (Index i = begin; i < end; ++i)
            if (marks[i] != 0) part.hit(static_cast<std::int32_t>(i));
    });
    return tally;
}

double nearDistanceSquared(const Box& box) { return norm2(1e-6 * box.extent()); }

void measureFaces(Measurement& m) {
    const PolyMesh& mesh = m.mesh;
    const auto faces = static_cast<Index>(mesh.faces());
    const double maxSine = std::sin(m.limits.concavity * std::numbers::pi / 180);
    const double short2 = nearDistanceSquared(m.report.box);
    m.geometry.faceCentre.resize(faces);
    m.geometry.faceArea.resize(faces);
    m.shortPoints.assign(mesh.points.size(), 0);
    constexpr Index block = Index(1) << 18;
    std::vector<double> flat(std::min(block, faces));
    double flatSum = 0;
    FacePart total;
    const auto measure = [&](Index begin, Index end, FacePart& part) {
        for (Index f = begin; f < end; ++f) {
            const auto id = static_cast<std::int32_t>(f);
            const std::span<const std::int32_t> v = mesh.face(id);
            const FaceShape shape = measureFace(mesh, id);
            m.geometry.faceCentre[f] = shape.centre;
            m.geometry.faceArea[f] = shape.area;
            const double area = norm(shape.area);
            part.area.add(area);
            if (area < m.limits.faceArea) part.zeroArea.hit(id, -area);
            if (const int repeated = repeatedVertices(v); repeated > 0) {
                part.faultyVertices += repeated;
                part.outOfRange.hit(id, repeated);
            }
            for (Index i = 0; i < v.size(); ++i) {
                const std::int32_t a = v[i], b = v[i + 1 == v.size() ? 0 : i + 1];
                const double length2 = norm2(mesh.points[Index(a)] - mesh.points[Index(b)]);
                part.edge2.add(length2);
                if (length2 < short2) mark(m.shortPoints, a), mark(m.shortPoints, b);
            }
            const double sine =
                clearlyConvex(mesh, v, shape.area) ? 0 : concavitySine(mesh, v, shape.area, area, maxSine);
            part.maxConcaveSine = std::max(part.maxConcaveSine, sine);
            if (sine > rounding) part.concave.hit(id, sine);
            flat[f % block] = -1;
            if (v.size() > 3 && area > tinyArea) {
                const double value = area > tinyLength ? flatness(mesh, v, shape.centre, area) : 1.0;
                flat[f % block] = value;
                ++part.flatnessFaces;
                part.flatness.add(value);
                if (value < m.limits.flatness) part.warped.hit(id, -value);
            }
        }
    };
    orderedBlocks(faces, block, total, measure, [&](Index begin, Index end) {
        for (Index i = 0; i < end - begin; ++i)
            if (flat[i] >= 0) flatSum += flat[i];
    });
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
    r.nearDistance = std::sqrt(short2);
    m.tallies.outOfRangeFaces = total.outOfRange;
    m.tallies.zeroAreaFaces = total.zeroArea;
    m.tallies.concaveFaces = total.concave;
    m.tallies.warpedFaces = total.warped;
    m.tallies.shortEdges = tallyMarks(m.shortPoints);
    r.shortEdgePoints = m.tallies.shortEdges.count;
}

} // namespace i2b
