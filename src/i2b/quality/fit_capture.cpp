// How much of the geometry's sharp edges the wall has captured.
#include "i2b/core/parallel.h"
#include "i2b/quality/fit_wall.h"
#include <algorithm>
#include <numbers>

namespace i2b {
namespace {

// ---- surfaces to ask for distances
// -------------------------------------------------------------------------------

// Segments as triangles without area, which the index takes like any other.
void addSegment(Surface& s, const Vec3& a, const Vec3& b) {
    const auto n = static_cast<std::uint32_t>(s.points.size());
    s.points.push_back(a);
    s.points.push_back(b);
    s.triangles.push_back({n, n + 1, n + 1});
    s.partOf.push_back(0);
}

// The wall within reach of the sharp edges, in triangles around the face centres (as OpenFOAM's areas are); faceOf tells
// each triangle's face. The rest of a wall would cost more memory than all else here, and nothing asks for it.
Surface wallSurface(const PolyMesh& mesh, const Wall& wall, const SurfaceIndex& sharp, double reach,
                    std::vector<std::uint32_t>& faceOf) {
    const auto point = [&](std::int32_t v) { return mesh.points[static_cast<std::size_t>(v)]; };
    std::vector<std::uint8_t> near(wall.faces.size());
    parallelFor(near.size(), [&](std::size_t i) {
        double radius = 0;
        for (const std::int32_t v : mesh.face(wall.faces[i])) radius = std::max(radius, norm(point(v) - wall.shapes[i].centre));
        near[i] = bool(sharp.closest(wall.shapes[i].centre, reach + radius));
    });
    Surface s;
    for (std::size_t i = 0; i < wall.faces.size(); ++i) {
        if (!near[i]) continue;
        const auto face = mesh.face(wall.faces[i]);
        const auto first = static_cast<std::uint32_t>(s.points.size()), n = static_cast<std::uint32_t>(face.size());
        for (const std::int32_t v : face) s.points.push_back(point(v));
        s.points.push_back(wall.shapes[i].centre);
        for (std::uint32_t k = 0; k < n; ++k) {
            s.triangles.push_back({first + k, first + (k + 1) % n, first + n});
            s.partOf.push_back(0);
            faceOf.push_back(static_cast<std::uint32_t>(i));
        }
    }
    return s;
}

// Edges of the wall where two of its faces fold by more than the crease angle.
Surface creaseSurface(const PolyMesh& mesh, const Wall& wall) {
    Surface s;
    for (std::size_t i = 0, end = 0; i < wall.edges.size(); i = end) {
        const WallEdge& e = wall.edges[i];
        bool folded = false;
        for (end = i; end < wall.edges.size() && wall.edges[end].a == e.a && wall.edges[end].b == e.b; ++end)
            for (std::size_t k = i; k < end; ++k) {
                const Vec3& m = wall.shapes[static_cast<std::size_t>(wall.edges[k].face)].area;
                const Vec3& n = wall.shapes[static_cast<std::size_t>(wall.edges[end].face)].area;
                folded |= norm2(m) > 0 && norm2(n) > 0 && degreesBetween(m, n) > creaseAngle;
            }
        if (folded)
            addSegment(s, mesh.points[static_cast<std::size_t>(e.a)],
                       mesh.points[static_cast<std::size_t>(e.b)]);
    }
    return s;
}

// ---- samples
// -----------------------------------------------------------------------------------------------------

struct Reach {
    const SurfaceIndex& wall;
    const std::vector<std::uint32_t>& faceOf;
    const std::vector<double>& faceH;
    double largestH;

