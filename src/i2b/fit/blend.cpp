#include "i2b/core/parallel.h"
#include "i2b/fit/corner.h"
#include "i2b/fit/fit.h"
#include <algorithm>
#include <atomic>

namespace i2b {
namespace {

constexpr double badEnergy = 4;     // phi above which a corner's nodes step back
constexpr double stepBack = 0.35;   // of the way
constexpr double slope = 0.34;      // largest difference of alpha between neighbours: keeps the rim of a patch valid
constexpr int gentleRounds = 30;    // after these only inverted corners count, and then their nodes go back whole

// Nodes of bad corners step back by `step`. Only corners with a node that has moved since the last round are judged
// again. Gives how many nodes changed.
std::size_t stepBackBad(const Band& band, const std::vector<Vec3>& x, double limit, double step, const std::vector<std::uint8_t>& moved,
                        std::vector<double>& alpha) {
    std::vector<std::uint8_t> bad(band.nodes(), 0);
    parallelFor(band.corners.size(), [&](std::size_t c) {
        const Corner& corner = band.corners[c];
        bool look = false;
        for (std::int32_t n : corner.node) look = look || moved[static_cast<std::size_t>(n)];
        if (!look || !(cornerEnergy(corner, x) > limit)) return;
        for (std::int32_t n : corner.node) { // all that set it set the same
            std::atomic_ref<std::uint8_t>(bad[static_cast<std::size_t>(n)]).store(1, std::memory_order_relaxed);
        }
    });
    std::size_t changed = 0;
    for (std::size_t n = 0; n < band.movable; ++n) {
        if (!bad[n] || alpha[n] <= 0) continue;
        alpha[n] = std::max(0.0, alpha[n] - step);
        ++changed;
    }
    return changed;
}

// Lowers alpha until neighbours differ by no more than the slope, and the nodes of one fan agree.
void spread(const Band& band, std::vector<double>& alpha) {
    for (int round = 0; round < 4; ++round) {
        const std::vector<double> old = alpha;
        parallelFor(band.movable, [&](std::size_t n) {
            double a = old[n];
            for (const BandEdge& e : band.edges[n]) {
                const auto b = static_cast<std::size_t>(e.b);
                if (b < band.movable) a = std::min(a, old[b] + slope);
            }
            alpha[n] = a;
        });
        for (std::size_t b = 0; b < band.walls; ++b) {
            auto& f = alpha[static_cast<std::size_t>(band.frontNode[b])];
            f = std::min(f, alpha[b]);
        }
        parallelFor(band.walls, [&](std::size_t b) { alpha[b] = std::min(alpha[b], alpha[static_cast<std::size_t>(band.frontNode[b])]); });
    }
}

void place(const Band& band, const std::vector<Vec3>& start, const std::vector<Vec3>& goal, const std::vector<double>& alpha, std::vector<Vec3>& x,
           std::vector<std::uint8_t>& moved) {
    parallelFor(band.movable, [&](std::size_t n) {
        const Vec3 to = start[n] + (goal[n] - start[n]) * alpha[n];
        moved[n] = !(to == x[n]);
        x[n] = to;
    });
}

} // namespace

double cornerEnergy(const Corner& c, const std::vector<Vec3>& x) {
    const Vec3& x0 = x[static_cast<std::size_t>(c.node[0])];
    const Vec3 e1 = x[static_cast<std::size_t>(c.node[1])] - x0, e2 = x[static_cast<std::size_t>(c.node[2])] - x0, e3 = x[static_cast<std::size_t>(c.node[3])] - x0;
    const double i1 = double(c.inverseLength[0]), i2 = double(c.inverseLength[1]), i3 = double(c.inverseLength[2]);
    const double trace = norm2(e1) * i1 * i1 + norm2(e2) * i2 * i2 + norm2(e3) * i3 * i3;
    return energyOf(trace, dot(cross(e1, e2), e3) * i1 * i2 * i3);
}

double scaledJacobian(const Corner& c, const std::vector<Vec3>& x) {
    const Vec3& x0 = x[static_cast<std::size_t>(c.node[0])];
    const Vec3 e1 = x[static_cast<std::size_t>(c.node[1])] - x0, e2 = x[static_cast<std::size_t>(c.node[2])] - x0, e3 = x[static_cast<std::size_t>(c.node[3])] - x0;
    const double l = norm(e1) * norm(e2) * norm(e3);
    return l > 0 ? dot(cross(e1, e2), e3) / l : -1;
}

std::vector<double> blend(const Band& band, const std::vector<Vec3>& start, const std::vector<Vec3>& goal, std::vector<Vec3>& x) {
    std::vector<double> alpha(band.movable, 1);
    x = start;
    std::vector<std::uint8_t> moved(band.nodes(), 0);
    place(band, start, goal, alpha, x, moved);
    for (int round = 0;; ++round) {
        const bool gentle = round < gentleRounds;
        if (round == gentleRounds) std::fill(moved.begin(), moved.end(), std::uint8_t(1)); // judged by another limit now
        const double limit = gentle ? badEnergy : std::numeric_limits<double>::max();
        const bool changed = stepBackBad(band, x, limit, gentle ? stepBack : 1.0, moved, alpha) > 0;
        if (!changed && !gentle) break;
        if (!changed) {
            round = gentleRounds - 1;
            continue;
        }
        if (gentle) spread(band, alpha);
        place(band, start, goal, alpha, x, moved);
    }
    return alpha;
}

} // namespace i2b
