#include "i2b/fit/feature_index.h"
#include <algorithm>
#include <cmath>
#include <numbers>

namespace i2b {
namespace {

constexpr float faintFold = 35; // degrees: feet at its sides differ by over 25, by which they are told apart, even where these bend

// Edges or points of a graph as triangles without area, on those of its points alone that they use.
class Segments {
  public:
    Segments(const FeatureGraph& graph, std::size_t count, Surface& segments) : graph_(graph), segments_(segments), numberOf_(graph.points.size(), none) {
        segments_.parts = {Part{"features", "", 0}};
        segments_.triangles.reserve(count), segments_.partOf.reserve(count);
    }
    void add(std::uint32_t a, std::uint32_t b) {
        const std::uint32_t from = numberOf(a), to = numberOf(b);
        segments_.triangles.push_back({from, to, to});
        segments_.partOf.push_back(0);
    }

  private:
    static constexpr std::uint32_t none = ~0u;
    std::uint32_t numberOf(std::uint32_t point) {
        if (numberOf_[point] == none) {
            numberOf_[point] = static_cast<std::uint32_t>(segments_.points.size());
            segments_.points.push_back(graph_.points[point]);
        }
        return numberOf_[point];
    }
    const FeatureGraph& graph_;
    Surface& segments_;
    std::vector<std::uint32_t> numberOf_; // per point of the graph
};

FeatureIndex::Line placeOn(const Surface& segments, const ClosestPoint& c) {
    if (!c) return {};
    const auto& t = segments.triangles[c.triangle];
    FeatureIndex::Line line{c.point, normalized(segments.points[t[1]] - segments.points[t[0]])};
    line.found = line.tangent != Vec3{};
    return line;
}

} // namespace

FeatureIndex::FeatureIndex(const FeatureGraph& graph, Creases creases) : creaseCosine_(std::cos(graph.crease * std::numbers::pi / 180)) {
    const auto isLine = [](const FeatureEdge& e) { return (e.kinds & lineKinds) != 0; };
    const auto isCrease = [&](const FeatureEdge& e) { return creases == Creases::kept && !isLine(e) && (e.kinds & bitOf(EdgeKind::crease)) != 0; };
    const auto countOf = [&](const auto& is) { return static_cast<std::size_t>(std::ranges::count_if(graph.edges, is)); };
    std::vector<std::uint8_t> folds(graph.points.size(), 0);
    Segments lines(graph, countOf(isLine), lines_), milder(graph, countOf(isCrease), creases_), corners(graph, graph.corners.size(), corners_);
    for (const FeatureEdge& e : graph.edges) {
        if (isCrease(e)) milder.add(e.a, e.b), creaseFold_.push_back(e.angle);
        if (!isLine(e)) continue;
        const bool isRim = (e.kinds & bitOf(EdgeKind::rim)) != 0, isFaint = !isRim && e.angle < faintFold;
        lines.add(e.a, e.b);
        isRim_.push_back(isRim), isFaint_.push_back(isFaint);
        hasFaint_ = hasFaint_ || isFaint;
        if (!isFaint) folds[e.a] = folds[e.b] = 1;
    }
    for (std::uint32_t c : graph.corners) {
        corners.add(c, c);
        isFaintCorner_.push_back(folds[c] == 0);
    }
    if (!lines_.triangles.empty()) lineIndex_ = std::make_unique<SurfaceIndex>(lines_);
    if (!creases_.triangles.empty()) creaseIndex_ = std::make_unique<SurfaceIndex>(creases_);
    if (!corners_.triangles.empty()) cornerIndex_ = std::make_unique<SurfaceIndex>(corners_);
}

FeatureIndex::Line FeatureIndex::closestLine(const Vec3& q, double radius) const {
    return lineIndex_ ? lineAt(lineIndex_->closest(q, radius)) : Line{};
}

FeatureIndex::Line FeatureIndex::closestFaint(const Vec3& q, double radius) const {
    return hasFaint_ ? lineAt(lineIndex_->closest(q, radius, [&](std::uint32_t line) { return isFaint_[line] != 0; })) : Line{};
}

FeatureIndex::Line FeatureIndex::closestCrease(const Vec3& q, double radius) const {
    return creaseIndex_ ? placeOn(creases_, creaseIndex_->closest(q, radius)) : Line{};
}

FeatureIndex::Line FeatureIndex::closestCrease(const Vec3& q, double radius, float leastFold) const {
    return creaseIndex_ ? placeOn(creases_, creaseIndex_->closest(q, radius, [&](std::uint32_t crease) { return creaseFold_[crease] > leastFold; })) : Line{};
}

FeatureIndex::Line FeatureIndex::lineAt(const ClosestPoint& c) const {
    Line line = placeOn(lines_, c);
    if (!c) return line;
    line.isRim = isRim_[c.triangle] != 0;
    line.isFaint = isFaint_[c.triangle] != 0;
    return line;
}

bool FeatureIndex::hasOtherBeside(const Line& line, double radius, double aside) const {
    const auto isBeside = [&](std::uint32_t other) {
        const auto& t = lines_.triangles[other];
        const Vec3 way = closestPointOnTriangle(line.point, lines_.points[t[0]], lines_.points[t[1]], lines_.points[t[1]]) - line.point;
        return norm2(way - line.tangent * dot(way, line.tangent)) > aside * aside;
    };
    return bool(lineIndex_->closest(line.point, radius, isBeside));
}

ClosestPoint FeatureIndex::closestCorner(const Vec3& q, double radius) const {
    return cornerIndex_ ? cornerIndex_->closest(q, radius) : ClosestPoint{};
}

bool FeatureIndex::isCrowded(const ClosestPoint& corner, double radius) const {
    return bool(cornerIndex_->closest(corner.point, radius, [&](std::uint32_t other) { return other != corner.triangle; }));
}

} // namespace i2b
