#include "i2b/sizing/gaps.h"
#include "i2b/core/give_up.h"
#include "i2b/core/parallel.h"
#include "i2b/core/parallel_sort_unique.h"
#include "i2b/core/sort_unique.h"
#include <algorithm>
#include <array>
#include <tuple>

namespace i2b {
namespace {

constexpr double parallelEnough = 0.5; // cosine between the normals of opposite walls
constexpr std::size_t mostLevels = 32;

using Triangle = std::array<Vec3, 3>;

// A triangle of the soup, or a piece of a large one.
struct Piece {
    std::uint32_t of;
    Triangle corners;
};

struct LongestEdge {
    explicit LongestEdge(const Triangle& t) {
        for (std::size_t i = 0; i < 3; ++i) {
            if (const double l = norm(t[(i + 1) % 3] - t[i]); l > length) length = l, first = i;
        }
    }
    double length = 0;     // m
    std::size_t first = 0; // corner that it begins at
};

// The two halves of a triangle, cut at the middle of its longest edge.
std::array<Triangle, 2> halvesOf(const Triangle& t, std::size_t k) {
    const Vec3 middle = (t[k] + t[(k + 1) % 3]) * 0.5;
    return {Triangle{t[k], middle, t[(k + 2) % 3]}, Triangle{middle, t[(k + 1) % 3], t[(k + 2) % 3]}};
}

bool outside(const Triangle& t, const Box& domain) {
    Box box;
    for (const Vec3& p : t) box.add(p);
    return !box.overlaps(domain);
}

// Looks at the gaps beside some triangles, one after the other.
class GapSearch {
  public:
    GapSearch(const SizeField& field, const SurfaceIndex& index, int count, double smallest)
        : field_(field), index_(index), count_(count), smallest_(smallest) {}

    void look(const Piece& piece) {
        normal_ = index_.normal(piece.of);
        if (normal_ == Vec3{}) return;
        const Vec3 h = field_.lattice.cellSize(field_.target(index_.surface(), piece.of));
        spacing_ = norm(Vec3{h.x * normal_.x, h.y * normal_.y, h.z * normal_.z});
        // A wall's own cell and the buffer beside it are of one size: where these alone are enough only closer walls matter.
        const Vec3& base = field_.lattice.base;
        reach_ = count_ * (count_ <= 1 + field_.bufferCells ? spacing_ : std::max(base.x, std::max(base.y, base.z)));
        sample(piece.corners);
    }
    std::vector<Gap> take() { return std::move(found_); }

  private:
    void sample(const Triangle& t);
    double lookAcross(const Vec3& p, const Vec3& direction);