    // h of the wall nearest to p within radius, 0 if there is none; distance to it.
    double sizeAt(const Vec3& p, double radius, double& distance) const {
        const ClosestPoint c = wall.closest(p, radius);
        distance = c.distance;
        return c ? faceH[faceOf[c.triangle]] : 0;
    }
};

// A straight bit of a sharp edge, short enough to have one h.
struct Piece {
    std::uint32_t edge; // triangle of the surface of sharp edges
    double from, to;    // m along it
    double spacing = 0; // m, h / 4; 0: no wall near
    double first = 0;   // samples due before it
};

struct Sample {
    std::uint32_t edge;
    Vec3 point;
};

std::vector<Piece> cutPieces(const Surface& sharp, double length) {
    std::vector<Piece> pieces;
    for (std::uint32_t i = 0; i < sharp.triangles.size(); ++i) {
        const auto& t = sharp.triangles[i];
        const double l = norm(sharp.points[t[1]] - sharp.points[t[0]]);
        const int n = std::clamp(static_cast<int>(std::min(l / length, 1e6)) + 1, 1, 10000);
        for (int k = 0; k < n; ++k) pieces.push_back({i, l * k / n, l * (k + 1) / n});
    }
    return pieces;
}

// The spacing runs on from edge to edge in their order, so that a line of many short edges gets as many
// samples as one long edge, wherever its points are.
std::vector<Sample> placeSamples(const Surface& sharp, const Reach& reach, std::vector<Piece> pieces) {
    const auto at = [&](const Piece& p, double along) {
        const auto& t = sharp.triangles[p.edge];
        const Vec3& a = sharp.points[t[0]];
        return a + normalized(sharp.points[t[1]] - a) * along;
    };
    parallelFor(
        pieces.size(),
        [&](std::size_t i) {
            Piece& p = pieces[i];
            double distance = 0;
            p.spacing =
                reach.sizeAt(at(p, (p.from + p.to) / 2), reach.largestH / 2 + (p.to - p.from), distance) / 4;
        },
        32);
    std::vector<Sample> samples;
    double due = 0.5; // half a spacing before the first
    for (const Piece& p : pieces) {
        if (p.spacing <= 0) continue;
        const double after = due + (p.to - p.from) / p.spacing;
        for (double k = std::floor(due) + 1; k <= after; ++k)
            samples.push_back({p.edge, at(p, p.from + (k - due) * p.spacing)});
        due = after;
    }
    return samples;
}

// The ball of radius h about p holds a bit of the segment that is farther than tolerance from the line p,
// direction.
bool leavesLine(const Vec3& p, const Vec3& direction, double h, double tolerance, const Vec3& a,
                const Vec3& b) {
    const Vec3 d = b - a, m = a - p;
    const double dd = norm2(d), md = dot(m, d), c = norm2(m) - h * h;
    double t0 = 0, t1 = 1;
    if (dd > 0) {
        const double root = md * md - dd * c;
        if (root < 0) return false;
        t0 = std::max(0.0, (-md - std::sqrt(root)) / dd);
        t1 = std::min(1.0, (-md + std::sqrt(root)) / dd);
        if (t0 > t1) return false;
    } else if (c > 0) {
        return false;
    }
    for (const double t : {t0, t1}) { // the distance to a line is convex: largest at an end
        const Vec3 x = m + d * t;
        if (norm(x - direction * dot(x, direction)) > tolerance) return true;
    }
    return false;
}

void countCaptured(const Surface& sharpEdges, const SurfaceIndex& sharp, const Reach& reach,
                   std::vector<Piece> pieces, const SurfaceIndex& creases, FitReport& report) {
    const std::vector<Sample> samples = placeSamples(sharpEdges, reach, std::move(pieces));
    const auto ends = [&](std::uint32_t edge) {
        const auto& t = sharpEdges.triangles[edge];
        return std::pair{sharpEdges.points[t[0]], sharpEdges.points[t[1]]};
    };
    const auto resolvable = [&](const Sample& s, double h) {
        const auto [a, b] = ends(s.edge);
        const Vec3 direction = normalized(b - a), r{h, h, h};
        for (const std::uint32_t other : sharp.candidates({s.point - r, s.point + r})) {
            const auto [c, d] = ends(other);
            if (leavesLine(s.point, direction, h, 0.1 * h, c, d)) return false;
        }
        return true;
    };
    struct Counts {
        std::int64_t samples = 0, captured = 0;
    };
    const auto body = [&](std::size_t begin, std::size_t end) {
        Counts n;
        for (std::size_t i = begin; i < end; ++i) {
            double distance = 0;
            const double h = reach.sizeAt(samples[i].point, reach.largestH / 2, distance);
            if (h <= 0 || distance > h / 2 || !resolvable(samples[i], h)) continue;
            ++n.samples;
            n.captured += bool(creases.closest(samples[i].point, 0.1 * h));
        }
        return n;
    };
    const auto join = [](const Counts& a, const Counts& b) {
        return Counts{a.samples + b.samples, a.captured + b.captured};
    };
    const Counts n = orderedReduce(samples.size(), Counts{}, body, join, 128);
    report.featureSamples = n.samples;
    if (n.samples > 0)
        report.featureCaptureFraction = static_cast<double>(n.captured) / static_cast<double>(n.samples);
}

} // namespace

double degreesBetween(const Vec3& a, const Vec3& b) {
    return std::atan2(norm(cross(a, b)), dot(a, b)) * (180 / std::numbers::pi);
}

Surface sharpSurface(const FeatureGraph& features) {
    Surface s;
    for (const FeatureEdge& e : features.edges)
        if (e.angle >= sharpAngle) addSegment(s, features.points[e.a], features.points[e.b]);
    return s;
}

void measureCapture(const PolyMesh& mesh, const Wall& wall, const Surface& sharpEdges, const SurfaceIndex& sharp, FitReport& report) {
    std::vector<double> sizes = wall.faceH;
    std::sort(sizes.begin(), sizes.end());
    const double largestH = sizes.back();
    // A few slivers must not set the length of the pieces.
    std::vector<Piece> pieces = cutPieces(sharpEdges, 2 * sizes[sizes.size() / 20]);
    double reach = 0;
    for (const Piece& p : pieces) reach = std::max(reach, largestH / 2 + (p.to - p.from));
    std::vector<std::uint32_t> faceOf;
    const Surface wallTriangles = wallSurface(mesh, wall, sharp, 1.001 * reach, faceOf);
    const SurfaceIndex wallIndex(wallTriangles);
    const Surface creases = creaseSurface(mesh, wall);
    countCaptured(sharpEdges, sharp, {wallIndex, faceOf, wall.faceH, largestH}, std::move(pieces),
                  SurfaceIndex(creases), report);
}

} // namespace i2b
