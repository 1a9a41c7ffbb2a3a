#include "i2b/fit/feature_index.h"

namespace i2b {
namespace {

constexpr float faintFold = 35; // degrees: feet at its sides differ by over 25, by which they are told apart, even where these bend

void addSegment(Surface& segments, const FeatureEdge& e) {
    segments.triangles.push_back({e.a, e.b, e.b});
    segments.partOf.push_back(0);
}

FeatureIndex::Line placeOn(const Surface& segments, const ClosestPoint& c) {
    if (!c) return {};
    const auto& t = segments.triangles[c.triangle];
    FeatureIndex::Line line{c.point, normalized(segments.points[t[1]] - segments.points[t[0]])};
    line.found = line.tangent != Vec3{};
    return line;
}

} // namespace

FeatureIndex::FeatureIndex(const FeatureGraph& graph) {
    lines_.parts = creases_.parts = corners_.parts = {Part{"features", "", 0}};
    lines_.points = creases_.points = corners_.points = graph.points;
    std::vector<std::uint8_t> folds(graph.points.size(), 0);
    for (const FeatureEdge& e : graph.edges) {
        if (!(e.kinds & lineKinds)) {
            if (e.kinds & bitOf(EdgeKind::crease)) addSegment(creases_, e), creaseFold_.push_back(e.angle);
            continue;
        }
        const bool isRim = (e.kinds & bitOf(EdgeKind::rim)) != 0, isFaint = !isRim && e.angle < faintFold;
        addSegment(lines_, e);
        isRim_.push_back(isRim), isFaint_.push_back(isFaint);
        hasFaint_ = hasFaint_ || isFaint;
        if (!isFaint) folds[e.a] = folds[e.b] = 1;
    }
    for (std::uint32_t c : graph.corners) {
        corners_.triangles.push_back({c, c, c});
        corners_.partOf.push_back(0);
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
