#include "i2b/edit/shape_zip.h"
#include "i2b/core/sort_unique.h"
#include "i2b/quality/face_tets.h"
#include "i2b/quality/measures.h"
#include "i2b/quality/mesh_geometry.h"
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace i2b {
namespace {

using Index = std::size_t;
constexpr double wanted = 0.03;      // share of a face that divides well enough
constexpr double leastWeight = 0.08; // of a face between cells
constexpr double withinLimit = 1;    // degrees: as far from the limit of non-orthogonality a face is good
constexpr double leastDeterminant = 1.5e-3; // of cells that have so much at first: none falls below
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
    void place(const Column& c, const Vec3& by);
    void move(const Column& c, const Vec3& by);
    double costAfter(const Column& c, const Vec3& by, double bound);
    Vec3 bestMove(const Column& c, double step);
    Vec3 centreOf(std::int32_t cell) const;
    double costOf(std::int32_t f) const;
    double determinantOf(std::int32_t cell) const;
    double costOfCell(std::int32_t cell) const { return std::max(0.0, 1 - determinantOf(cell) / (least_[Index(cell)] + 1e-300)); }

    PolyMesh& mesh_;
    Rows cellFaces_, pointFaces_;
    double leastCosine_;
    std::vector<FaceShape> shapes_;
    std::vector<Vec3> centres_; // m, of cells
    std::vector<double> cost_;  // of faces
    std::vector<Vec3> saved_, savedCentres_;
    std::vector<FaceShape> savedShapes_;
    std::vector<double> least_, cellCost_; // of cells: determinant not to fall below; what is wanting, over that
};

Shaper::Shaper(PolyMesh& mesh, double leastCosine) : mesh_(mesh), cellFaces_(buildCellFaces(mesh)), pointFaces_(buildPointFaces(mesh)), leastCosine_(leastCosine) {
    shapes_.resize(Index(mesh.faces()));
    for (Index f = 0; f < shapes_.size(); ++f) shapes_[f] = measureFace(mesh, static_cast<std::int32_t>(f));
    centres_.resize(Index(mesh.cells));
    for (std::int32_t c = 0; c < mesh.cells; ++c) centres_[Index(c)] = centreOf(c);
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

void Shaper::place(const Column& c, const Vec3& by) {
    for (Index i = 0; i < c.points.size(); ++i) mesh_.points[Index(c.points[i])] += by * c.share[i];
    for (const std::int32_t f : c.faces) shapes_[Index(f)] = measureFace(mesh_, f);
    for (const std::int32_t cell : c.cells) centres_[Index(cell)] = centreOf(cell);
}

void Shaper::move(const Column& c, const Vec3& by) {
    place(c, by);
    for (const std::int32_t cell : c.cells) cellCost_[Index(cell)] = costOfCell(cell);
    for (const std::int32_t f : c.judged) cost_[Index(f)] = costOf(f);
}

// What a move would cost, or more than the bound where it costs more; all is as it was afterwards.
double Shaper::costAfter(const Column& c, const Vec3& by, double bound) {
    saved_.clear(), savedShapes_.clear(), savedCentres_.clear();
    for (const std::int32_t p : c.points) saved_.push_back(mesh_.points[Index(p)]);
    for (const std::int32_t f : c.faces) savedShapes_.push_back(shapes_[Index(f)]);
    for (const std::int32_t cell : c.cells) savedCentres_.push_back(centres_[Index(cell)]);
    place(c, by);
    double sum = 0; // those that cost something already first, determinants, which take longest, at last: most moves cost too much soon
    for (const bool costs : {true, false})
        for (Index i = 0; i < c.judged.size() && sum <= bound; ++i)
            if ((cost_[Index(c.judged[i])] > 0) == costs) sum += costOf(c.judged[i]);
    for (Index i = 0; i < c.cells.size() && sum <= bound; ++i) sum += costOfCell(c.cells[i]);
    for (Index i = 0; i < c.points.size(); ++i) mesh_.points[Index(c.points[i])] = saved_[i];
    for (Index i = 0; i < c.faces.size(); ++i) shapes_[Index(c.faces[i])] = savedShapes_[i];
    for (Index i = 0; i < c.cells.size(); ++i) centres_[Index(c.cells[i])] = savedCentres_[i];
    return sum;
}

// Along an axis, to and fro; none where no such move is better.
Vec3 Shaper::bestMove(const Column& c, double step) {
    double best = cost(c) * 0.999;
    Vec3 way;
    for (int d = 0; d < 6; ++d) {
        const double by = d & 1 ? -step : step;
        const Vec3 move = d / 2 == 0 ? Vec3{by, 0, 0} : d / 2 == 1 ? Vec3{0, by, 0} : Vec3{0, 0, by};
        if (const double now = costAfter(c, move, best); now < best) best = now, way = move;
    }
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

Vec3 Shaper::centreOf(std::int32_t cell) const {
    Vec3 middle, sum;
    for (const std::int32_t f : cellFaces_[cell]) middle += shapes_[Index(f)].centre;
    middle = middle / static_cast<double>(cellFaces_[cell].size());
    double volume = 0;
    for (const std::int32_t f : cellFaces_[cell]) {
        const FaceShape& s = shapes_[Index(f)];
        const double v = std::abs(dot(s.area, s.centre - middle)) + 1e-300;
        volume += v, sum += (s.centre * 0.75 + middle * 0.25) * v;
    }
    return sum / volume;
}

double Shaper::determinantOf(std::int32_t cell) const {
    std::array<FaceShape, 64> some;
    const std::span<const std::int32_t> faces = cellFaces_[cell];
    const Index n = std::min(faces.size(), some.size());
    for (Index i = 0; i < n; ++i) some[i] = shapes_[Index(faces[i])];
    return cellDeterminant(mesh_, faces.first(n), {some.data(), n}, Directions());
}

double Shaper::costOf(std::int32_t f) const {
    const FaceShape& s = shapes_[Index(f)];
    const Vec3& own = centres_[Index(mesh_.owner[Index(f)])];
    const Vec3* next = f < mesh_.internalFaces() ? &centres_[Index(mesh_.neighbour[Index(f)])] : nullptr;
    double cost = std::max(0.0, wanted - tetShare(mesh_, f, s.centre, s.area, own, next, wanted));
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
