#include "i2b/edit/zip_star.h"
#include "i2b/core/collect.h"
#include "i2b/core/parallel.h"
#include "i2b/core/parallel_sort_unique.h"
#include "i2b/core/sort_unique.h"
#include "i2b/edit/small_mesh.h"
#include "i2b/quality/dictionary_measure.h"
#include <algorithm>

namespace i2b {
namespace {

using Index = std::size_t;

bool has(const std::vector<std::int32_t>& loop, std::int32_t point) { return std::ranges::find(loop, point) != loop.end(); }

} // namespace

std::uint64_t edgeKey(std::int32_t a, std::int32_t b) {
    return static_cast<std::uint64_t>(std::min(a, b)) << 32 | static_cast<std::uint64_t>(std::max(a, b));
}

ZipStar::ZipStar(PolyMesh& mesh, const Rows& cellFaces)
    : mesh_(mesh), cellFaces_(cellFaces), isJoined_(mesh.points.size()), isZipped_(Index(mesh.faces())) {}

std::int32_t ZipStar::nowOf(std::int32_t point) const {
    if (!isJoined_[Index(point)]) return point;
    for (auto at = joined_.find(point); at != joined_.end(); at = joined_.find(point)) point = at->second;
    return point;
}

void ZipStar::loopOf(std::int32_t face, const PointMove& move, std::vector<std::int32_t>& loop) const { loopOf(face, State::now, move, loop); }

namespace {

// Appends a point to a loop, but not the same one twice; closed: the end is before the beginning.
void addPoint(std::vector<std::int32_t>& loop, std::int32_t point) {
    if (loop.empty() || loop.back() != point) loop.push_back(point);
}
void closeLoop(std::vector<std::int32_t>& loop) {
    while (loop.size() > 1 && loop.back() == loop.front()) loop.pop_back();
}

} // namespace

void ZipStar::loopOf(std::int32_t face, State state, const PointMove& move, std::vector<std::int32_t>& loop) const {
    loop.clear();
    std::span<const std::int32_t> points = mesh_.face(face);
    if (state == State::now && isZipped_[Index(face)]) {
        const auto place = Index(zippedFaces_.placeOf(face));
        points = std::span(loopPoints_).subspan(loopStart_[place], loopStart_[place + 1] - loopStart_[place]);
    }
    for (std::int32_t p : points) {
        if (state == State::now) p = nowOf(p);
        addPoint(loop, p == move.gone && p >= 0 ? move.keep : p);
    }
    closeLoop(loop);
}

// Of what the zips say, without a look at what is worked out.
void ZipStar::loopOfZipped(std::int32_t face, std::vector<std::int32_t>& loop) const {
    loop.clear();
    if (goneFaces_.contains(face)) return;
    std::span<const std::int32_t> points = mesh_.face(face);
    if (const auto at = loops_.find(face); at != loops_.end()) points = at->second;
    const auto add = [&](std::int32_t p) { addPoint(loop, nowOf(p)); };
    for (Index i = 0; i < points.size(); ++i) {
        const std::int32_t a = points[i], b = points[i + 1 == points.size() ? 0 : i + 1];
        add(a);
        const auto at = through_.find(edgeKey(a, b));
        if (at == through_.end()) continue;
        if (a < b) std::for_each(at->second.begin(), at->second.end(), add);
        else std::for_each(at->second.rbegin(), at->second.rend(), add);
    }
    closeLoop(loop);
}

void ZipStar::resolveLoops() {
    zippedFaces_ = {};
    for (const std::int32_t c : zipped_)
        for (const std::int32_t f : cellFaces_[c]) {
            if (isZipped_[Index(f)]) continue;
            isZipped_[Index(f)] = true;
            zippedFaces_.add(f);
        }
    zippedFaces_.close();
    const std::vector<std::int32_t>& faces = zippedFaces_.items();
    loopStart_.assign(faces.size() + 1, 0);
    loopPoints_ = collect<std::int32_t>(faces.size(), [&](Index i, const auto& put) {
        std::vector<std::int32_t> loop;
        loopOfZipped(faces[i], loop);
        loopStart_[i] = loop.size();
        for (const std::int32_t p : loop) put(p);
    }, 1024);
    exclusiveScan(loopStart_);
}

std::int32_t ZipStar::cellNow(std::int32_t cell) const {
    const auto at = cellOf_.find(cell);
    return at == cellOf_.end() ? cell : at->second;
}

std::vector<std::int32_t> ZipStar::withMembers(std::vector<std::int32_t> cells) const {
    if (members_.empty()) return cells;
    for (Index i = 0, n = cells.size(); i < n; ++i) {
        const auto at = members_.find(cellNow(cells[i]));
        if (at != members_.end()) cells.insert(cells.end(), at->second.begin(), at->second.end());
    }
    sortUnique(cells);
    return cells;
}

bool ZipStar::isWithin(std::int32_t face) const {
    return face < mesh_.internalFaces() && cellNow(mesh_.owner[Index(face)]) == cellNow(mesh_.neighbour[Index(face)]);
}

void ZipStar::use(const std::vector<Zip>& zips, const std::map<std::int32_t, Vec3>& places) {
    for (const auto& [point, place] : first_) mesh_.points[Index(point)] = place;
    joined_.clear(), first_.clear(), goneFaces_.clear(), loops_.clear(), through_.clear(), cellOf_.clear(), members_.clear(), zipped_.clear();
    isJoined_.assign(isJoined_.size(), false), isZipped_.assign(isZipped_.size(), false);
    for (const Zip& zip : zips) {
        for (const PointMove& move : zip.moves) apply(move);
        goneFaces_.insert(zip.gone.begin(), zip.gone.end());
        loops_.insert(zip.loops.begin(), zip.loops.end());
        through_.insert(zip.through.begin(), zip.through.end());
        cellOf_.insert(zip.cells.begin(), zip.cells.end());
        for (const auto& [cell, now] : zip.cells) members_[now].push_back(cell);
        zipped_.insert(zipped_.end(), zip.star.begin(), zip.star.end());
    }
    for (const auto& [point, place] : places) apply({point, -1, place});
    for (auto& [now, cells] : members_) std::ranges::sort(cells);
    sortUnique(zipped_);
    resolveLoops();
}

bool ZipStar::isSound(const Zip& zip) const {
    std::vector<std::int32_t> loop, sorted;
    std::vector<std::uint64_t> edges; // of a cell: each is of two faces
    const std::vector<std::int32_t> cells = withMembers(zip.star);
    for (const std::int32_t c : cells) {
        const auto members = members_.find(cellNow(c));
        if (members != members_.end() && c != members->second.front()) continue;
        edges.clear();
        for (const std::int32_t member : members == members_.end() ? std::vector{c} : members->second) {
            for (const std::int32_t f : cellFaces_[member]) {
                if (goneFaces_.contains(f) || isWithin(f)) continue;
                loopOf(f, {}, loop);
                if (loop.size() < 3) {
                    if (f < mesh_.internalFaces() || !isWall(f)) return false;
                    continue;
                }
                for (Index i = 0; i < loop.size(); ++i) edges.push_back(edgeKey(loop[i], loop[(i + 1) % loop.size()]));
                sorted = loop;
                std::ranges::sort(sorted);
                if (std::ranges::adjacent_find(sorted) != sorted.end()) return false;
            }
        }
        std::ranges::sort(edges);
        for (Index i = 0; i < edges.size(); i += 2)
            if (i + 1 == edges.size() || edges[i] != edges[i + 1] || (i + 2 < edges.size() && edges[i + 2] == edges[i])) return false;
    }
    return true;
}

std::vector<std::int32_t> ZipStar::cellsAt(std::int32_t point, std::int32_t other, std::int32_t from) const {
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

std::vector<std::int32_t> ZipStar::withNeighbours(const std::vector<std::int32_t>& cells) const {
    std::vector<std::int32_t> all = cells;
    for (const std::int32_t c : cells)
        for (const std::int32_t f : cellFaces_[c])
            if (f < mesh_.internalFaces()) all.push_back(mesh_.owner[Index(f)] == c ? mesh_.neighbour[Index(f)] : mesh_.owner[Index(f)]);
    sortUnique(all);
    return all;
}

bool ZipStar::isWall(std::int32_t face) const {
    return std::ranges::any_of(mesh_.patches, [&](const Patch& p) { return p.type == "wall" && face >= p.start && face < p.start + p.count; });
}

std::vector<std::int32_t> ZipStar::wallFaces(const std::vector<std::int32_t>& cells) const {
    std::vector<std::int32_t> faces;
    for (const std::int32_t c : cells)
        for (const std::int32_t f : cellFaces_[c])
            if (f >= mesh_.internalFaces() && isWall(f)) faces.push_back(f);
    return faces;
}

bool ZipStar::mayJoin(const PointMove& move, const std::vector<std::int32_t>& star) const {
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

LocalEdits::Surroundings ZipStar::around(const std::vector<std::int32_t>& cells, std::vector<std::int32_t>& points) const {
    return around(State::now, {}, cells, &points);
}

LocalEdits::Surroundings ZipStar::around(State state, const PointMove& move, const std::vector<std::int32_t>& star, std::vector<std::int32_t>* ids) const {
    const std::vector<std::int32_t> inner = withMembers(star);
    const auto nowOfCell = [&](std::int32_t cell) { return state == State::now ? cellNow(cell) : cell; };
    SmallMesh small;
    std::vector<std::int32_t> faces, loop;
    for (const std::int32_t c : inner) small.addCell(nowOfCell(c), true);
    for (const std::int32_t c : withMembers(withNeighbours(inner))) {
        small.addCell(nowOfCell(c), false);
        faces.insert(faces.end(), cellFaces_[c].begin(), cellFaces_[c].end());
    }
    sortUnique(faces);
    for (const std::int32_t f : faces) {
        const std::int32_t own = nowOfCell(mesh_.owner[Index(f)]), next = f < mesh_.internalFaces() ? nowOfCell(mesh_.neighbour[Index(f)]) : -1;
        if (own == next) continue;
        loopOf(f, state, move, loop);
        if (loop.size() >= 3) small.addFace(loop, own, next);
    }
    const auto placeOf = [&](std::int32_t p) {
        const auto at = state == State::first ? first_.find(p) : first_.end();
        return p == move.keep ? move.to : at != first_.end() ? at->second : mesh_.points[Index(p)];
    };
    return small.build(placeOf, ids);
}

bool ZipStar::isNoWorse(const PointMove& move, const std::vector<std::int32_t>& star, const DictionaryLimits& limits) const {
    const LocalEdits::Surroundings before = around(State::first, {}, star), after = around(State::now, move, star);
    return i2b::isNoWorse(judge(after, limits), judge(before, limits), limits) && hasNoMoreTwice(after.mesh, before.mesh);
}

Verdict ZipStar::before(const Zip& zip, const DictionaryLimits& limits) const {
    Verdict verdict = judge(around(State::first, {}, zip.star), limits);
    verdict.concave = std::numeric_limits<std::int64_t>::max();
    return verdict;
}

Verdict ZipStar::now(const Zip& zip, const DictionaryLimits& limits) const { return judge(around(State::now, {}, zip.star), limits); }

bool ZipStar::isNoWorse(const Zip& zip, const Verdict& before, const DictionaryLimits& limits) const {
    const LocalEdits::Surroundings after = around(State::now, {}, zip.star);
    if (!i2b::isNoWorse(judge(after, limits), before, limits)) return false;
    const std::int64_t twice = facesTwice(after.mesh);
    return twice == 0 || twice <= facesTwice(around(State::first, {}, zip.star).mesh);
}

void ZipStar::apply(const PointMove& move) {
    if (move.gone >= 0) joined_[move.gone] = move.keep, isJoined_[Index(move.gone)] = true;
    Vec3& place = mesh_.points[Index(move.keep)];
    first_.try_emplace(move.keep, place);
    place = move.to;
}

// Points that no face has any more, ascending.
std::vector<std::int32_t> ZipStar::pointsGone() const {
    const std::vector<std::int32_t>& faces = zippedFaces_.items();
    std::vector<std::int32_t> before, now, gone;
    for (const auto& [point, to] : joined_) before.push_back(point);
    const auto add = [&](std::vector<std::int32_t>& all, const auto& pointsOf) {
        const RawVector<std::int32_t> found = collect<std::int32_t>(faces.size(), [&](Index i, const auto& put) {
            for (const std::int32_t p : pointsOf(faces[i])) put(p);
        }, 1024);
        all.insert(all.end(), found.begin(), found.end());
        parallelSortUnique(all);
    };
    add(before, [&](std::int32_t f) { return mesh_.face(f); });
    add(now, [&](std::int32_t f) {
        std::vector<std::int32_t> loop;
        if (!isWithin(f)) loopOf(f, {}, loop);
        if (loop.size() < 3) loop.clear();
        return loop;
    });
    std::ranges::set_difference(before, now, std::back_inserter(gone));
    return gone;
}

std::vector<std::int32_t> ZipStar::rewrite() {
    std::vector<std::int32_t> lost;
    if (joined_.empty() && zipped_.empty()) return lost;
    PolyMesh& mesh = mesh_;
    // What is left of each face: counted, placed, filled in.
    const auto faces = Index(mesh.faces()), internal = Index(mesh.internalFaces());
    const auto take = [&](Index f, std::vector<std::int32_t>& loop) {
        const auto face = static_cast<std::int32_t>(f);
        loopOf(face, {}, loop);
        if (loop.size() < 3 || (isZipped_[f] && isWithin(face))) loop.clear();
    };
    const std::vector<std::int32_t> gone = pointsGone();
    std::vector<std::int32_t> number(mesh.points.size());
    parallelFor(number.size(), [&](Index p) {
        const auto n = static_cast<std::int32_t>(p);
        number[p] = n - static_cast<std::int32_t>(std::ranges::lower_bound(gone, n) - gone.begin());
    });
    constexpr Index chunk = 4096;
    RawVector<std::uint32_t> offsets(faces + 1);
    offsets[0] = 0;
    parallelChunks(faces, chunk, [&](Index begin, Index end, Index) {
        std::vector<std::int32_t> loop;
        for (Index f = begin; f < end; ++f) take(f, loop), offsets[f + 1] = static_cast<std::uint32_t>(loop.size());
    });
    for (Index f = 0; f < faces; ++f) offsets[f + 1] += offsets[f];
    RawVector<std::int32_t> vertices(offsets[faces]);
    parallelChunks(faces, chunk, [&](Index begin, Index end, Index) {
        std::vector<std::int32_t> loop;
        for (Index f = begin; f < end; ++f) {
            take(f, loop);
            std::uint32_t at = offsets[f];
            for (const std::int32_t p : loop) vertices[at++] = number[Index(p)];
        }
    });
    mesh.faceVertices = std::move(vertices);
    for (Index i = 0; i < gone.size(); ++i) { // what lies between two that are gone moves down
        const auto from = mesh.points.begin() + gone[i], to = i + 1 < gone.size() ? mesh.points.begin() + gone[i + 1] : mesh.points.end();
        std::move(from + 1, to, from - static_cast<std::ptrdiff_t>(i));
    }
    mesh.points.resize(mesh.points.size() - gone.size());
    Index to = 0;
    const auto keep = [&](Index f) {
        if (offsets[f + 1] == offsets[f]) return false;
        mesh.owner[to] = mesh.owner[f];
        if (f < internal) mesh.neighbour[to] = mesh.neighbour[f];
        offsets[++to] = offsets[f + 1];
        return true;
    };
    for (Index f = 0; f < internal; ++f) keep(f);
    mesh.neighbour.resize(to);
    auto start = static_cast<std::int32_t>(to);
    for (Patch& patch : mesh.patches) {
        const Index first = Index(patch.start), end = first + Index(patch.count);
        for (Index f = first; f < end; ++f)
            if (!keep(f)) lost.push_back(mesh.owner[f]);
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
