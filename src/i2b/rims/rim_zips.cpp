#include "i2b/rims/rim_zips.h"
#include "i2b/core/parallel.h"
#include "i2b/core/sort_unique.h"
#include "i2b/edit/layer_column.h"
#include "i2b/fit/features.h"
#include "i2b/quality/fit_wall.h"
#include "i2b/rims/rim_rows.h"
#include <algorithm>
#include <map>
#include <optional>

namespace i2b {
namespace {

using Index = std::size_t;
using Column = LayerColumn;
using Loop = Column::Loop;
constexpr Index mostFaces = 6; // of a group

class ZipFinder {
  public:
    ZipFinder(const PolyMesh& mesh, const Rows& cellFaces, const ZipStar& star, const Wall& wall, const RimRows& rows, const FeatureIndex& rims, std::int32_t firstLayerCell)
        : mesh_(mesh), cellFaces_(cellFaces), star_(star), wall_(wall), rows_(rows), rims_(rims), firstLayerCell_(firstLayerCell) {}
    std::vector<Zip> run();

  private:
    const Vec3& at(std::int32_t point) const { return mesh_.points[Index(point)]; }
    const RimRows::Node& node(std::int32_t point) const { return rows_.nodes[nodePlace(wall_, point)]; }
    std::vector<std::vector<Index>> groups() const;
    std::optional<Column> columnOf(Index face) const { return layerColumn(mesh_, cellFaces_, wall_.faces[face], firstLayerCell_); }
    std::optional<Zip> zipOf(const std::vector<Index>& faces) const;
    std::optional<Loop> outlineOf(const std::vector<Loop>& loops) const;
    std::map<std::int32_t, std::int32_t> joinedOf(const Loop& outline) const;
    bool order(const Loop& outline, const std::map<std::int32_t, std::int32_t>& joined, Zip& zip) const;
    bool uniteCells(const std::vector<Column>& columns, Zip& zip) const;
    void addMoves(const std::vector<Column>& columns, const std::map<std::int32_t, std::int32_t>& joined, Zip& zip) const;
    void addColumns(const std::vector<Index>& faces, std::vector<Column> columns, Zip& zip) const;

