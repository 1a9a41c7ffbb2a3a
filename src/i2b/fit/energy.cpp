#include "i2b/core/parallel.h"
#include "i2b/fit/corner.h"
#include "i2b/fit/wall_views.h"
#include "i2b/fit/local_corners.h"
#include <Eigen/Dense>
#include <algorithm>
#include <array>

namespace i2b {
namespace {

// weight * sum (normal . (b - point) / h)^2 over one normal for a surface, two for a line, three for a point.
struct WallTerm {
    double weight = 0;
    int planes = 0;
    std::array<Vec3, 3> normal;
    std::array<double, 3> offset{}; // normal . (b - point) / h at the node's present place
    double inverseH = 1;

    void add(const Vec3& n, const Vec3& way) {
        normal[static_cast<std::size_t>(planes)] = n;
        offset[static_cast<std::size_t>(planes++)] = dot(n, way) * inverseH;
    }
    double residual(int i, const Vec3& d) const {
        return offset[static_cast<std::size_t>(i)] + dot(normal[static_cast<std::size_t>(i)], d) * inverseH;
    }
};

// Draws a front node that stands behind geometry back to the flow's side.
WallTerm wayOut(const Band& band, const SurfaceIndex& index, const Positions& x, std::size_t n, double weight) {
    WallTerm term;
    const std::size_t i = n - band.walls;
    const SegmentHit hit = index.firstHit(band.inside[i], x[n]);
    if (!hit) return term;
    term.inverseH = 1 / band.h[n];
    term.weight = weight;
    const Vec3 way = x[n] - band.inside[i];
    term.add(normalized(way), way * (1 - 0.7 * hit.t));
    return term;
}

// The plane of a wall node's target, or the line or point that it is snapped to.
WallTerm wallTerm(WallViews& views, const FeatureIndex& features, const Snap& snap, const Positions& x,
                  std::size_t n, double weight) {
    const double h = views.band().h[n];
    WallTerm term;
    term.inverseH = 1 / h;
    term.weight = weight;
    if (snap.kind == SnapKind::none) {
        const WallTarget& target = views.target(n, x);
        if (target.found) term.add(target.normal, x[n] - target.point);
        return term;
    }
    const FeatureIndex::Line line = snapLine(views.index(), features, snap, x[n], h);
    const Vec3 way = x[n] - line.point;
    if (snap.kind == SnapKind::corner) {
        term.add({1, 0, 0}, way), term.add({0, 1, 0}, way), term.add({0, 0, 1}, way);
        return term;
    }
    const Vec3 axis = std::abs(line.tangent.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
    const Vec3 u = normalized(cross(line.tangent, axis));
    term.add(u, way), term.add(cross(line.tangent, u), way);
    return term;
}

double energyAt(LocalCorners& corners, const WallTerm& wall, const Vec3& d) {
    double sum = corners.energy(d);
    for (int i = 0; i < wall.planes; ++i) {
        const double r = wall.residual(i, d);
        sum += wall.weight * r * r;
    }
    return sum;
}

// At the move that energyAt() was asked for last.
Derivatives derivativesAt(const LocalCorners& corners, const WallTerm& wall, const Vec3& d) {
    Derivatives sum = corners.derivatives(d);
    for (int i = 0; i < wall.planes; ++i) {
        const Vec3 n = wall.normal[static_cast<std::size_t>(i)] * wall.inverseH;
        sum.gradient += n * (2 * wall.weight * wall.residual(i, d));
        sum.addOuter(n, 2 * wall.weight);
    }
    return sum;
}

// The move of one node: a few Newton steps, each capped and halved until the energy falls.
Vec3 bestMove(LocalCorners& corners, const WallTerm& wall, std::uint8_t outside, double cap, int steps) {
    Vec3 d;
    double energy = energyAt(corners, wall, d);
    for (int step = 0; step < steps; ++step) {
        const Derivatives at = derivativesAt(corners, wall, d);
        Eigen::Vector3d gradient(at.gradient.x, at.gradient.y, at.gradient.z);
        Eigen::Matrix3d hessian;
        hessian << at.hessian[0], at.hessian[1], at.hessian[2], at.hessian[1], at.hessian[3], at.hessian[4], at.hessian[2], at.hessian[4], at.hessian[5];
        for (int axis = 0; axis < 3; ++axis) { // nodes in a side of the domain stay there
            if (!(outside >> (2 * axis) & 3)) continue;
            gradient[axis] = 0;
            hessian.row(axis).setZero();
            hessian.col(axis).setZero();
            hessian(axis, axis) = 1;
        }
        Eigen::Vector3d s = -hessian.ldlt().solve(gradient);
        if (!s.allFinite() || s.dot(gradient) > 0) s = -gradient;
        const double length = s.norm();
        if (!(length > 0)) break;
        if (length > cap) s *= cap / length;
        bool moved = false;
        for (int half = 0; half < 8; ++half, s *= 0.5) {
            const Vec3 to = d + Vec3{s[0], s[1], s[2]};
            const double e = energyAt(corners, wall, to);
            if (!(e < energy)) continue;
            d = to, energy = e, moved = true;
            break;
        }
        if (!moved || s.norm() < 5e-3 * cap) break;
    }
    return d;
}

struct Floor { // the wall's pull on a node, weakened while its prism corners are poor
    double factor = 1;
    void update(double worst, double limit) {
        if (worst < limit) factor *= 0.1;
        else if (worst > 1.5 * limit) factor = std::min(1.0, factor * 10);
    }
};

// Would the way from f to b newly cross geometry?
bool crosses(const SurfaceIndex& index, const Vec3& f, const Vec3& b, double h) {
    const double length = norm(b - f), off = 0.05 * h;
    if (!(length > off)) return false;
    const SegmentHit hit = index.firstHit(f, b, 1 - off / length + 1e-9);
    return hit && (1 - hit.t) * length > off;
}

bool pathsStayFree(const Band& band, const SurfaceIndex& index, const Positions& x, std::size_t n, const Vec3& to) {
    if (n < band.walls) {
        const Vec3& f = x[static_cast<std::size_t>(band.frontNode[n])];
        return !crosses(index, f, to, band.h[n]) || crosses(index, f, x[n], band.h[n]);
    }
    if (n >= band.walls + band.fronts) return true;
    const std::size_t i = n - band.walls;
    if (band.behind[i]) { // a node on its way out passes through the wall that its own wall nodes are still behind
        if (index.firstHit(band.inside[i], x[n])) return true;
        if (index.firstHit(band.inside[i], to)) return false;
    }
    for (std::int32_t fan : band.fansOf[n - band.walls]) {
        const Vec3& b = x[static_cast<std::size_t>(fan)];
        if (crosses(index, to, b, band.h[n]) && !crosses(index, x[n], b, band.h[n])) return false;
    }
    return true;
}

} // namespace

bool minimiseEnergy(WallViews& views, const FeatureIndex& features, const std::vector<Snap>& snaps,
                    const std::vector<std::uint8_t>& active, Positions& x, const EnergyOptions& options, const Context& context) {
    const Band& band = views.band();
    const SurfaceIndex& index = views.index();
    std::vector<Floor> floors(band.walls);
    const auto moveOne = [&](std::size_t n, double lambda, LocalCorners& corners) {
        corners.gather(band, n, x);
        if (corners.empty()) return;
        WallTerm wall;
        if (n < band.walls) {
            // Nodes on features may be in poorer corners: a sharp edge asks for them.
            const double floor = snaps[n].kind == SnapKind::none ? options.floor : options.featureFloor;
            if (lambda > 5) floors[n].update(corners.worstScaledJacobian(), floor);
            wall = wallTerm(views, features, snaps[n], x, n, lambda * floors[n].factor);
        }
        if (n >= band.walls && n < band.walls + band.fronts && band.behind[n - band.walls]) wall = wayOut(band, index, x, n, lambda);
        Vec3 d = bestMove(corners, wall, band.outside[n], options.cap * band.h[n], options.newtonSteps);
        if (d == Vec3{}) return;
        for (int half = 0; half < 3; ++half, d *= 0.5) {
            if (!pathsStayFree(band, index, x, n, x[n] + d)) continue;
            x[n] += d;
            break;
        }
    };
    constexpr std::array kinds{NodeBlocks::wall, NodeBlocks::front, NodeBlocks::core};
    for (double lambda : options.wallWeights) {
        context.checkCancelled();
        if (options.budget.isOver()) return false;
        band.blocks.sweep(kinds, [&](std::size_t block, NodeBlocks::Kind kind) {
            LocalCorners corners;
            for (const std::int32_t n : band.blocks.nodes(block, kind))
                if (active[static_cast<std::size_t>(n)]) moveOne(static_cast<std::size_t>(n), lambda, corners);
        });
    }
    return true;
}

} // namespace i2b