    const SizeField& field_;
    const SurfaceIndex& index_;
    int count_;
    double smallest_; // m
    Vec3 normal_;
    double spacing_ = 0, reach_ = 0; // m, of the cells that the triangle meets, along its normal; of the rays
    std::vector<Gap> found_;
};

// Halved along the longest edge until it is no larger than what is wanted at its centre, in needles too.
void GapSearch::sample(const Triangle& t) {
    if (outside(t, field_.lattice.domain())) return;
    const LongestEdge longest(t);
    if (longest.length <= spacing_) {
        const Vec3 centre = (t[0] + t[1] + t[2]) * (1.0 / 3);
        const double wanted = std::min(lookAcross(centre, normal_), lookAcross(centre, -normal_));
        if (longest.length <= wanted) return;
    }
    for (const Triangle& half : halvesOf(t, longest.first)) sample(half);
}

// The size wanted in the gap on one side.
double GapSearch::lookAcross(const Vec3& p, const Vec3& direction) {
    const double none = std::numeric_limits<double>::infinity();
    if (reach_ <= smallest_) return none;
    const Vec3 from = p + direction * smallest_;
    const SegmentHit hit = index_.firstHit(from, p + direction * reach_);
    if (!hit) return none;
    const double cosine = std::abs(dot(direction, index_.normal(hit.triangle)));
    if (cosine <= parallelEnough) return none;
    const Vec3 opposite = from + direction * (hit.t * (reach_ - smallest_));
    const double width = cosine * norm(opposite - p); // to the plane of the opposite wall
    if (width < smallest_) return none;
    const double size = std::max(width / count_, smallest_);
    found_.push_back({p, opposite, static_cast<float>(width), levelFor(field_.lattice, sameSize(size))});
    return size;
}

// Large triangles in pieces, so that threads can share them.
std::vector<Piece> piecesOf(const Surface& s, const SizeField& field) {
    constexpr double most = 64; // cells along an edge
    const Box domain = field.lattice.domain();
    std::vector<Piece> pieces, open;
    for (std::uint32_t t = 0; t < s.triangles.size(); ++t) {
        const auto& v = s.triangles[t];
        const double limit = most * field.lattice.h(field.target(s, t));
        Triangle corners{s.points[v[0]], s.points[v[1]], s.points[v[2]]};
        std::sort(corners.begin(), corners.end(), [](const Vec3& a, const Vec3& b) { // where it is cut must not tell its orientation
            return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
        });
        open.push_back({t, corners});
        while (!open.empty()) {
            const Piece piece = open.back();
            open.pop_back();
            const LongestEdge longest(piece.corners);
            if (outside(piece.corners, domain)) continue;
            if (longest.length <= limit) {
                pieces.push_back(piece);
                continue;
            }
            for (const Triangle& half : halvesOf(piece.corners, longest.first)) open.push_back({t, half});
        }
    }
    return pieces;
}

// Calls f(cell) for the cells of the gap's level that its ray runs through.
template <class F>
void forEachAlong(const Gap& gap, const Lattice& lattice, const F& f) {
    const auto steps = static_cast<int>(std::ceil(2 * norm(gap.to - gap.from) / lattice.h(gap.level)));
    const Box domain = lattice.domain();
    for (int i = 0; i <= steps; ++i) {
        const Vec3 at = gap.from + (gap.to - gap.from) * (static_cast<double>(i) / steps);
        if (domain.contains(at)) f(lattice.cellAt(gap.level, at));
    }
}

} // namespace

std::vector<Gap> findGaps(const SizeField& field, const SurfaceIndex& index, int count, double smallest) {
    constexpr std::size_t chunk = 256;
    const std::vector<Piece> pieces = piecesOf(index.surface(), field);
    std::vector<std::vector<Gap>> parts((pieces.size() + chunk - 1) / chunk);
    parallelChunks(pieces.size(), chunk, [&](std::size_t begin, std::size_t end, std::size_t c) {
        GapSearch search(field, index, count, smallest);
        for (std::size_t i = begin; i < end; ++i) search.look(pieces[i]);
        parts[c] = search.take();
    });
    std::vector<Gap> gaps;
    for (const std::vector<Gap>& part : parts) gaps.insert(gaps.end(), part.begin(), part.end());
    return gaps;
}

std::vector<LevelCells> cellsAlong(const std::vector<Gap>& gaps, const Lattice& lattice) {
    constexpr std::size_t chunk = 4096;
    using CellsByLevel = std::array<std::vector<Index3>, mostLevels>;
    std::vector<CellsByLevel> parts((gaps.size() + chunk - 1) / chunk);
    parallelChunks(gaps.size(), chunk, [&](std::size_t begin, std::size_t end, std::size_t c) {
        for (std::size_t i = begin; i < end; ++i) {
            forEachAlong(gaps[i], lattice, [&](const Index3& cell) { parts[c][static_cast<std::size_t>(gaps[i].level.finest())].push_back(cell); });
        }
        for (std::vector<Index3>& cells : parts[c]) sortUnique(cells);
    });
    std::vector<LevelCells> levels;
    for (std::size_t l = 0; l < mostLevels; ++l) {
        std::vector<Index3> all;
        for (CellsByLevel& part : parts) {
            all.insert(all.end(), part[l].begin(), part[l].end());
            giveUp(part[l]);
        }
        parallelSortUnique(all);
        if (!all.empty()) levels.push_back({allAxes(static_cast<int>(l)), std::move(all)});
    }
    return levels;
}

} // namespace i2b
