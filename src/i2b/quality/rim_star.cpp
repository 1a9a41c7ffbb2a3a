#include "i2b/quality/rim_star.h"
#include "i2b/core/numbering.h"
#include "i2b/core/sort_unique.h"
#include "i2b/quality/dictionary_measure.h"
#include <algorithm>
#include <numeric>

namespace i2b {
namespace {

using Index = std::size_t;

bool has(const std::vector<std::int32_t>& loop, std::int32_t point) { return std::ranges::find(loop, point) != loop.end(); }

} // namespace

RimStar::RimStar(PolyMesh& mesh, const Rows& cellFaces) : mesh_(mesh), cellFaces_(cellFaces), joined_(mesh.points.size()) {
    std::iota(joined_.begin(), joined_.end(), 0);
}

void RimStar::loopOf(std::int32_t face, const RimMove& move, std::vector<std::int32_t>& loop) const { loopOf(face, State::now, move, loop); }

void RimStar::loopOf(std::int32_t face, State state, const RimMove& move, std::vector<std::int32_t>& loop) const {
    loop.clear();
    for (std::int32_t p : mesh_.face(face)) {
        while (state == State::now && joined_[Index(p)] != p) p = joined_[Index(p)];
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
    if (move.gone >= 0) joined_[Index(move.gone)] = move.keep;
    Vec3& place = mesh_.points[Index(move.keep)];
    first_.try_emplace(move.keep, place);
    place = move.to;
}

void RimStar::takeBack(const RimMove& move) {
    if (move.gone >= 0) joined_[Index(move.gone)] = move.gone;
    mesh_.points[Index(move.keep)] = first_.at(move.keep);
}

std::vector<std::int32_t> RimStar::rewrite() {
    PolyMesh& mesh = mesh_;
    std::vector<std::int32_t> lost, loop, lostIn(mesh.patches.size(), 0), number(mesh.points.size());
    Index points = 0, inner = 0;
    for (Index p = 0; p < number.size(); ++p) {
        if (isGone(static_cast<std::int32_t>(p))) continue;
        number[p] = static_cast<std::int32_t>(points);
        mesh.points[points++] = mesh.points[p];
    }
    mesh.points.resize(points);
    RawVector<std::uint32_t> offsets; // the old ones are asked for to the end; all else shrinks in place
    offsets.reserve(mesh.faceOffsets.size());
    offsets.push_back(0);
    Index patch = 0;
    for (std::int32_t f = 0, faces = mesh.faces(), internal = mesh.internalFaces(); f < faces; ++f) {
        while (f >= internal && f >= mesh.patches[patch].start + mesh.patches[patch].count) ++patch;
        loopOf(f, {}, loop);
        const std::int32_t own = mesh.owner[Index(f)];
        if (loop.size() < 3) { // of the boundary: mayJoin()
            ++lostIn[patch];
            lost.push_back(own);
            continue;
        }
        mesh.owner[offsets.size() - 1] = own;
        if (f < internal) mesh.neighbour[inner++] = mesh.neighbour[Index(f)];
        std::uint32_t at = offsets.back();
        for (const std::int32_t p : loop) mesh.faceVertices[at++] = number[Index(p)];
        offsets.push_back(at);
    }
    mesh.owner.resize(offsets.size() - 1), mesh.faceVertices.resize(offsets.back());
    mesh.faceOffsets = std::move(offsets);
    auto start = static_cast<std::int32_t>(inner);
    for (Index i = 0; i < mesh.patches.size(); ++i) {
        mesh.patches[i].start = start, mesh.patches[i].count -= lostIn[i];
        start += mesh.patches[i].count;
    }
    std::sort(lost.begin(), lost.end());
    return lost;
}

} // namespace i2b
