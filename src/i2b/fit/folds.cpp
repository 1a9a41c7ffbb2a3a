#include "i2b/fit/folds.h"
#include "i2b/core/collect.h"
#include "i2b/fit/between.h"
#include <algorithm>

namespace i2b {
namespace {

constexpr int rounds = 2;        // nodes that were snapped in one lead on to others in the next
constexpr double farthest = 1.2; // of h: so far a node is drawn to a feature that its neighbours are on
constexpr double onLine = 0.2;   // of h: so near to the feature a neighbour stands on it
constexpr double apart = 0.4;    // of h: nodes beside each other keep so far apart; or
constexpr double apartOnRim = 0.2; // where the faces fold back, since both sides end there
const double flat = std::cos(0.2);       // 11 degrees
const double foldedBack = std::cos(2.6); // 150 degrees

struct Fold {
    double distance = 0; // in h
    std::int32_t node = -1;
    Snap snap;
    double apart = 0; // in h: other nodes must be so far from the place
};

class FoldFinder {
  public:
    FoldFinder(const Band& band, const Front& front, const SurfaceIndex& index, const FeatureIndex& features, const Positions& x,
               const std::vector<Snap>& snaps)
        : band_(band), front_(front), index_(index), features_(features), x_(x), snaps_(snaps) {}
    Fold foldAt(std::size_t n) const;
    bool isTaken(const Fold& fold) const;

  private:
    bool isSnapped(std::size_t n) const { return snaps_[n].kind != SnapKind::none; }
    Snap featureNear(std::size_t n) const;
    bool goesOn(std::size_t n, const Snap& snap) const;
    bool bends(std::size_t n) const;
    double sharpestTurn(std::size_t n) const;

