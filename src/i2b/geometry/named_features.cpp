#include "i2b/geometry/named_features.h"
#include "i2b/geometry/feature_edges.h"
#include "i2b/geometry/part_names.h"
#include <algorithm>
#include <fmt/format.h>
#include <optional>

namespace i2b {
namespace {

using Rule = std::optional<BoxEdges>; // of the last box that holds a place; none: the angle decides

Rule ruleAt(const std::vector<FeatureBox>& boxes, const Vec3& p) {
    for (std::size_t i = boxes.size(); i-- > 0;)
        if (boxes[i].box.contains(p)) return boxes[i].edges;
    return {};
}

// Adds where, along a + t (b - a) and between 0 and 1, the segment enters or leaves the box.
void addCrossings(const Vec3& a, const Vec3& b, const Box& box, std::vector<double>& at) {
    double enter = 0, leave = 1;
    for (int axis = 0; axis < 3; ++axis) {
        const double d = b[axis] - a[axis];
        if (d == 0) {
            if (a[axis] < box.lo[axis] || a[axis] > box.hi[axis]) return;
            continue;
        }
        const auto [first, second] = std::minmax({(box.lo[axis] - a[axis]) / d, (box.hi[axis] - a[axis]) / d});
        enter = std::max(enter, first);
        leave = std::min(leave, second);
    }
    if (enter >= leave) return;
    at.push_back(enter);
    at.push_back(leave);
}

struct Piece {
    double from, to; // along the edge, 0 to 1
    Rule rule;
};

// Neighbours have different rules.
std::vector<Piece> piecesOf(const Vec3& a, const Vec3& b, const std::vector<FeatureBox>& boxes, double tolerance) {
    std::vector<double> at;
    for (const FeatureBox& box : boxes) addCrossings(a, b, box.box, at);
    std::sort(at.begin(), at.end());
    const double shortest = tolerance / norm(b - a);
    std::vector<Piece> pieces;
    double from = 0;
    const auto add = [&](double to) {
        const Rule rule = ruleAt(boxes, a + (b - a) * ((from + to) / 2));
        if (!pieces.empty() && pieces.back().rule == rule)
            pieces.back().to = to;
        else
            pieces.push_back({from, to, rule});
        from = to;
    };
    for (const double t : at)
        if (t - from > shortest && 1 - t > shortest) add(t);
    add(1);
    return pieces;
}

double angleBy(BoxEdges rule) { return rule == BoxEdges::all ? boxAngle : 180; }

void judgeBy(const Rule& rule, FeatureEdge& edge) {
    if (!rule) return; // as the angle says
    edge.kinds &= static_cast<std::uint8_t>(~foldKinds);
    edge.kinds |= kindOfFold(double(edge.angle), {angleBy(*rule), mostCrease});
    if (*rule == BoxEdges::none) edge.kinds &= static_cast<std::uint8_t>(~bitOf(EdgeKind::named));
}

bool before(const FeatureEdge& x, const FeatureEdge& y) { return EdgeKey{x.a, x.b} < EdgeKey{y.a, y.b}; }

} // namespace

double angleAt(const FeatureOptions& options, const Vec3& p) {
    const Rule rule = ruleAt(options.boxes, p);
    return rule ? angleBy(*rule) : options.angle;
}

std::vector<bool> namedParts(const std::vector<Part>& parts, const std::vector<std::string>& names,
                             std::vector<std::string>& notes) {
    std::vector<bool> isNamed(names.empty() ? 0 : parts.size());
    for (const std::string& name : names) {
        const NamePattern pattern(name);
        bool found = false;
        for (std::size_t p = 0; p < parts.size(); ++p)
            if (pattern.matches(parts[p].name)) isNamed[p] = found = true;
        if (!found) notes.push_back(fmt::format("no part is named '{}', which is to be a feature", name));
    }
    return isNamed;
}

void applyBoxes(const std::vector<FeatureBox>& boxes, double tolerance, FeatureSoup& soup,
                RawVector<FeatureEdge>& edges) {
    if (boxes.empty()) return;
    const std::size_t count = edges.size();
    for (std::size_t i = 0; i < count; ++i) {
        const FeatureEdge whole = edges[i];
        // A flat edge is nothing in any box, and a line from a file is a feature in every one.
        if (whole.kinds == 0 && double(whole.angle) <= boxAngle) continue;
        if (std::binary_search(soup.lines.begin(), soup.lines.end(), EdgeKey{whole.a, whole.b})) continue;
        const Vec3 a = soup.points[whole.a], b = soup.points[whole.b];
        const std::vector<Piece> pieces = piecesOf(a, b, boxes, tolerance);
        std::uint32_t from = whole.a;
        for (std::size_t k = 0; k < pieces.size(); ++k) {
            FeatureEdge piece = whole;
            std::uint32_t to = whole.b;
            if (k + 1 < pieces.size()) {
                to = static_cast<std::uint32_t>(soup.points.size());
                soup.points.push_back(a + (b - a) * pieces[k].to);
            }
            piece.a = std::min(from, to), piece.b = std::max(from, to);
            judgeBy(pieces[k].rule, piece);
            if (k == 0)
                edges[i] = piece;
            else
                edges.push_back(piece);
            from = to;
        }
    }
    std::sort(edges.begin(), edges.end(), before);
}

void addLines(const FeatureSoup& soup, RawVector<FeatureEdge>& edges) {
    if (soup.lines.empty()) return;
    const std::size_t count = edges.size();
    for (const EdgeKey& line : soup.lines) {
        const FeatureEdge edge{line.a, line.b, bitOf(EdgeKind::named), 0};
        const auto end = edges.begin() + static_cast<std::ptrdiff_t>(count);
        const auto found = std::lower_bound(edges.begin(), end, edge, before);
        if (found != end && found->a == line.a && found->b == line.b)
            found->kinds |= bitOf(EdgeKind::named);
        else
            edges.push_back(edge);
    }
    std::sort(edges.begin(), edges.end(), before);
}

void addCorners(const std::vector<std::uint32_t>& more, std::vector<std::uint32_t>& corners) {
    corners.insert(corners.end(), more.begin(), more.end());
    std::sort(corners.begin(), corners.end());
    corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
}

void noteFarLines(const Surface& surface, const FeatureLines& lines, std::vector<std::string>& notes) {
    Box box;
    for (const Vec3& p : lines.points) box.add(p);
    if (!lines.points.empty() && !box.overlaps(surface.bounds()))
        notes.push_back("the feature lines lie apart from the geometry: they may be in another unit");
}

} // namespace i2b
