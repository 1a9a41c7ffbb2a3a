#include "i2b/quality/line_capture.h"
#include "i2b/core/parallel.h"
#include "i2b/core/quantile.h"
#include <algorithm>
#include <array>

namespace i2b {
namespace {

constexpr double inwards = 0.3; // of the way to the face's centre
constexpr std::array overWall{0.3, 1.0}; // of h: what is seen from neither height over the wall is hidden,
constexpr double hiddenBy = 0.05;        // of h: if it lies so far behind what is seen

// The wall within reach of the lines, in triangles around the face centres (as OpenFOAM's areas are); faceOf tells
// each triangle's face. The rest of a wall would cost more memory than all else here, and nothing asks for it.
Surface wallSurface(const PolyMesh& mesh, const Wall& wall, const SurfaceIndex& lines, double reach, std::vector<std::uint32_t>& faceOf) {
    const auto point = [&](std::int32_t v) { return mesh.points[static_cast<std::size_t>(v)]; };
    std::vector<std::uint8_t> near(wall.faces.size());
    parallelFor(near.size(), [&](std::size_t i) {
        double radius = 0;
        for (const std::int32_t v : mesh.face(wall.faces[i])) radius = std::max(radius, norm(point(v) - wall.shapes[i].centre));
        near[i] = bool(lines.closest(wall.shapes[i].centre, reach + radius));
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

struct Reach {
    const SurfaceIndex& wall;
    const std::vector<std::uint32_t>& faceOf;
    const std::vector<double>& faceH;
    double largestH;

    // The wall nearest to p within radius; face: -1 if there is none.
    WallPlace at(const Vec3& p, double radius) const {
        const ClosestPoint c = wall.closest(p, radius);
        if (!c) return {};
        const std::uint32_t face = faceOf[c.triangle];
        return {static_cast<std::int32_t>(face), faceH[face], c.distance, c.point};
    }
};

// A straight bit of a line, short enough to have one h.
struct Piece {
    std::uint32_t line; // triangle of the surface of lines
    double from, to;    // m along it
    double spacing = 0; // m, h / 4; 0: no wall near
    double first = 0;   // samples due before it
};

struct Sample {
    std::uint32_t line;
    Vec3 point;
};

std::vector<Piece> cutPieces(const Surface& lines, double length) {
    std::vector<Piece> pieces;
    for (std::uint32_t i = 0; i < lines.triangles.size(); ++i) {
        const auto& t = lines.triangles[i];
        const double l = norm(lines.points[t[1]] - lines.points[t[0]]);
        const int n = std::clamp(static_cast<int>(std::min(l / length, 1e6)) + 1, 1, 10000);
        for (int k = 0; k < n; ++k) pieces.push_back({i, l * k / n, l * (k + 1) / n});
    }
    return pieces;
}

// The spacing runs on from line to line in their order, so that many short ones get as many samples as a long one,
// wherever their points are.
std::vector<Sample> placeSamples(const Surface& lines, const Reach& reach, std::vector<Piece> pieces) {
    const auto at = [&](const Piece& p, double along) {
        const auto& t = lines.triangles[p.line];
        const Vec3& a = lines.points[t[0]];
        return a + normalized(lines.points[t[1]] - a) * along;
    };
    parallelFor(
        pieces.size(),
        [&](std::size_t i) {
            Piece& p = pieces[i];
            p.spacing = reach.at(at(p, (p.from + p.to) / 2), reach.largestH / 2 + (p.to - p.from)).h / 4;
        },
        32);
    std::vector<Sample> samples;
    double due = 0.5; // half a spacing before the first
    for (const Piece& p : pieces) {
        if (p.spacing <= 0) continue;
        const double after = due + (p.to - p.from) / p.spacing;
        for (double k = std::floor(due) + 1; k <= after; ++k)
            samples.push_back({p.line, at(p, p.from + (k - due) * p.spacing)});
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

// Do all lines within h of a sample stay within 0.1 h of its own?
bool isResolvable(const Surface& lines, const SurfaceIndex& index, const Sample& s, double h) {
    const auto ends = [&](std::uint32_t line) {
        const auto& t = lines.triangles[line];
        return std::pair{lines.points[t[0]], lines.points[t[1]]};
    };
    const auto [a, b] = ends(s.line);
    const Vec3 direction = normalized(b - a), r{h, h, h};
    return !index.any({s.point - r, s.point + r}, [&](std::uint32_t other) {
        const auto [c, d] = ends(other);
        return leavesLine(s.point, direction, h, 0.1 * h, c, d);
    });
}

} // namespace

Vec3 flowOver(const Wall& wall, const WallPlace& at, double height) {
    const FaceShape& face = wall.shapes[std::size_t(at.face)];
    return at.point + (face.centre - at.point) * inwards - normalized(face.area) * height;
}

bool isSeenFrom(const SurfaceIndex& index, const Vec3& flow, const Vec3& place, double lastBit) {
    const double far = norm(place - flow);
    return far > 0 && !index.firstHit(flow, place, 1 - lastBit / far);
}

std::optional<Vec3> flowThatSees(const Wall& wall, const SurfaceIndex& index, const WallPlace& at, const Vec3& sample) {
    for (const double height : overWall) {
        const Vec3 flow = flowOver(wall, at, height * at.h);
        if (isSeenFrom(index, flow, sample, hiddenBy * at.h)) return flow;
    }
    return {};
}

void addSegment(Surface& s, const Vec3& a, const Vec3& b) {
    const auto n = static_cast<std::uint32_t>(s.points.size());
    s.points.push_back(a);
    s.points.push_back(b);
    s.triangles.push_back({n, n + 1, n + 1});
    s.partOf.push_back(0);
}

LineSamples captureLines(const PolyMesh& mesh, const Wall& wall, const Surface& lines, const SurfaceIndex& lineIndex, const LineAsk& counts,
                         const LineAsk& isCaptured) {
    if (lines.triangles.empty()) return {};
    std::vector<double> sizes = wall.faceH;
    const double largestH = *std::max_element(sizes.begin(), sizes.end());
    const double small = quantile(sizes, 0.05); // a few slivers must not set the length of the pieces
    std::vector<Piece> pieces = cutPieces(lines, small / 2); // the shorter, the less of the wall is in their reach
    double farthest = 0;
    for (const Piece& p : pieces) farthest = std::max(farthest, largestH / 2 + (p.to - p.from));
    std::vector<std::uint32_t> faceOf;
    const Surface wallTriangles = wallSurface(mesh, wall, lineIndex, 1.001 * farthest, faceOf);
    const SurfaceIndex wallIndex(wallTriangles);
    const Reach reach{wallIndex, faceOf, wall.faceH, largestH};
    const std::vector<Sample> samples = placeSamples(lines, reach, std::move(pieces));
    const auto body = [&](std::size_t begin, std::size_t end) {
        LineSamples n;
        for (std::size_t i = begin; i < end; ++i) {
            const Sample& s = samples[i];
            const WallPlace at = reach.at(s.point, largestH / 2);
            if (at.face < 0 || at.distance > at.h / 2 || !isResolvable(lines, lineIndex, s, at.h) || !counts(s.point, s.line, at)) continue;
            ++n.samples;
            if (!isCaptured(s.point, s.line, at)) n.lost.push_back({s.point, s.line, at});
        }
        return n;
    };
    const auto join = [](LineSamples a, const LineSamples& b) {
        a.samples += b.samples;
        a.lost.insert(a.lost.end(), b.lost.begin(), b.lost.end());
        return a;
    };
    return orderedReduce(samples.size(), LineSamples{}, body, join, 128);
}

} // namespace i2b
