#include "i2b/repair/cell_star.h"
#include "i2b/quality/face_tets.h"
#include "i2b/quality/measures.h"
#include <algorithm>
#include <cmath>
#include <numeric>

namespace i2b {
namespace {

using Index = std::size_t;
constexpr double counts = 0.9;       // of a limit: what is better does not count
constexpr double leastPyramid = 0.05; // cosine between a face's normal and the way to its centre from the cell's; of thin
                                      // cells three times the pyramid's volume over the cell's, half for each face of a box
constexpr double leastTets = 0.08;    // share of a face's tetrahedra
constexpr double margin = 1e-9;       // of such a share, for what sums lose
constexpr double flat = 1e-9;        // a pyramid below this cosine is wrong, as in mesh_faults.cpp
constexpr double wrong = 30;         // of a cell inside out
constexpr Index none = ~Index(0);

void addLow(Badness& out, double share) {
    out.worst = std::max(out.worst, share);
    if (share > counts) out.sum += (share - counts) * (share - counts);
}

void add(Badness& out, double share) {
    out.beyond = std::max(out.beyond, share);
    addLow(out, share);
}

} // namespace

bool CellStar::uses(std::int32_t face) const {
    constexpr Index few = 16; // one by one is faster
    const auto v = mesh_.face(face);
    return std::any_of(v.begin(), v.end(), [&](std::int32_t p) {
        if (p < points_.front() || p > points_.back()) return false; // most
        return points_.size() <= few ? std::find(points_.begin(), points_.end(), p) != points_.end() : std::binary_search(points_.begin(), points_.end(), p);
    });
}

const std::vector<std::int32_t>& CellStar::cellsAt(const std::vector<std::int32_t>& points, const std::vector<std::int32_t>& from) {
    points_ = points;
    cells_.clear();
    std::vector<std::int32_t> queue = from;
    for (Index i = 0; i < queue.size(); ++i) {
        const std::int32_t c = queue[i];
        const auto at = std::lower_bound(cells_.begin(), cells_.end(), c);
        if (at != cells_.end() && *at == c) continue;
        bool touches = false;
        for (std::int32_t f : cellFaces_[c]) {
            if (!uses(f)) continue;
            touches = true;
            if (f < mesh_.internalFaces()) queue.push_back(mesh_.owner[Index(f)] == c ? mesh_.neighbour[Index(f)] : mesh_.owner[Index(f)]);
        }
        if (touches) cells_.insert(at, c);
    }
    return cells_;
}

void CellStar::take(const std::vector<std::int32_t>& points, const std::vector<std::int32_t>& cells) {
    points_ = points;
    if (&cells != &cells_) cells_ = cells;
    sides_.clear(), firstFace_.assign(1, 0), cellOf_.clear();
    for (std::uint32_t i = 0; i < cells_.size(); ++i) {
        for (const std::int32_t f : cellFaces_[cells_[i]]) {
            sides_.push_back(std::uint64_t(std::uint32_t(f)) << 32 | cellOf_.size());
            cellOf_.push_back(i);
        }
        firstFace_.push_back(static_cast<std::uint32_t>(cellOf_.size()));
    }
    std::sort(sides_.begin(), sides_.end()); // of one face together
    faces_.clear(), faceOf_.resize(sides_.size());
    for (const std::uint64_t side : sides_) {
        const auto f = static_cast<std::int32_t>(side >> 32);
        const auto at = static_cast<std::uint32_t>(side);
        if (faces_.empty() || faces_.back().face != f) faces_.push_back({f, -1, -1, uses(f)});
        Face& face = faces_.back();
        const auto cell = static_cast<std::int32_t>(cellOf_[at]);
        (mesh_.owner[Index(f)] == cells_[Index(cell)] ? face.owner : face.neighbour) = cell;
        faceOf_[at] = static_cast<std::uint32_t>(faces_.size() - 1);
    }
    shapes_.resize(faces_.size()), own_.resize(cells_.size());
    shapeTurn_.assign(faces_.size(), 0), ownTurn_.assign(cells_.size(), 0);
    order_.resize(cells_.size() + faces_.size());
    std::iota(order_.begin(), order_.end(), 0);
    turn_ = 0, summed_ = 0, tetOrder_.clear(), tetsSummed_ = 0, critical_ = none;
}

const FaceShape& CellStar::shapeOf(Index i) {
    if (shapeTurn_[i] == 0 || (faces_[i].moves && shapeTurn_[i] != turn_)) shapes_[i] = measureFace(mesh_, faces_[i].face);
    shapeTurn_[i] = turn_;
    return shapes_[i];
}

std::span<const FaceShape> CellStar::shapesOf(Index i) {
    row_.resize(firstFace_[i + 1] - firstFace_[i]);
    for (Index k = 0; k < row_.size(); ++k) row_[k] = shapeOf(faceOf_[firstFace_[i] + k]);
    return row_;
}

const CellMoments& CellStar::momentsOf(std::int32_t place, std::int32_t cell) {
    if (place < 0) return moments_[Index(cell)];
    const auto i = Index(place);
    if (ownTurn_[i] != turn_) own_[i] = measureCell(mesh_, cellFaces_[cell], shapesOf(i), cell);
    ownTurn_[i] = turn_;
    return own_[i];
}

void CellStar::judgeCell(Index i, Badness& out) {
    const std::span<const std::int32_t> faces = cellFaces_[cells_[i]];
    const CellMoments& m = own_[i] = measureCell(mesh_, faces, shapesOf(i), cells_[i]);
    ownTurn_[i] = turn_;
    if (!(m.volume > 0)) out.invalid = true, add(out, wrong);
    for (Index k = 0; k < faces.size(); ++k) {
        const Vec3 arm = row_[k].centre - m.centre;
        const double sign = mesh_.owner[Index(faces[k])] == cells_[i] ? 1 : -1, size = norm(row_[k].area) * norm(arm);
        const double cosine = size > 0 ? sign * dot(row_[k].area, arm) / size : -1;
        out.invalid = out.invalid || !(cosine > flat);
        // Of thin cells the way to the centre of a face may be far longer sideways than across it.
        const double pyramid = cells_[i] < thinFrom_ ? cosine : sign * dot(row_[k].area, arm) / std::max(m.volume, 1e-300);
        if (pyramid < leastPyramid) addLow(out, std::min(wrong, 1 + (leastPyramid - pyramid) / leastPyramid));
    }
    const bool isThin = cells_[i] >= thinFrom_;
    const double least = isThin ? leastFull_ : limits_.determinant;
    if (isThin && least == 0) return;
    const double determinant = isThin ? cellFullness(row_) : cellDeterminant(mesh_, faces, row_, Directions());
    add(out, std::min(wrong, least / std::max(determinant, 1e-300)));
}

void CellStar::judgeFace(Index i, Badness& out) {
    const Face& face = faces_[i];
    const FaceShape& shape = shapeOf(i);
    const std::int32_t owner = mesh_.owner[Index(face.face)];
    const CellMoments& own = momentsOf(face.owner, owner);
    if (face.face >= mesh_.internalFaces()) {
        const double most = std::min(limits_.skewness, limits_.boundarySkewness);
        add(out, std::min(wrong, faceSkewness(mesh_, face.face, shape, own.centre, nullptr, counts * most) / most));
        return;
    }
    const std::int32_t neighbour = mesh_.neighbour[Index(face.face)];
    const CellMoments& nei = momentsOf(face.neighbour, neighbour);
    const PairValues values = pairValues(shape, own, nei);
    add(out, (1 - values.ortho) / orthoLimit_);
    add(out, std::min(wrong, faceSkewness(mesh_, face.face, shape, own.centre, &nei.centre, counts * limits_.skewness) / limits_.skewness));
    if (!thinWeights_ && owner >= thinFrom_ && neighbour >= thinFrom_) return;
    add(out, std::min(wrong, limits_.faceWeight / std::max(values.weight, 1e-300)));
    add(out, std::min(wrong, limits_.volumeRatio / std::max(values.ratio, 1e-300)));
}

double CellStar::tetShareOf(Index i, double hopeless) {
    const Face& face = faces_[i];
    const FaceShape& shape = shapeOf(i);
    const Vec3& own = momentsOf(face.owner, mesh_.owner[Index(face.face)]).centre;
    const bool inner = face.face < mesh_.internalFaces();
    const Vec3* nei = inner ? &momentsOf(face.neighbour, mesh_.neighbour[Index(face.face)]).centre : nullptr;
    const double share = tetShare(mesh_, face.face, shape.centre, shape.area, own, nei, leastTets, hopeless);
    return std::min(share, undividedShare + pyramidShare(shape, own, nei, limits_.pyramidVolume));
}

// f(other end) for the edges of faces that end at a point.
template <class F>
void CellStar::forEdgesAt(std::int32_t point, const F& f) const {
    for (const Face& face : faces_) {
        const auto v = mesh_.face(face.face);
        for (Index i = 0; i < v.size(); ++i) {
            const std::int32_t next = v[i + 1 == v.size() ? 0 : i + 1];
            if (v[i] == point) f(next);
            if (next == point) f(v[i]);
        }
    }
}

double CellStar::shortestEdgeAt(std::int32_t point) const {
    double shortest2 = std::numeric_limits<double>::infinity();
    forEdgesAt(point, [&](std::int32_t end) { shortest2 = std::min(shortest2, norm2(mesh_.points[Index(end)] - mesh_.points[Index(point)])); });
    return std::sqrt(shortest2);
}

Vec3 CellStar::middleOf(std::int32_t point) const {
    Vec3 sum;
    double n = 0;
    forEdgesAt(point, [&](std::int32_t end) { sum += mesh_.points[Index(end)], ++n; });
    return n > 0 ? sum / n : mesh_.points[Index(point)];
}

Badness CellStar::judge() {
    ++turn_;
    order_.clear(), rest_.clear();
    Badness out;
    for (std::uint32_t i = 0; i < cells_.size() + faces_.size(); ++i) {
        const double before = out.sum;
        look(i, out);
        (out.sum > before ? order_ : rest_).push_back(i);
    }
    summed_ = order_.size();
    order_.insert(order_.end(), rest_.begin(), rest_.end());
    return out;
}

double CellStar::sumNearby() {
    ++turn_;
    Badness out;
    for (Index i = 0; i < summed_; ++i) look(order_[i], out);
    return out.sum;
}

Badness CellStar::judge(const Badness& before, double most) {
    return judge([&](const Badness& now) { return now.worst > before.worst || (now.invalid && !before.invalid) || !(now.sum < most); });
}

bool CellStar::mayStand(const Badness& before) {
    const auto mayNot = [&](const Badness& now) {
        const auto isWorse = [](double a, double b) { return a > nearLimit && a > b; };
        return now.invalid || isWorse(now.worst, before.worst) || isWorse(now.beyond, before.beyond) || (now.worst > nearLimit && now.sum > before.sum);
    };
    return !mayNot(judge(mayNot));
}

// All, in order, or until it is too bad. What made it so in the last look is asked before: it often does so again.
template <class TooBad>
Badness CellStar::judge(const TooBad& tooBad) {
    ++turn_;
    if (critical_ != none) {
        Badness first;
        look(critical_, first);
        if (tooBad(first)) return first;
    }
    Badness out;
    Index worst = 0;
    double largest = -1;
    for (const std::uint32_t i : order_) {
        const double before = out.sum;
        look(i, out);
        if (out.sum - before > largest) largest = out.sum - before, worst = i;
        if (!tooBad(out)) continue;
        critical_ = worst;
        break;
    }
    return out;
}

namespace {

void addTets(TetLack& out, double share) {
    if (share < leastTets) out.sum += (leastTets - share) * (leastTets - share);
    out.undivided = out.undivided || share < undividedShare;
}

} // namespace

TetLack CellStar::judgeTets(double most) {
    ++turn_;
    TetLack out;
    if (tetOrder_.empty()) {
        std::vector<std::pair<double, std::uint32_t>> shares(faces_.size());
        for (std::uint32_t i = 0; i < shares.size(); ++i) shares[i] = {tetShareOf(i), i};
        std::sort(shares.begin(), shares.end());
        for (const auto& [share, i] : shares) tetOrder_.push_back(i), addTets(out, share), tetsSummed_ += share < leastTets;
        return out;
    }
    for (const std::uint32_t i : tetOrder_) {
        if (!(out.sum < most)) break;
        addTets(out, tetShareOf(i, leastTets - std::sqrt(most - out.sum) - margin)); // with less the sum is too much
    }
    return out;
}

bool CellStar::mayDivide(const TetLack& before) {
    ++turn_;
    TetLack out;
    return std::ranges::all_of(tetOrder_, [&](std::uint32_t i) {
        addTets(out, tetShareOf(i));
        return before.undivided ? out.sum <= before.sum : !out.undivided;
    });
}

double CellStar::tetSumNearby() {
    ++turn_;
    TetLack out;
    for (Index i = 0; i < tetsSummed_; ++i) addTets(out, tetShareOf(tetOrder_[i]));
    return out.sum;
}

} // namespace i2b
