#include "i2b/edit/shape_zip.h"
#include "i2b/core/sort_unique.h"
#include "i2b/quality/face_tets.h"
#include "i2b/quality/measures.h"
#include "i2b/quality/mesh_geometry.h"
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

namespace i2b {
namespace {

using Index = std::size_t;
constexpr double wanted = 0.03;      // share of a face that divides well enough
constexpr double leastWeight = 0.08; // of a face between cells
constexpr double withinLimit = 1;    // degrees: as far from the limit of non-orthogonality a face is good
constexpr double leastDeterminant = 1.5e-3; // of cells that have so much at first: none falls below
constexpr double margin = 1e-9;      // of a share, for what sums lose
constexpr double turned = 1;         // cost of a face that points the wrong way
constexpr double worthwhile = 0.95;  // of what a pass finds wanting, is left
constexpr int passes = 6, triesPerStep = 3;
constexpr std::array<double, 3> steps{0.25, 0.1, 0.04}; // of h

// On a small mesh: its columns move one by one, the cost of faces follows.
class Shaper {
  public:
    struct Column {
        std::vector<std::int32_t> points;
        std::vector<double> share;
        std::vector<std::int32_t> faces, cells, judged; // that its points are on; of these faces; faces of these
    };
    Shaper(PolyMesh& mesh, double leastCosine);
    Column columnOf(std::vector<std::int32_t> points, std::vector<double> share) const;
    void improve(const Column& c, double h);
    double cost() const { return std::accumulate(cost_.begin(), cost_.end(), 0.0) + std::accumulate(cellCost_.begin(), cellCost_.end(), 0.0); } // of all

  private:
    double cost(const Column& c) const;
    void move(const Column& c, const Vec3& by);
    void shift(const Column& c, const Vec3& by) {
        for (Index i = 0; i < c.points.size(); ++i) mesh_.points[Index(c.points[i])] += by * c.share[i];
    }
    void beginTries(const Column& c);
    void endTries(const Column& c);
    double costAfter(const Column& c, const Vec3& by, double bound);
    Vec3 bestMove(const Column& c, double step);
    const FaceShape& shapeOf(std::int32_t face);
    const Vec3& centreOf(std::int32_t cell);
    Vec3 measureCentre(std::int32_t cell);
    double costOf(std::int32_t f, double most = std::numeric_limits<double>::infinity()); // or more than that where it is
    double determinantOf(std::int32_t cell);
    double costOfCell(std::int32_t cell) { return std::max(0.0, 1 - determinantOf(cell) / (least_[Index(cell)] + 1e-300)); }

