#include "i2b/core/flags.h"
#include "i2b/core/raw_fill.h"
#include "i2b/fit/corner.h"
#include "i2b/fit/fit.h"
#include <algorithm>
#include <functional>

namespace i2b {
namespace {

constexpr double badEnergy = 4;     // phi above which a corner's nodes step back
constexpr double stepBack = 0.35;   // of the way
constexpr double asGood = 0.7;      // of what it was at the start, by the scaled Jacobian: a corner that was bad before is no worse
constexpr int gentleRounds = 30;    // after these only inverted corners count, and then their nodes go back whole

// How far each movable node has come, and what follows from changes that nobody has looked at yet.
struct Progress {
    const Band& band;
    RawVector<double> alpha;
    std::vector<std::uint8_t> untold;  // lowered, and its neighbours have not been bounded by it
    std::vector<std::uint8_t> unplaced; // lowered since the nodes were placed
    std::vector<std::uint8_t> moved;   // when they were placed last
    std::vector<std::uint8_t> marked;  // of bad corners, or beside lowered ones; those who ask take it off
    std::vector<std::uint8_t> uneven;  // per fan: a node of it was lowered since they agreed
    const Positions* poorFrom = nullptr; // the start, where corners may have been bad

    explicit Progress(const Band& b)
        : band(b), alpha(filled(b.movable, 1.0)), untold(b.movable, 0), unplaced(b.movable, 1), moved(b.movable, 0), marked(b.movable, 0), uneven(b.fronts, 0) {}
    void mark(std::int32_t n) {
        if (static_cast<std::size_t>(n) < marked.size()) setFlag(marked[static_cast<std::size_t>(n)]);
    }
    void lower(std::size_t n, double to) {
        if (!(to < alpha[n])) return;
        alpha[n] = to;
        untold[n] = unplaced[n] = 1;
        if (n < band.walls) setFlag(uneven[static_cast<std::size_t>(band.frontNode[n]) - band.walls]);
        else if (n < band.walls + band.fronts) setFlag(uneven[n - band.walls]);
    }
};

struct TraceAndDet {
    double trace, det;
};
TraceAndDet lookAt(const Corner& c, const Positions& x) {
    const Vec3& x0 = x[static_cast<std::size_t>(c.node[0])];
    const Vec3 e1 = x[static_cast<std::size_t>(c.node[1])] - x0, e2 = x[static_cast<std::size_t>(c.node[2])] - x0, e3 = x[static_cast<std::size_t>(c.node[3])] - x0;
    const double i1 = double(c.inverseLength[0]), i2 = double(c.inverseLength[1]), i3 = double(c.inverseLength[2]);
    return {norm2(e1) * i1 * i1 + norm2(e2) * i2 * i2 + norm2(e3) * i3 * i3, dot(cross(e1, e2), e3) * i1 * i2 * i3};
}

// Marks the nodes of bad corners. Only corners with a node that has moved since the last round are judged again: where
// many have, all corners in turn, else those of the nodes that have, each at the first such node.
void markBadCorners(const Band& band, const Positions& x, double limit, Progress& progress) {
    const auto isMoved = [&](std::int32_t m) { return static_cast<std::size_t>(m) < band.movable && progress.moved[static_cast<std::size_t>(m)]; };
    const auto judge = [&](const Corner& corner) {
        if (const TraceAndDet c = lookAt(corner, x); !energyExceeds(c.trace, c.det, limit)) return;
        if (progress.poorFrom && !isBad(corner, x, *progress.poorFrom, limit)) return;
        for (std::int32_t m : corner.node) progress.mark(m);
    };
    const std::size_t moved = orderedReduce(band.movable, std::size_t(0), [&](std::size_t begin, std::size_t end) {
        const auto from = progress.moved.begin();
        return static_cast<std::size_t>(std::count(from + static_cast<std::ptrdiff_t>(begin), from + static_cast<std::ptrdiff_t>(end), std::uint8_t(1)));
    }, std::plus<>(), 1 << 16);
    if (moved > band.movable / 8) {
        parallelFor(band.corners.items(), [&](std::size_t i) {
            band.corners.ofItem(i, [&](const Corner& corner) {
                if (std::ranges::any_of(corner.node, isMoved)) judge(corner);
            });
        }, 256);
        return;
    }
    forFlagged(progress.moved, [&](std::size_t n) {
        band.corners.around(n, [&](const Corner& corner) {
            const std::int32_t first = *std::ranges::find_if(corner.node, isMoved);
            if (static_cast<std::size_t>(first) == n) judge(corner);
        });
    });
}

// Nodes of bad corners step back by `step`. Gives whether any changed.
bool stepBackBad(const Band& band, const Positions& x, double limit, double step, Progress& progress) {
    markBadCorners(band, x, limit, progress);
    std::uint8_t changed = 0;
    forFlagged(progress.marked, [&](std::size_t n) {
        progress.marked[n] = 0;
        if (progress.alpha[n] <= 0) return;
        progress.lower(n, std::max(0.0, progress.alpha[n] - step));
        setFlag(changed);
    });
    return changed != 0;
}

// Lowers alpha until neighbours differ by no more than the slope, and the nodes of one fan agree. Only where a neighbour
// was lowered there is anything to do.
void spread(const Band& band, double slope, Progress& progress) {
    RawVector<double> bound(band.movable);
    for (int round = 0; round < 4; ++round) {
        std::uint8_t any = 0;
        forFlagged(progress.untold, [&](std::size_t n) {
            for (const BandEdge& e : band.edges[n]) progress.mark(e.b);
            progress.untold[n] = 0;
            setFlag(any);
        });
        if (any == 0) return;
        forFlagged(progress.marked, [&](std::size_t n) {
            double a = progress.alpha[n];
            for (const BandEdge& e : band.edges[n]) {
                const auto b = static_cast<std::size_t>(e.b);
                if (b < band.movable) a = std::min(a, progress.alpha[b] + slope);
            }
            bound[n] = a;
        });
        forFlagged(progress.marked, [&](std::size_t n) {
            progress.marked[n] = 0;
            progress.lower(n, bound[n]);
        });
        forFlagged(progress.uneven, [&](std::size_t i) {
            for (std::int32_t b : band.fansOf[i]) progress.lower(band.walls + i, progress.alpha[static_cast<std::size_t>(b)]);
            for (std::int32_t b : band.fansOf[i]) progress.lower(static_cast<std::size_t>(b), progress.alpha[band.walls + i]);
            progress.uneven[i] = 0;
        });
    }
}

void place(const Positions& start, const Positions& goal, Progress& progress, Positions& x) {
    std::fill(progress.moved.begin(), progress.moved.end(), std::uint8_t(0));
    forFlagged(progress.unplaced, [&](std::size_t n) {
        const Vec3 to = start[n] + (goal[n] - start[n]) * progress.alpha[n];
        progress.moved[n] = !(to == x[n]);
        progress.unplaced[n] = 0;
        x[n] = to;
    });
}

} // namespace

double cornerEnergy(const Corner& c, const Positions& x) {
    const TraceAndDet look = lookAt(c, x);
    return energyOf(look.trace, look.det);
}

double scaledJacobian(const Corner& c, const Positions& x) {
    const Vec3& x0 = x[static_cast<std::size_t>(c.node[0])];
    const Vec3 e1 = x[static_cast<std::size_t>(c.node[1])] - x0, e2 = x[static_cast<std::size_t>(c.node[2])] - x0, e3 = x[static_cast<std::size_t>(c.node[3])] - x0;
    const double l = norm(e1) * norm(e2) * norm(e3);
    return l > 0 ? dot(cross(e1, e2), e3) / l : -1;
}

bool isBad(const Corner& c, const Positions& x, const Positions& before, double limit) {
    const TraceAndDet now = lookAt(c, x);
    if (!energyExceeds(now.trace, now.det, limit)) return false;
    const TraceAndDet was = lookAt(c, before);
    return !(now.det > 0) || !energyExceeds(was.trace, was.det, limit) || scaledJacobian(c, x) < asGood * scaledJacobian(c, before);
}

double worstCorner(const Band& band, std::size_t node, const Positions& x) {
    double worst = 1;
    band.corners.around(node, [&](const Corner& c) { worst = std::min(worst, scaledJacobian(c, x)); });
    return worst;
}

std::vector<std::uint8_t> nodesOfPoorCorners(const Band& band, const Positions& x, double limit) {
    std::vector<std::uint8_t> poor(band.nodes(), 0);
    parallelFor(band.corners.items(), [&](std::size_t i) {
        band.corners.ofItem(i, [&](const Corner& c) {
            if (const TraceAndDet look = lookAt(c, x); !energyExceeds(look.trace, look.det, limit)) return;
            for (std::int32_t n : c.node) setFlag(poor[static_cast<std::size_t>(n)]);
        });
    });
    poor.resize(band.movable);
    return poor;
}

RawVector<double> blend(const Band& band, const Positions& start, const Positions& goal, Positions& x,
                          const BlendOptions& options) {
    Progress progress(band);
    if (options.maybePoor) progress.poorFrom = &start;
    forFlagged(options.stays, [&](std::size_t n) { progress.lower(n, 0); });
    spread(band, options.slope, progress);
    copyTo(x, start);
    place(start, goal, progress, x);
    for (int round = 0;; ++round) {
        const bool gentle = round < gentleRounds;
        if (round == gentleRounds) std::fill(progress.moved.begin(), progress.moved.end(), std::uint8_t(1)); // judged by another limit now
        const double limit = gentle ? badEnergy : std::numeric_limits<double>::max();
        const bool changed = stepBackBad(band, x, limit, gentle ? stepBack : 1.0, progress);
        if (!changed && !gentle) break;
        if (!changed) {
            round = gentleRounds - 1;
            continue;
        }
        if (gentle) spread(band, options.slope, progress);
        place(start, goal, progress, x);
    }
    return progress.alpha;
}

} // namespace i2b
