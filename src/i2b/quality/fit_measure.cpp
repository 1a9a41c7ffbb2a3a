#include "i2b/core/parallel.h"
#include "i2b/quality/fit_report.h"
#include "i2b/quality/mesh_geometry.h"
#include <algorithm>
#include <numbers>
#include <tbb/parallel_sort.h>

namespace i2b {
namespace {

constexpr double sharpAngle = 40, creaseAngle = 25; // degrees; of the geometry, of the mesh
constexpr double smallestSize = 1e-100;             // m, so that collapsed faces divide by something

double degreesBetween(const Vec3& a, const Vec3& b) {
    return std::atan2(norm(cross(a, b)), dot(a, b)) * (180 / std::numbers::pi);
}

// ---- the wall
// --------------------------------------------------------------------------------------------------

struct WallEdge {
    std::int32_t a, b, face; // a < b: points of the mesh; face: place in Wall::faces
    friend auto operator<=>(const WallEdge&, const WallEdge&) = default;
};

struct Wall {
    std::vector<std::int32_t> faces;  // of the mesh, ascending
    std::vector<std::int32_t> nodes;  // of the mesh, ascending
    std::vector<WallEdge> edges;      // one for each side of a face, sorted
    std::vector<FaceShape> shapes;    // per face
    std::vector<double> nodeH, faceH; // m
};

bool isChosen(const Patch& patch, const std::vector<std::string>& names) {
    return names.empty() ? patch.type == "wall"
                         : std::find(names.begin(), names.end(), patch.name) != names.end();
}

// The lower one of two: a node pulled away lengthens half the edges around it, and must not be judged by
// those.
double median(std::vector<double>& values) {
    if (values.empty()) return 0;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>((values.size() - 1) / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

std::size_t nodePlace(const Wall& wall, std::int32_t point) {
    return static_cast<std::size_t>(std::lower_bound(wall.nodes.begin(), wall.nodes.end(), point) -
                                    wall.nodes.begin());
}

// Of each face the median of its edges; of each node the median of the faces around it; of each face that of
// its nodes.
void measureSizes(const PolyMesh& mesh, Wall& wall) {
    struct Around {
        std::int32_t node;
        double size; // of a face
        bool operator<(const Around& o) const { return node != o.node ? node < o.node : size < o.size; }
    };
    std::vector<std::size_t> start(wall.faces.size());
    for (std::size_t i = 0; i < start.size(); ++i) start[i] = mesh.face(wall.faces[i]).size();
    std::vector<Around> around(exclusiveScan(start));
    parallelFor(wall.faces.size(), [&](std::size_t i) {
        const auto face = mesh.face(wall.faces[i]);
        std::vector<double> lengths;
        for (std::size_t k = 0; k < face.size(); ++k)
            lengths.push_back(norm(mesh.points[static_cast<std::size_t>(face[(k + 1) % face.size()])] -
                                   mesh.points[static_cast<std::size_t>(face[k])]));
        const double size = std::max(median(lengths), smallestSize);
        for (std::size_t k = 0; k < face.size(); ++k) around[start[i] + k] = {face[k], size};
    });
    tbb::parallel_sort(around);
    for (std::size_t i = 0, end = 0; i < around.size(); i = end) {
        for (end = i; end < around.size() && around[end].node == around[i].node; ++end) {
        }
        wall.nodes.push_back(around[i].node);
        wall.nodeH.push_back(around[i + (end - i - 1) / 2].size);
    }
    wall.faceH.resize(wall.faces.size());
    parallelFor(wall.faces.size(), [&](std::size_t i) {
        std::vector<double> sizes;
        for (const std::int32_t v : mesh.face(wall.faces[i])) sizes.push_back(wall.nodeH[nodePlace(wall, v)]);
        wall.faceH[i] = median(sizes);
    });
}

Wall collectWall(const PolyMesh& mesh, const std::vector<std::string>& patches) {
    Wall wall;
    for (const Patch& patch : mesh.patches)
        if (isChosen(patch, patches))
            for (std::int32_t f = patch.start; f < patch.start + patch.count; ++f) wall.faces.push_back(f);
    std::sort(wall.faces.begin(), wall.faces.end());
    for (std::size_t i = 0; i < wall.faces.size(); ++i) {
        const auto face = mesh.face(wall.faces[i]);
        for (std::size_t k = 0; k < face.size(); ++k) {
            const auto [a, b] = std::minmax(face[k], face[(k + 1) % face.size()]);
            wall.edges.push_back({a, b, static_cast<std::int32_t>(i)});
        }
    }
    tbb::parallel_sort(wall.edges);
    wall.shapes.resize(wall.faces.size());
    parallelFor(wall.faces.size(), [&](std::size_t i) { wall.shapes[i] = measureFace(mesh, wall.faces[i]); });
    measureSizes(mesh, wall);
    return wall;
}

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

Surface sharpSurface(const FeatureGraph& features) {
    Surface s;
    for (const FeatureEdge& e : features.edges)
        if (e.angle >= sharpAngle) addSegment(s, features.points[e.a], features.points[e.b]);
    return s;
}

// ---- distances
// -----------------------------------------------------------------------------------------------

void measureNodes(const PolyMesh& mesh, const Wall& wall, const SurfaceIndex& index, FitReport& report) {
    std::vector<double> distance(wall.nodes.size()); // in h
    parallelFor(wall.nodes.size(), [&](std::size_t i) {
        const Vec3& p = mesh.points[static_cast<std::size_t>(wall.nodes[i])];
        distance[i] = index.closest(p).distance / wall.nodeH[i];
    });
    std::int64_t within0001 = 0, within001 = 0, within01 = 0;
    for (std::size_t i = 0; i < distance.size(); ++i) {
        within0001 += distance[i] <= 0.001;
        within001 += distance[i] <= 0.01;
        within01 += distance[i] <= 0.1;
        if (i > 0 && distance[i] <= report.maxDistanceInH) continue;
        report.maxDistanceInH = distance[i];
        report.farthest = mesh.points[static_cast<std::size_t>(wall.nodes[i])];
    }
    const auto n = static_cast<double>(distance.size());
    report.wallNodesWithin0001h = static_cast<double>(within0001) / n;
    report.wallNodesOnGeometryFraction = static_cast<double>(within001) / n;
    report.wallNodesWithin01h = static_cast<double>(within01) / n;
}

// Unit normal of the geometry at its point closest to q: of the nearest triangle that has one.
Vec3 normalUnder(const SurfaceIndex& index, const ClosestPoint& c, const Vec3& q) {
    if (const Vec3 n = index.normal(c.triangle); norm2(n) > 0) return n;
    const ClosestPoint other = index.closest(q, std::numeric_limits<double>::infinity(),
                                             [&](std::uint32_t t) { return norm2(index.normal(t)) > 0; });
    return other ? index.normal(other.triangle) : Vec3{};
}

void measureFaces(const Wall& wall, const SurfaceIndex& index, const SurfaceIndex& sharp, FitReport& report) {
    struct Sums {
        double distance = 0;
        std::int64_t smooth = 0, tilted = 0, tilted45 = 0;
    };
    const auto body = [&](std::size_t begin, std::size_t end) {
        Sums s;
        for (std::size_t i = begin; i < end; ++i) {
            const Vec3 centre = wall.shapes[i].centre, normal = normalized(wall.shapes[i].area);
            const ClosestPoint c = index.closest(centre);
            s.distance += c.distance / wall.faceH[i];
            if (sharp.closest(centre, wall.faceH[i])) continue;
            ++s.smooth;
            const Vec3 under = normalUnder(index, c, centre);
            double angle = degreesBetween(normal, under);
            if (norm2(normal) == 0 || norm2(under) == 0) angle = 0;
            angle = std::min(angle, 180 - angle);
            s.tilted += angle > 25;
            s.tilted45 += angle > 45;
        }
        return s;
    };
    const auto join = [](const Sums& a, const Sums& b) {
        return Sums{a.distance + b.distance, a.smooth + b.smooth, a.tilted + b.tilted,
                    a.tilted45 + b.tilted45};
    };
    const Sums s = orderedReduce(wall.faces.size(), Sums{}, body, join, 512);
    report.meanDistanceInH = s.distance / static_cast<double>(wall.faces.size());
    if (s.smooth == 0) return;
    report.tiltedFaceFraction = static_cast<double>(s.tilted) / static_cast<double>(s.smooth);
    report.tilted45FaceFraction = static_cast<double>(s.tilted45) / static_cast<double>(s.smooth);
}

// ---- capture
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

void measureCapture(const Surface& sharpEdges, const SurfaceIndex& sharp, const Reach& reach,
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

FitReport measureFit(const PolyMesh& mesh, const SurfaceIndex& index, const FeatureGraph& features,
                     const std::vector<std::string>& patches) {
    FitReport report;
    const Wall wall = collectWall(mesh, patches);
    report.wallFaces = static_cast<std::int64_t>(wall.faces.size());
    report.wallNodes = static_cast<std::int64_t>(wall.nodes.size());
    if (wall.faces.empty() || index.surface().triangles.empty()) return report;

    const Surface sharpEdges = sharpSurface(features);
    const SurfaceIndex sharp(sharpEdges);
    measureNodes(mesh, wall, index, report);
    measureFaces(wall, index, sharp, report);
    measurePartBorders(mesh, index, report);
    if (sharpEdges.triangles.empty()) return report;

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
    measureCapture(sharpEdges, sharp, {wallIndex, faceOf, wall.faceH, largestH}, std::move(pieces),
                   SurfaceIndex(creases), report);
    return report;
}

} // namespace i2b