    PolyMesh& mesh_;
    Rows cellFaces_, pointFaces_;
    double leastCosine_;
    std::vector<FaceShape> shapes_;
    std::vector<Vec3> centres_; // m, of cells
    std::vector<double> cost_;  // of faces
    std::vector<double> least_, cellCost_; // of cells: determinant not to fall below; what is wanting, over that
    // While moves of a column are tried: what they change is worked out where it is asked for.
    static constexpr std::uint32_t settled = ~std::uint32_t(0); // a face or cell that does not change
    std::uint32_t turn_ = 0;                                    // counts the moves
    std::vector<std::uint32_t> shapeTurn_, centreTurn_;         // the move that these hold, or settled
    std::vector<FaceShape> triedShapes_;
    std::vector<Vec3> triedCentres_;
    std::vector<std::int32_t> order_;                           // faces: those that cost something come first
    std::vector<Vec3> saved_;
};

Shaper::Shaper(PolyMesh& mesh, double leastCosine) : mesh_(mesh), cellFaces_(buildCellFaces(mesh)), pointFaces_(buildPointFaces(mesh)), leastCosine_(leastCosine) {
    shapes_.resize(Index(mesh.faces()));
    for (Index f = 0; f < shapes_.size(); ++f) shapes_[f] = measureFace(mesh, static_cast<std::int32_t>(f));
    shapeTurn_.assign(shapes_.size(), settled), triedShapes_.resize(shapes_.size());
    centres_.resize(Index(mesh.cells)), centreTurn_.assign(centres_.size(), settled), triedCentres_.resize(centres_.size());
    for (std::int32_t c = 0; c < mesh.cells; ++c) centres_[Index(c)] = measureCentre(c);
    least_.resize(centres_.size()), cellCost_.assign(centres_.size(), 0);
    for (std::int32_t c = 0; c < mesh.cells; ++c) least_[Index(c)] = std::min(leastDeterminant, determinantOf(c));
    cost_.resize(shapes_.size());
    for (Index f = 0; f < cost_.size(); ++f) cost_[f] = costOf(static_cast<std::int32_t>(f));
}

Shaper::Column Shaper::columnOf(std::vector<std::int32_t> points, std::vector<double> share) const {
    Column c{std::move(points), std::move(share), {}, {}, {}};
    for (const std::int32_t p : c.points) c.faces.insert(c.faces.end(), pointFaces_[p].begin(), pointFaces_[p].end());
    sortUnique(c.faces);
    for (const std::int32_t f : c.faces) {
        c.cells.push_back(mesh_.owner[Index(f)]);
        if (f < mesh_.internalFaces()) c.cells.push_back(mesh_.neighbour[Index(f)]);
    }
    sortUnique(c.cells);
    for (const std::int32_t cell : c.cells) c.judged.insert(c.judged.end(), cellFaces_[cell].begin(), cellFaces_[cell].end());
    sortUnique(c.judged);
    return c;
}

double Shaper::cost(const Column& c) const {
    double sum = 0;
    for (const std::int32_t f : c.judged) sum += cost_[Index(f)];
    for (const std::int32_t cell : c.cells) sum += cellCost_[Index(cell)];
    return sum;
}

void Shaper::move(const Column& c, const Vec3& by) {
    shift(c, by);
    for (const std::int32_t f : c.faces) shapes_[Index(f)] = measureFace(mesh_, f);
    for (const std::int32_t cell : c.cells) centres_[Index(cell)] = measureCentre(cell);
    for (const std::int32_t cell : c.cells) cellCost_[Index(cell)] = costOfCell(cell);
    for (const std::int32_t f : c.judged) cost_[Index(f)] = costOf(f);
}

void Shaper::beginTries(const Column& c) {
    turn_ = 0;
    for (const std::int32_t f : c.faces) shapeTurn_[Index(f)] = 0;
    for (const std::int32_t cell : c.cells) centreTurn_[Index(cell)] = 0;
    saved_.clear(), order_ = c.judged;
    for (const std::int32_t p : c.points) saved_.push_back(mesh_.points[Index(p)]);
    std::ranges::stable_partition(order_, [&](std::int32_t f) { return cost_[Index(f)] > 0; });
}

void Shaper::endTries(const Column& c) {
    for (const std::int32_t f : c.faces) shapeTurn_[Index(f)] = settled;
    for (const std::int32_t cell : c.cells) centreTurn_[Index(cell)] = settled;
}

// What a move would cost, or more than the bound where it costs more; all is as it was afterwards. Most moves cost too much soon:
// determinants, which take longest, come last.
double Shaper::costAfter(const Column& c, const Vec3& by, double bound) {
    ++turn_;
    shift(c, by);
    double sum = 0;
    for (Index i = 0; i < order_.size() && sum <= bound; ++i) sum += costOf(order_[i], bound - sum);
    for (Index i = 0; i < c.cells.size() && sum <= bound; ++i) sum += costOfCell(c.cells[i]);
    for (Index i = 0; i < c.points.size(); ++i) mesh_.points[Index(c.points[i])] = saved_[i];
    return sum;
}

// Along an axis, to and fro; none where no such move is better.
Vec3 Shaper::bestMove(const Column& c, double step) {
    double best = cost(c) * 0.999;
    Vec3 way;
    beginTries(c);
    for (int d = 0; d < 6; ++d) {
        const double by = d & 1 ? -step : step;
        const Vec3 move = d / 2 == 0 ? Vec3{by, 0, 0} : d / 2 == 1 ? Vec3{0, by, 0} : Vec3{0, 0, by};
        if (const double now = costAfter(c, move, best); now < best) best = now, way = move;
    }
    endTries(c);
    return way;
}

void Shaper::improve(const Column& c, double h) {
    for (const double step : steps) {
        for (int tries = 0; tries < triesPerStep && cost(c) > 0; ++tries) {
            const Vec3 way = bestMove(c, step * h);
            if (way == Vec3{}) break;
            move(c, way);
        }
    }
}

const FaceShape& Shaper::shapeOf(std::int32_t face) {
    const auto f = Index(face);
    if (shapeTurn_[f] == settled) return shapes_[f];
    if (shapeTurn_[f] != turn_) shapeTurn_[f] = turn_, triedShapes_[f] = measureFace(mesh_, face);
    return triedShapes_[f];
}

const Vec3& Shaper::centreOf(std::int32_t cell) {
    const auto c = Index(cell);
    if (centreTurn_[c] == settled) return centres_[c];
    if (centreTurn_[c] != turn_) centreTurn_[c] = turn_, triedCentres_[c] = measureCentre(cell);
    return triedCentres_[c];
}

Vec3 Shaper::measureCentre(std::int32_t cell) {
    Vec3 middle, sum;
    for (const std::int32_t f : cellFaces_[cell]) middle += shapeOf(f).centre;
    middle = middle / static_cast<double>(cellFaces_[cell].size());
    double volume = 0;
    for (const std::int32_t f : cellFaces_[cell]) {
        const FaceShape& s = shapeOf(f);
        const double v = std::abs(dot(s.area, s.centre - middle)) + 1e-300;
        volume += v, sum += (s.centre * 0.75 + middle * 0.25) * v;
    }
    return sum / volume;
}

double Shaper::determinantOf(std::int32_t cell) {
    std::array<FaceShape, 64> some;
    const std::span<const std::int32_t> faces = cellFaces_[cell];
    const Index n = std::min(faces.size(), some.size());
    for (Index i = 0; i < n; ++i) some[i] = shapeOf(faces[i]);
    return cellDeterminant(mesh_, faces.first(n), {some.data(), n}, Directions());
}

double Shaper::costOf(std::int32_t f, double most) {
    const FaceShape& s = shapeOf(f);
    const Vec3& own = centreOf(mesh_.owner[Index(f)]);
    const Vec3* next = f < mesh_.internalFaces() ? &centreOf(mesh_.neighbour[Index(f)]) : nullptr;
    double cost = std::max(0.0, wanted - tetShare(mesh_, f, s.centre, s.area, own, next, wanted, wanted - most - margin));
    const double from = dot(s.area, s.centre - own);
    if (from <= 0) cost += turned;
    if (!next) return cost;
    const Vec3 way = *next - own;
    cost += std::max(0.0, leastCosine_ - dot(s.area, way) / std::max(norm(s.area) * norm(way), 1e-300));
    const double to = dot(s.area, *next - s.centre);
    if (to <= 0) cost += turned;
    if (from > 0 && to > 0) cost += 4 * std::max(0.0, leastWeight - std::min(from, to) / (from + to));
    return cost;
}

} // namespace

std::vector<std::pair<std::int32_t, Vec3>> shapeZip(const ZipStar& star, const Zip& zip, const DictionaryLimits& limits) {
    std::vector<std::int32_t> ids;
    LocalEdits::Surroundings around = star.around(zip.star, ids);
    Shaper shaper(around.mesh, std::cos((limits.nonOrthogonality - withinLimit) * std::numbers::pi / 180));
    std::vector<Shaper::Column> columns;
    std::vector<std::int32_t> moved;
    for (const Zip::Column& column : zip.columns) {
        std::vector<std::int32_t> points;
        std::vector<double> share;
        for (Index i = 0; i < column.points.size(); ++i) {
            const auto at = std::ranges::lower_bound(ids, column.points[i]);
            if (at == ids.end() || *at != column.points[i]) continue;
            points.push_back(static_cast<std::int32_t>(at - ids.begin())), share.push_back(column.share[i]);
        }
        moved.insert(moved.end(), points.begin(), points.end());
        columns.push_back(shaper.columnOf(std::move(points), std::move(share)));
    }
    sortUnique(moved);
    const std::vector<Vec3> before(around.mesh.points.begin(), around.mesh.points.end());
    double left = shaper.cost();
    for (int pass = 0; pass < passes && left > 0; ++pass) {
        for (const Shaper::Column& c : columns) shaper.improve(c, zip.h);
        const double now = shaper.cost();
        if (now > worthwhile * left) break;
        left = now;
    }
    std::vector<std::pair<std::int32_t, Vec3>> places;
    for (const std::int32_t p : moved)
        if (around.mesh.points[Index(p)] != before[Index(p)]) places.emplace_back(ids[Index(p)], around.mesh.points[Index(p)]);
    return places;
}

} // namespace i2b