    const Band& band_;
    const Front& front_;
    const SurfaceIndex& index_;
    const FeatureIndex& features_;
    const Positions& x_;
    const std::vector<Snap>& snaps_;
};

// The sharp edge nearest to a node, or the nearest of the implicit lines that its neighbours are on.
Snap FoldFinder::featureNear(std::size_t n) const {
    const double reach = farthest * band_.h[n];
    const FeatureIndex::Line line = features_.closestLine(x_[n], reach);
    if (line.found && isSeen(index_, x_[static_cast<std::size_t>(band_.frontNode[n])], line.point, band_.h[n])) return {SnapKind::line, line.point, line.tangent};
    Snap best;
    double least = reach;
    for (const BandEdge& e : band_.edges[n]) {
        const auto m = static_cast<std::size_t>(e.b);
        if (m >= band_.walls || snaps_[m].kind != SnapKind::implicitLine) continue;
        const Snap& s = snaps_[m];
        const Vec3 on = s.point + s.tangent * dot(x_[n] - s.point, s.tangent);
        const double d = norm(on - x_[n]);
        if (d < least && index_.closest(on, mostBentAway * band_.h[n])) least = d, best = {SnapKind::implicitLine, on, s.tangent};
    }
    return best;
}

// Is a neighbour of a node held to a feature, and stands on this one?
bool FoldFinder::goesOn(std::size_t n, const Snap& snap) const {
    return std::any_of(band_.edges[n].begin(), band_.edges[n].end(), [&](const BandEdge& e) {
        const auto m = static_cast<std::size_t>(e.b);
        if (m >= band_.walls || !isSnapped(m)) return false;
        const Vec3 way = x_[m] - snap.point;
        return norm(way - snap.tangent * dot(way, snap.tangent)) < onLine * band_.h[n];
    });
}

// Do the wall's own faces around a node bend at all?
bool FoldFinder::bends(std::size_t n) const {
    Vec3 first{};
    for (auto f : front_.mesh.vf_range(FrontMesh::VertexHandle(static_cast<int>(n)))) {
        auto v = front_.mesh.cfv_iter(f);
        const Vec3 from = x_[static_cast<std::size_t>(v->idx())];
        Vec3 area{}, last = from;
        for (++v; v.is_valid(); ++v) {
            const Vec3& p = x_[static_cast<std::size_t>(v->idx())];
            area += cross(last - from, p - from);
            last = p;
        }
        if (first == Vec3{}) first = area;
        else if (dot(first, area) < flat * norm(first) * norm(area)) return true;
    }
    return false;
}

// Of the surfaces that the faces around a node stand on: the least cosine between two that turn, else 1.
double FoldFinder::sharpestTurn(std::size_t n) const {
    std::array<Foot, 16> feet;
    double least = 1;
    std::size_t count = 0;
    for (auto f : front_.mesh.vf_range(FrontMesh::VertexHandle(static_cast<int>(n)))) {
        Vec3 wall{}, fluid{};
        double corners = 0;
        for (auto v : front_.mesh.fv_range(f)) {
            const auto m = static_cast<std::size_t>(v.idx());
            wall += x_[m], fluid += x_[static_cast<std::size_t>(band_.frontNode[m])], corners += 1;
        }
        wall *= 1 / corners, fluid *= 1 / corners;
        if (count == feet.size()) break;
        feet[count] = footAt(index_, wall + (fluid - wall) * 0.15, fluid, band_.h[n]);
        for (std::size_t i = 0; i < count; ++i) {
            if (turns(feet[i], feet[count])) least = std::min(least, dot(feet[i].normal, feet[count].normal));
        }
        ++count;
    }
    return least;
}

Fold FoldFinder::foldAt(std::size_t n) const {
    const auto isWallAndSnapped = [&](const BandEdge& e) { return static_cast<std::size_t>(e.b) < band_.walls && isSnapped(static_cast<std::size_t>(e.b)); };
    if (isSnapped(n) || band_.outside[n] != 0 || std::none_of(band_.edges[n].begin(), band_.edges[n].end(), isWallAndSnapped)) return {};
    if (!band_.parents[static_cast<std::size_t>(band_.frontNode[n])].empty()) return {};
    if (!bends(n)) return {};
    const Snap snap = featureNear(n);
    if (snap.kind == SnapKind::none || !goesOn(n, snap)) return {};
    const double turn = sharpestTurn(n);
    if (turn == 1) return {};
    return {norm(snap.point - x_[n]) / band_.h[n], static_cast<std::int32_t>(n), snap, turn < foldedBack ? apartOnRim : apart};
}

bool FoldFinder::isTaken(const Fold& fold) const {
    const auto n = static_cast<std::size_t>(fold.node);
    for (const BandEdge& e : band_.edges[n]) {
        const auto m = static_cast<std::size_t>(e.b);
        if (m >= band_.walls || !isSnapped(m)) continue;
        const double limit = fold.apart * band_.h[n];
        if (norm(x_[m] - fold.snap.point) < limit || norm(snaps_[m].point - fold.snap.point) < limit) return true;
    }
    return false;
}

} // namespace

std::size_t snapFolds(const Band& band, const Front& front, const SurfaceIndex& index, const FeatureIndex& features,
                      const Positions& x, std::vector<Snap>& snaps) {
    const FoldFinder finder(band, front, index, features, x, snaps);
    std::size_t all = 0, added = 1;
    for (int round = 0; round < rounds && added > 0; ++round) {
        RawVector<Fold> folds = collect<Fold>(band.walls, [&](std::size_t n, const auto& put) {
            if (const Fold fold = finder.foldAt(n); fold.node >= 0) put(fold);
        }, 1024);
        std::stable_sort(folds.begin(), folds.end(), [](const Fold& a, const Fold& b) { return a.distance < b.distance; });
        added = 0;
        for (const Fold& f : folds) {
            if (finder.isTaken(f)) continue;
            snaps[static_cast<std::size_t>(f.node)] = f.snap;
            ++added;
        }
        all += added;
    }
    return all;
}

} // namespace i2b
