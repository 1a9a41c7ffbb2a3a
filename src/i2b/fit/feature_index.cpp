#include "i2b/fit/feature_index.h"

namespace i2b {
namespace {

constexpr float faintFold = 35; // degrees: feet at its sides differ by over 25, by which they are told apart, even where these bend

} // namespace

FeatureIndex::FeatureIndex(const FeatureGraph& graph) {
    lines_.parts = corners_.parts = {Part{"features", "", 0}};
    lines_.points = corners_.points = graph.points;
    std::vector<std::uint8_t> folds(graph.points.size(), 0);
    for (const FeatureEdge& e : graph.edges) {
        if (!(e.kinds & lineKinds)) continue;
        const bool isRim = (e.kinds & bitOf(EdgeKind::rim)) != 0, isFaint = !isRim && e.angle < faintFold;
        lines_.triangles.push_back({e.a, e.b, e.b});
        lines_.partOf.push_back(0);
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
    if (!corners_.triangles.empty()) cornerIndex_ = std::make_unique<SurfaceIndex>(corners_);
}

FeatureIndex::Line FeatureIndex::closestLine(const Vec3& q, double radius) const {
    return lineIndex_ ? lineAt(lineIndex_->closest(q, radius)) : Line{};
}

FeatureIndex::Line FeatureIndex::closestFaint(const Vec3& q, double radius) const {
    return hasFaint_ ? lineAt(lineIndex_->closest(q, radius, [&](std::uint32_t line) { return isFaint_[line] != 0; })) : Line{};
}

FeatureIndex::Line FeatureIndex::lineAt(const ClosestPoint& c) const {
    Line line;
    if (!c) return line;
    const auto& t = lines_.triangles[c.triangle];
    line.point = c.point;
    line.tangent = normalized(lines_.points[t[1]] - lines_.points[t[0]]);
    line.found = line.tangent != Vec3{};
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
