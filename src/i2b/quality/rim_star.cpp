#include "i2b/quality/rim_star.h"
#include "i2b/core/numbering.h"
#include "i2b/core/parallel.h"
#include "i2b/core/sort_unique.h"
#include "i2b/quality/dictionary_measure.h"
#include <algorithm>

namespace i2b {
namespace {

using Index = std::size_t;

bool has(const std::vector<std::int32_t>& loop, std::int32_t point) { return std::ranges::find(loop, point) != loop.end(); }

} // namespace

RimStar::RimStar(PolyMesh& mesh, const Rows& cellFaces) : mesh_(mesh), cellFaces_(cellFaces) {}

std::int32_t RimStar::nowOf(std::int32_t point) const {
    for (auto at = joined_.find(point); at != joined_.end(); at = joined_.find(point)) point = at->second;
    return point;
}

void RimStar::loopOf(std::int32_t face, const RimMove& move, std::vector<std::int32_t>& loop) const { loopOf(face, State::now, move, loop); }

void RimStar::loopOf(std::int32_t face, State state, const RimMove& move, std::vector<std::int32_t>& loop) const {
    loop.clear();
    for (std::int32_t p : mesh_.face(face)) {
        if (state == State::now) p = nowOf(p);
        if (p == move.gone && p >= 0) p = move.keep;
        if (loop.empty() || loop.back() != p) loop.push_back(p);
    }
    while (loop.size() > 1 && loop.back() == loop.front()) loop.pop_back();
}

std::vector<std::int32_t> RimStar::cellsAt(std::int32_t point, std::int32_t other, std::int32_t from) const {
    std::vector<std::int32_t> cells{from}, loop;
    for (Index i = 0; i < cells.size(); ++i) {
        for (const std::int32_t f : cellFaces_[cells[i]]) {
            if (f >= mesh_.internalFaces()) continue;
            const std::int32_t own = mesh_.owner[Index(f)], next = own == cells[i] ? mesh_.neighbour[Index(f)] : own;
            if (has(cells, next)) continue;
            loopOf(f, {}, loop);
            if (has(loop, point) || (other >= 0 && has(loop, other))) cells.push_back(next);
        }
    }
    std::sort(cells.begin(), cells.end());
    return cells;
}

std::vector<std::int32_t> RimStar::withNeighbours(const std::vector<std::int32_t>& cells) const {
    std::vector<std::int32_t> all = cells;
    for (const std::int32_t c : cells)
        for (const std::int32_t f : cellFaces_[c])
            if (f < mesh_.internalFaces()) all.push_back(mesh_.owner[Index(f)] == c ? mesh_.neighbour[Index(f)] : mesh_.owner[Index(f)]);
    sortUnique(all);
    return all;
}

bool RimStar::isWall(std::int32_t face) const {
    return std::ranges::any_of(mesh_.patches, [&](const Patch& p) { return p.type == "wall" && face >= p.start && face < p.start + p.count; });
}

std::vector<std::int32_t> RimStar::wallFaces(const std::vector<std::int32_t>& cells) const {
    std::vector<std::int32_t> faces;
    for (const std::int32_t c : cells)
        for (const std::int32_t f : cellFaces_[c])
            if (f >= mesh_.internalFaces() && isWall(f)) faces.push_back(f);
    return faces;
}

bool RimStar::mayJoin(const RimMove& move, const std::vector<std::int32_t>& star) const {
    std::vector<std::int32_t> loop, ofKeep, ofGone, third; // neighbours on the wall; third points of its triangles on the edge
    const std::vector<std::int32_t> walls = wallFaces(star);
    for (const std::int32_t c : star) {
        for (const std::int32_t f : cellFaces_[c]) {
            loopOf(f, {}, loop);
            const Index n = loop.size();
            if (n < 3) continue;
            const bool onWall = has(walls, f);
            Index keep = n, gone = n;
            for (Index i = 0; i < n; ++i) {
                if (loop[i] == move.keep) keep = i;
                if (loop[i] == move.gone) gone = i;
            }
            if (f >= mesh_.internalFaces() && !onWall && (keep < n || gone < n)) return false; // in a side of the domain
            if (onWall && keep < n) ofKeep.push_back(loop[(keep + 1) % n]), ofKeep.push_back(loop[(keep + n - 1) % n]);
            if (onWall && gone < n) ofGone.push_back(loop[(gone + 1) % n]), ofGone.push_back(loop[(gone + n - 1) % n]);
            if (keep == n || gone == n) continue;
            if ((keep + 1) % n != gone && (gone + 1) % n != keep) return false;
            if (n > 3) continue;
            if (!onWall) return false; // two sides of a cell would be one
            third.push_back(loop[3 - keep - gone]);
        }
    }
    sortUnique(ofKeep), sortUnique(ofGone), sortUnique(third);
    std::vector<std::int32_t> common;
    std::ranges::set_intersection(ofKeep, ofGone, std::back_inserter(common));
    return common == third && ofKeep.size() + ofGone.size() - third.size() >= 5;
}

LocalEdits::Surroundings RimStar::around(State state, const RimMove& move, const std::vector<std::int32_t>& star) const {
    Numbering cells, points;
    std::vector<std::int32_t> faces, loop;
    for (const std::int32_t c : withNeighbours(star)) {
        cells.add(c);
        faces.insert(faces.end(), cellFaces_[c].begin(), cellFaces_[c].end());
    }
    cells.close();
    sortUnique(faces);
    for (const std::int32_t f : faces) {
        loopOf(f, state, move, loop);
        if (loop.size() > 2) std::ranges::for_each(loop, [&](std::int32_t p) { points.add(p); });
    }
    points.close();
    LocalEdits::Surroundings result;
    PolyMesh& mesh = result.mesh;
    mesh.cells = static_cast<std::int32_t>(cells.items().size());
    for (const std::int32_t c : cells.items()) result.outerCells.push_back(!std::ranges::binary_search(star, c));
    const auto placeOf = [&](std::int32_t p) {
        const auto at = state == State::first ? first_.find(p) : first_.end();
        return p == move.keep ? move.to : at != first_.end() ? at->second : mesh_.points[Index(p)];
    };
    for (const std::int32_t p : points.items()) mesh.points.push_back(placeOf(p));
    mesh.faceOffsets.push_back(0);
    const auto isOuter = [&](std::int32_t cell) { return cell < 0 || result.outerCells[Index(cell)] != 0; };
    for (const bool inner : {true, false}) {
        for (const std::int32_t f : faces) {
            const std::int32_t own = cells.placeOf(mesh_.owner[Index(f)]), next = f < mesh_.internalFaces() ? cells.placeOf(mesh_.neighbour[Index(f)]) : -1;
            if ((own >= 0 && next >= 0) != inner) continue;
            loopOf(f, state, move, loop);
            if (loop.size() < 3) continue;
            if (own < 0) std::reverse(loop.begin() + 1, loop.end());
            for (const std::int32_t p : loop) mesh.faceVertices.push_back(points.placeOf(p));
            mesh.faceOffsets.push_back(static_cast<std::uint32_t>(mesh.faceVertices.size()));
            mesh.owner.push_back(inner ? own : std::max(own, next));
            if (inner) mesh.neighbour.push_back(next);
            result.outerFaces.push_back(isOuter(own) && isOuter(next));
        }
    }
    mesh.patches = {{"rest", "patch", mesh.internalFaces(), mesh.faces() - mesh.internalFaces()}};
    return result;
}

bool RimStar::isNoWorse(const RimMove& move, const std::vector<std::int32_t>& star, const DictionaryLimits& limits) const {
    const LocalEdits::Surroundings before = around(State::first, {}, star), after = around(State::now, move, star);
    const Verdict was = judge(before, limits), now = judge(after, limits);
    for (Index i = 0; i < now.counts.size(); ++i)
        if (now.counts[i] > was.counts[i]) return false;
    // Of faces within the limits the worst stay as far within them as repair leaves others.
    const DictionaryBounds bounds(limits);
    if (now.nonOrthogonality > std::max(was.nonOrthogonality, 0.9923 * limits.nonOrthogonality)) return false;
    if (now.skewness > std::max(was.skewness, 0.95 * std::min(bounds.internalSkewness, bounds.boundarySkewness))) return false;
    return now.faces <= was.faces && now.concave <= was.concave && hasNoMoreTwice(after.mesh, before.mesh);
}

void RimStar::apply(const RimMove& move) {
    if (move.gone >= 0) joined_[move.gone] = move.keep;
    Vec3& place = mesh_.points[Index(move.keep)];
    first_.try_emplace(move.keep, place);
    place = move.to;
}

void RimStar::takeBack(const RimMove& move) {
    joined_.erase(move.gone);
    mesh_.points[Index(move.keep)] = first_.at(move.keep);
}

std::vector<std::int32_t> RimStar::rewrite() {
    std::vector<std::int32_t> lost;
    if (joined_.empty()) return lost;
    PolyMesh& mesh = mesh_;
    std::vector<std::int32_t> number(mesh.points.size()), gone;
    for (const auto& [point, to] : joined_) gone.push_back(point);
    std::ranges::sort(gone);
    parallelFor(number.size(), [&](Index p) {
        const auto n = static_cast<std::int32_t>(p);
        number[p] = n - static_cast<std::int32_t>(std::ranges::lower_bound(gone, n) - gone.begin());
    });
    for (const std::int32_t p : gone) number[Index(p)] = number[Index(nowOf(p))];
    for (Index i = 0; i < gone.size(); ++i) { // what lies between two that are gone moves down
        const auto from = mesh.points.begin() + gone[i], to = i + 1 < gone.size() ? mesh.points.begin() + gone[i + 1] : mesh.points.end();
        std::move(from + 1, to, from - static_cast<std::ptrdiff_t>(i));
    }
    mesh.points.resize(mesh.points.size() - gone.size());
    // What is left of each face: counted, placed, filled in.
    const auto faces = Index(mesh.faces()), internal = Index(mesh.internalFaces());
    const auto forLeft = [&](Index f, const auto& take) { // points that differ from the one before
        const auto v = mesh.face(static_cast<std::int32_t>(f));
        for (Index i = 0; i < v.size(); ++i)
            if (number[Index(v[i])] != number[Index(v[i > 0 ? i - 1 : v.size() - 1])]) take(number[Index(v[i])]);
    };
    RawVector<std::uint32_t> offsets(faces + 1);
    offsets[0] = 0;
    parallelFor(faces, [&](Index f) {
        std::uint32_t left = 0;
        forLeft(f, [&](std::int32_t) { ++left; });
        offsets[f + 1] = left > 2 ? left : 0;
    });
    for (Index f = 0; f < faces; ++f) offsets[f + 1] += offsets[f];
    RawVector<std::int32_t> vertices(offsets[faces]);
    parallelFor(faces, [&](Index f) {
        std::uint32_t at = offsets[f];
        if (offsets[f + 1] > at) forLeft(f, [&](std::int32_t p) { vertices[at++] = p; });
    });
    mesh.faceVertices = std::move(vertices);
    // Faces of the boundary alone are gone: mayJoin().
    Index to = internal;
    std::int32_t start = mesh.internalFaces();
    for (Patch& patch : mesh.patches) {
        const Index first = Index(patch.start), end = first + Index(patch.count);
        for (Index f = first; f < end; ++f) {
            if (offsets[f + 1] == offsets[f]) {
                lost.push_back(mesh.owner[f]);
                continue;
            }
            mesh.owner[to] = mesh.owner[f];
            offsets[++to] = offsets[f + 1];
        }
        patch.start = start;
        start = static_cast<std::int32_t>(to);
        patch.count = start - patch.start;
    }
    offsets.resize(to + 1), mesh.owner.resize(to);
    mesh.faceOffsets = std::move(offsets);
    std::ranges::sort(lost);
    return lost;
}

} // namespace i2b