    const PolyMesh& mesh_;
    const Rows& cellFaces_;
    const ZipStar& star_;
    const Wall& wall_;
    const RimRows& rows_;
    const FeatureIndex& rims_;
    std::int32_t firstLayerCell_;
};

// Faces that hang together through edges whose ends stay two.
std::vector<std::vector<Index>> ZipFinder::groups() const {
    std::map<Index, std::vector<Index>> beside;
    for (const RimRows::Edge& e : rows_.across) {
        if (node(e.a).partner == e.b) continue;
        beside[e.face].push_back(e.other), beside[e.other].push_back(e.face);
    }
    std::vector<std::vector<Index>> all;
    std::vector<std::uint8_t> seen(wall_.faces.size(), 0);
    for (Index f = 0; f < seen.size(); ++f) {
        if (!rows_.isBefore[f] || seen[f]) continue;
        seen[f] = 1;
        std::vector<Index> group{f};
        for (Index i = 0; i < group.size(); ++i)
            for (const Index other : beside[group[i]])
                if (!seen[other]) seen[other] = 1, group.push_back(other);
        if (group.size() > mostFaces) continue;
        std::ranges::sort(group);
        all.push_back(std::move(group));
    }
    return all;
}

// Of faces that hang together, all in the same sense: what is around them; none where that is more than one loop.
std::optional<Loop> ZipFinder::outlineOf(const std::vector<Loop>& loops) const {
    std::map<std::pair<std::int32_t, std::int32_t>, int> edges;
    for (const Loop& loop : loops)
        for (Index i = 0; i < loop.size(); ++i) ++edges[{loop[i], loop[(i + 1) % loop.size()]}];
    std::map<std::int32_t, std::int32_t> next;
    for (const auto& [edge, times] : edges) {
        if (times > 1) return {};
        if (edges.contains({edge.second, edge.first})) continue;
        if (!next.try_emplace(edge.first, edge.second).second) return {};
    }
    if (next.size() < 3) return {};
    Loop outline{next.begin()->first};
    for (std::int32_t p = next.at(outline.front()); p != outline.front(); p = next.at(p)) {
        if (outline.size() > next.size() || !next.contains(p)) return {};
        outline.push_back(p);
    }
    return outline.size() == next.size() ? std::optional(std::move(outline)) : std::nullopt;
}

// Per node around a group the one that it is made one with, or itself: its partner, or who stands alone and so near that no edge would be
// left between them.
std::map<std::int32_t, std::int32_t> ZipFinder::joinedOf(const Loop& outline) const {
    std::map<std::int32_t, std::int32_t> joined;
    const auto partnerIn = [&](std::int32_t p) { return std::ranges::find(outline, node(p).partner) == outline.end() ? -1 : node(p).partner; };
    for (const std::int32_t p : outline) joined[p] = partnerIn(p) >= 0 ? std::min(p, partnerIn(p)) : p;
    struct Near { double distance; std::int32_t a, b; };
    std::vector<Near> near;
    for (Index i = 0; i < outline.size(); ++i) {
        for (Index k = i + 2; k < outline.size(); ++k) {
            const std::int32_t a = outline[i], b = outline[k];
            if ((i == 0 && k + 1 == outline.size()) || node(a).partner >= 0 || node(b).partner >= 0) continue;
            const double distance = norm(node(a).to - node(b).to) / node(a).h;
            if (distance < RimRows::tooNear) near.push_back({distance, std::min(a, b), std::max(a, b)});
        }
    }
    std::ranges::sort(near, [](const Near& x, const Near& y) { return std::tie(x.distance, x.a, x.b) < std::tie(y.distance, y.a, y.b); });
    std::vector<std::int32_t> taken;
    for (const Near& n : near) {
        const auto isTaken = [&](std::int32_t p) { return std::ranges::find(taken, p) != taken.end(); };
        if (isTaken(n.a) || isTaken(n.b)) continue;
        taken.insert(taken.end(), {n.a, n.b});
        joined[n.b] = n.a;
    }
    return joined;
}

// Puts the nodes around a group in their order along the rim, and leads edges through those between their ends; whether the two rows run to
// and fro between two ends.
bool ZipFinder::order(const Loop& outline, const std::map<std::int32_t, std::int32_t>& joined, Zip& zip) const {
    std::vector<std::int32_t> nodes = outline;
    std::ranges::sort(nodes);
    // Along the line between the two that are farthest apart.
    std::int32_t from = -1, to = -1;
    double farthest = 0;
    for (const std::int32_t a : nodes)
        for (const std::int32_t b : nodes)
            if (const double d = norm2(node(a).to - node(b).to); d > farthest) farthest = d, from = a, to = b;
    if (from < 0) return false;
    std::vector<std::pair<double, std::int32_t>> along;
    for (const std::int32_t p : nodes)
        if (joined.at(p) == p) along.emplace_back(dot(node(p).to - node(from).to, node(to).to - node(from).to), p);
    std::ranges::sort(along);
    std::map<std::int32_t, Index> rank;
    for (Index i = 0; i < along.size(); ++i) rank[along[i].second] = i;
    for (const std::int32_t p : nodes)
        if (!rank.contains(p)) rank[p] = rank.at(joined.at(p));
    std::vector<Index> way;
    for (const std::int32_t p : outline)
        if (way.empty() || way.back() != rank.at(p)) way.push_back(rank.at(p));
    while (way.size() > 1 && way.back() == way.front()) way.pop_back();
    const Index n = way.size();
    if (n < 2) return false;
    Index turns = 0;
    for (Index i = 0; i < n; ++i) turns += (way[(i + 1) % n] > way[i]) != (way[(i + n - 1) % n] < way[i]);
    if (n > 2 && turns != 2) return false;
    for (Index i = 0; i < outline.size(); ++i) {
        const std::int32_t a = outline[i], b = outline[(i + 1) % outline.size()];
        if (node(a).partner == b) continue;
        const Index lo = rank.at(std::min(a, b)), hi = rank.at(std::max(a, b));
        std::vector<std::int32_t> through;
        for (Index r = std::min(lo, hi) + 1; r < std::max(lo, hi); ++r) through.push_back(along[r].second);
        if (through.empty()) continue;
        if (lo > hi) std::ranges::reverse(through);
        zip.through.emplace_back(edgeKey(a, b), std::move(through));
    }
    return true;
}

// The cells over the faces become one in each layer, and faces between the same two cells one face.
bool ZipFinder::uniteCells(const std::vector<Column>& columns, Zip& zip) const {
    if (columns.size() < 2) return true;
    std::map<std::int32_t, std::int32_t> cellOf;
    for (Index j = 0; j < columns.front().cells.size(); ++j) {
        std::int32_t lowest = columns.front().cells[j];
        for (const Column& c : columns) lowest = std::min(lowest, c.cells[j]);
        for (const Column& c : columns) cellOf[c.cells[j]] = lowest;
    }
    zip.cells.assign(cellOf.begin(), cellOf.end());
    const auto now = [&](std::int32_t cell) { const auto at = cellOf.find(cell); return at == cellOf.end() ? cell : at->second; };
    std::vector<std::int32_t> faces;
    for (const auto& [cell, to] : cellOf) faces.insert(faces.end(), cellFaces_[cell].begin(), cellFaces_[cell].end());
    sortUnique(faces);
    std::map<std::pair<std::int32_t, std::int32_t>, std::vector<std::int32_t>> between;
    for (const std::int32_t f : faces) {
        if (f >= mesh_.internalFaces()) continue;
        const std::int32_t own = now(mesh_.owner[Index(f)]), next = now(mesh_.neighbour[Index(f)]);
        if (own != next) between[std::minmax(own, next)].push_back(f);
    }
    for (const auto& [cells, some] : between) {
        if (some.size() < 2) continue;
        std::vector<Loop> loops;
        const std::int32_t from = now(mesh_.owner[Index(some.front())]);
        for (const std::int32_t f : some) {
            const auto v = mesh_.face(f);
            loops.emplace_back(v.begin(), v.end());
            if (now(mesh_.owner[Index(f)]) != from) std::ranges::reverse(loops.back());
        }
        auto outline = outlineOf(loops);
        if (!outline) return false;
        zip.loops.emplace_back(some.front(), std::move(*outline));
        zip.gone.insert(zip.gone.end(), some.begin() + 1, some.end());
    }
    return true;
}

void ZipFinder::addMoves(const std::vector<Column>& columns, const std::map<std::int32_t, std::int32_t>& joined, Zip& zip) const {
    std::map<std::int32_t, Loop> over; // per point of the wall those above it, the front's last
    for (const Column& c : columns) {
        for (Index i = 0; i < c.levels.front().size(); ++i) {
            Loop& points = over[c.levels.front()[i]];
            if (!points.empty()) continue;
            for (Index j = 1; j < c.levels.size(); ++j) points.push_back(c.levels[j][i]);
        }
    }
    for (const auto& [point, above] : over) {
        const auto is = joined.find(point);
        const std::int32_t keep = is == joined.end() ? point : is->second;
        const auto other = std::ranges::find_if(joined, [&](const auto& j) { return j.second == keep && j.first != keep; });
        const Vec3 to = other == joined.end() ? node(point).to : betweenOnRim(node(keep), node(other->first), rims_);
        zip.moves.push_back({keep, keep == point ? -1 : point, to});
        // Straight on: columns that leave both sides of a sheet at a right angle leave nothing between them.
        double length = norm(at(above.front()) - at(point)), way = 0;
        for (Index j = 0; j + 1 < above.size(); ++j) length += norm(at(above[j + 1]) - at(above[j]));
        for (Index j = 0; j + 1 < above.size(); ++j) {
            way += norm(at(above[j]) - at(j > 0 ? above[j - 1] : point));
            zip.moves.push_back({above[j], -1, to + (at(above.back()) - to) * (way / std::max(length, 1e-300))});
        }
    }
}

// How a column may be moved: as a whole, with the end on the front; its other points by themselves, in the measure of their layers; and bowed
// between its ends, most near the wall or in its middle.
void addBends(const Zip::Column& whole, std::vector<Zip::Column>& columns) {
    columns.push_back(whole);
    const Index inner = whole.points.size() - 1;
    if (inner == 0) return;
    for (Index j = 0; j < inner; ++j) columns.push_back({{whole.points[j]}, {whole.share[j + 1] - (j > 0 ? whole.share[j - 1] : 0)}});
    Zip::Column nearWall{{whole.points.begin(), whole.points.end() - 1}, {whole.share.begin(), whole.share.end() - 1}}, middle = nearWall;
    for (double& s : nearWall.share) s *= 6.75 * (1 - s) * (1 - s); // at most 1
    for (double& s : middle.share) s *= 4 * (1 - s);
    columns.push_back(std::move(nearWall));
    columns.push_back(std::move(middle));
}

// With those over the nodes beside the group, which may be moved with them.
void ZipFinder::addColumns(const std::vector<Index>& faces, std::vector<Column> columns, Zip& zip) const {
    std::vector<std::int32_t> around;
    for (const Column& c : columns)
        for (const std::int32_t p : c.levels.front()) around.insert(around.end(), rows_.facesOf.at(p).begin(), rows_.facesOf.at(p).end());
    sortUnique(around);
    for (const std::int32_t f : around)
        if (!std::ranges::binary_search(faces, Index(f)))
            if (auto column = columnOf(Index(f))) columns.push_back(std::move(*column));
    std::vector<std::int32_t> done;
    for (const Column& c : columns) {
        zip.star.insert(zip.star.end(), c.cells.begin(), c.cells.end());
        for (Index i = 0; i < c.levels.front().size(); ++i) {
            if (std::ranges::find(done, c.levels.front()[i]) != done.end()) continue;
            done.push_back(c.levels.front()[i]);
            Zip::Column over;
            double length = 0;
            for (Index j = 0; j < c.levels.size(); ++j) {
                const auto cells = star_.cellsAt(c.levels[j][i], -1, c.cells[std::min(j, c.cells.size() - 1)]);
                zip.star.insert(zip.star.end(), cells.begin(), cells.end());
                if (j == 0) continue;
                length += norm(at(c.levels[j][i]) - at(c.levels[j - 1][i]));
                over.points.push_back(c.levels[j][i]), over.share.push_back(length);
            }
            for (double& share : over.share) share /= std::max(length, 1e-300);
            addBends(over, zip.columns);
        }
    }
    sortUnique(zip.star);
}

std::optional<Zip> ZipFinder::zipOf(const std::vector<Index>& faces) const {
    std::vector<Column> columns;
    std::vector<Loop> loops;
    Zip zip;
    for (const Index f : faces) {
        auto column = columnOf(f);
        if (!column || (!columns.empty() && column->cells.size() != columns.front().cells.size())) return {};
        loops.push_back(column->levels.front());
        columns.push_back(std::move(*column));
        zip.gone.push_back(wall_.faces[f]);
    }
    const auto outline = outlineOf(loops);
    if (!outline) return {};
    const std::map<std::int32_t, std::int32_t> joined = joinedOf(*outline);
    if (!order(*outline, joined, zip) || !uniteCells(columns, zip)) return {};
    zip.h = node(outline->front()).h;
    addMoves(columns, joined, zip);
    addColumns(faces, std::move(columns), zip);
    return zip;
}

std::vector<Zip> ZipFinder::run() {
    const std::vector<std::vector<Index>> all = groups();
    std::vector<std::optional<Zip>> found(all.size());
    parallelFor(all.size(), [&](Index i) { found[i] = zipOf(all[i]); }, 1);
    std::vector<Zip> zips;
    for (auto& zip : found)
        if (zip) zips.push_back(std::move(*zip));
    return zips;
}

} // namespace

std::vector<Zip> findRimZips(const PolyMesh& mesh, const Rows& cellFaces, const ZipStar& star, const Wall& wall, const Front& front, const SurfaceIndex& index, const FeatureIndex& rims,
                                std::int32_t firstLayerCell) {
    const RimRows rows = findRimRows(mesh, wall, front, index, rims);
    return ZipFinder(mesh, cellFaces, star, wall, rows, rims, firstLayerCell).run();
}

} // namespace i2b
